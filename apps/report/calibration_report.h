#ifndef PLUMBLINE_APPS_REPORT_CALIBRATION_REPORT_H_
#define PLUMBLINE_APPS_REPORT_CALIBRATION_REPORT_H_

#include <string>

#include "plumbline/apps/report/report_json.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/calibration.h"

namespace plumbline {

/// Switches on what a list of names asks for, separated by commas: mounting, range_bias,
/// range_scale, odometry_scale. Nothing for the empty list. InvalidArgument names an unknown name;
/// *options is then unchanged.
Status ParseCalibration(const std::string& names, CalibrationOptions* options);

/// A table with one row per parameter, and what the data did not determine; empty if nothing was
/// calibrated.
std::string CalibrationText(const Calibration& calibration);

/// null if nothing was calibrated.
Json CalibrationJson(const Calibration& calibration);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_CALIBRATION_REPORT_H_
