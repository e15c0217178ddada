#ifndef PLUMBLINE_APPS_SAVED_MAPS_KARTO_CLASSES_H_
#define PLUMBLINE_APPS_SAVED_MAPS_KARTO_CLASSES_H_

#include "plumbline/apps/saved_maps/archive_schema.h"

namespace plumbline {

/// What the classes of karto, as slam_toolbox has it, write of themselves. "karto::Mapper" is the
/// root of x.posegraph, "karto::Dataset" that of x.data. By the functions `serialize` of Karto.h,
/// Mapper.h and Mapper.cpp (slam_toolbox, lib/karto_sdk): these write the same in ROS 1 Noetic and
/// in ROS 2 since Foxy, but for parameters that newer versions append to the mapper's.
const ArchiveSchema& KartoClasses();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_KARTO_CLASSES_H_
