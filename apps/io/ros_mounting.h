#ifndef PLUMBLINE_APPS_IO_ROS_MOUNTING_H_
#define PLUMBLINE_APPS_IO_ROS_MOUNTING_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/io/transform_tree.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// True if two poses of a frame in another differ by 0.01 m and 0.01 rad at most.
bool AreAtRest(const Pose2& before, const Pose2& after);

/// The place of a laser on its robot.
struct LaserPlace {
  Pose2 robot_from_laser;
  bool upside_down = false;  ///< its bearings then run clockwise

  /// The same way up, and AreAtRest.
  bool IsNear(const LaserPlace& other) const;
};

/// The place of a laser at the times of its scans.
struct LaserPlaces {
  LaserPlace place;
  bool is_known = false;            ///< a transform joins laser and robot
  std::vector<std::string> faults;  ///< per time, the reason why its scan is no use; empty for most
  std::vector<std::string> kinds;   ///< per time, the kind of that fault
  std::vector<std::string> bad_samples;  ///< for a user, a text per edge
};

/// Finds the place of a laser at rest: the one at the first time that most others agree with. A
/// scan is no use if the laser was tilted by more than 3 deg or elsewhere at its time. Fails like
/// TransformTree::FindPath.
Status FindLaserPlace(const TransformTree& transforms, const std::string& robot_frame,
                      const std::string& laser_frame, const std::vector<double>& times_s,
                      LaserPlaces* places);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROS_MOUNTING_H_
