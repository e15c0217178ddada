#ifndef PLUMBLINE_CORE_MEASUREMENTS_H_
#define PLUMBLINE_CORE_MEASUREMENTS_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// What the odometry says of the motion between two poses; its noise comes from the motion model.
struct OdometryConstraint {
  int from = 0;        ///< pose id
  int to = 0;          ///< pose id
  Pose2 from_from_to;  ///< pose of the robot at `to` in its frame at `from`
  /// False where no odometry was recorded: the motion is then a placeholder, and the seeding
  /// matches the scans without it.
  bool is_measured = true;
};

/// A measured relative pose with its covariance (order x, y [m], yaw [rad], in the frame of
/// `from`): a loop closure, or an edge of a host pipeline's pose graph.
struct RelativePoseConstraint {
  int from = 0;        ///< pose id
  int to = 0;          ///< pose id
  Pose2 from_from_to;  ///< pose of the robot at `to` in its frame at `from`
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< [m^2], [m rad], [rad^2]
};

/// A pose that is known.
struct FixedPose {
  int pose = 0;            ///< pose id
  Pose2 world_from_robot;  ///< where it is held
};

/// One sweep of a laser taken at a pose. Its returns lie side by side in the graph's arrays.
struct ScanEntry {
  int pose = 0;                  ///< pose id
  int laser = 0;                 ///< laser id
  std::size_t first_return = 0;  ///< return id; those of the scan follow it
  std::size_t num_returns = 0;   ///< beams without a return are left out
  /// As AddSweep and AddPoints give them: not those of the laser's beams.
  bool has_own_bearings = false;
};

/// Every laser return of a graph, ordered by scan and then by beam; SlamGraph says which ones these
/// are. Single precision is exact to 4 micrometres at 80 m.
struct LaserReturns {
  std::vector<float> range_m;  ///< from the laser

  /// Number of returns.
  std::size_t size() const { return range_m.size(); }
};

/// Measurements that a graph is to have in place of its own; an empty array leaves them as they
/// are.
struct MeasurementCorrections {
  std::vector<Pose2> odometry;          ///< from_from_to per constraint of SlamGraph::odometry()
  std::vector<Pose2> robot_from_laser;  ///< mounting per laser
  std::vector<double> range_m;          ///< per return [m]
  std::vector<double> bearing_rad;      ///< per return, in the frame of the laser [rad]
  /// Returns of people and all else that moves, on top of those that were known before: ids among
  /// all of the graph and its peers, in order.
  std::vector<std::size_t> moving_returns;
};

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_MEASUREMENTS_H_
