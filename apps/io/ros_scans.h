#ifndef PLUMBLINE_APPS_IO_ROS_SCANS_H_
#define PLUMBLINE_APPS_IO_ROS_SCANS_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/apps/io/bad_records.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Number of beams of the laser of a scan: one per range, or, for a cut through a point cloud, as
/// many as its increment [rad], which is not zero, takes for a full circle.
int NumBeams(const RosScan& scan);

/// Bearings of the beams of a scan [rad].
struct BeamAngles {
  double first_rad = 0.0;
  double step_rad = 0.0;  ///< 0: the fields do not tell
  /// angle_max contradicts the increment or the number of readings.
  bool contradict = false;
};

BeamAngles AnglesOf(const RosScan& scan, BeamAngleSource source);

/// The fault of a scan, its frame and stamp aside; empty if it has none. range_max_is_stated: its
/// range_max is to be checked.
std::string ScanFault(const RosScan& scan, bool range_max_is_stated);

/// Part of the scans of a recording that can be used, as far as the scans themselves tell.
struct ScanSelection {
  std::string laser_frame;
  std::vector<std::size_t> scans;  ///< indices, in the order of the recording
  BadRecords bad;                  ///< scans that cannot be used
  std::size_t num_repeated = 0;    ///< scans that repeat the one before
  bool range_max_is_stated = true;
};

/// Selects the scans of one laser. InvalidArgument, without the path, if there is no scan, or if
/// several lasers share the topic and `laser_frame` chooses none of them.
Status SelectScans(const RosRecording& recording, const std::string& laser_frame,
                   ScanSelection* selection);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROS_SCANS_H_
