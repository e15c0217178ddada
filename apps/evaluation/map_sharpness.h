#ifndef PLUMBLINE_APPS_EVALUATION_MAP_SHARPNESS_H_
#define PLUMBLINE_APPS_EVALUATION_MAP_SHARPNESS_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/map_quality.h"
#include "plumbline/core/status.h"

namespace plumbline {

struct SharpnessAtRadius {
  double radius_m = 0.0;
  MapQuality quality;
};

/// Sharpness of one map at several scales.
struct MapSharpness {
  std::size_t num_points = 0;
  std::size_t num_scans_without_pose = 0;
  std::vector<SharpnessAtRadius> radii;
};

/// Measures points (x, y [m] in turn, finite) with neighbourhoods of 0.1, 0.15 and 0.2 m, so that
/// the order of two maps does not hang on the one radius that was picked.
MapSharpness MeasureSharpness(const std::vector<double>& points);

/// Measures the raw ranges of the log at the poses of the trajectory that have their time (to
/// 1 ms). Scans without a pose are left out and counted. NotFound, Unavailable, DataLoss or
/// InvalidArgument if ReadCarmenLog or BuildGraph fails, InvalidArgument if no return has a pose.
Status MeasureSharpnessOfLog(const std::string& log_path, const std::vector<TimedPose>& trajectory,
                             MapSharpness* sharpness);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_MAP_SHARPNESS_H_
