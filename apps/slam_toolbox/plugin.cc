#include <pluginlib/class_list_macros.hpp>

#include "plumbline_solver.h"

PLUGINLIB_EXPORT_CLASS(plumbline::JointScanSolver, karto::ScanSolver)
