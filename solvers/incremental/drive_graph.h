#ifndef PLUMBLINE_SOLVERS_INCREMENTAL_DRIVE_GRAPH_H_
#define PLUMBLINE_SOLVERS_INCREMENTAL_DRIVE_GRAPH_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// Pose graph of a drive that grows. Each step, from a pose to the next one, keeps the relative
/// pose that it had before a loop closure moved it. Its covariance is that of a scan match, by the
/// normals of the two scans, together with the odometry's: along a bare corridor only the odometry
/// holds. The graph keeps its optimum from one loop closure to the next, so that the result does
/// not depend on their order.
class DriveGraph {
 public:
  explicit DriveGraph(const MotionOptions& motion) : motion_(motion) {}

  /// Takes in the scans and the odometry that the graph has gained. surface: of the graph.
  void Extend(const SlamGraph& graph, const MeasuredSurface& surface);

  /// Measures the steps to all poses before `end` that are not measured yet. poses: (x, y [m], yaw
  /// [rad]) each.
  void Measure(int end, const std::vector<double>& poses);

  /// Measures all steps again and begins at these poses: the caller has moved them.
  void Restart(const std::vector<double>& poses);

  /// Whether a relative pose agrees with one of `others` between poses near by: the chi-squared of
  /// the loop that the two and the steps between their ends form is within its 99.9 % quantile.
  bool AgreesWithOne(const RelativePoseConstraint& edge,
                     const std::vector<RelativePoseConstraint>& others) const;

  /// Moves the graph to its optimum: `certain` edges count as they are, `uncertain` ones under a
  /// robust loss. The poses move there, too, once the optimum is farther from where they last did
  /// than landmarks can follow. Fixed poses stay. Needs measured steps to all poses.
  void Close(const std::vector<RelativePoseConstraint>& certain,
             const std::vector<RelativePoseConstraint>& uncertain,
             const std::vector<FixedPose>& fixed, std::vector<double>* poses);

 private:
  struct Step {
    Pose2 measured;                                    // from the pose before
    Eigen::Matrix3d motion = Eigen::Matrix3d::Zero();  // information of the odometry
  };

  RelativePoseConstraint StepTo(int pose) const;
  RelativePoseConstraint Chain(int from, int to) const;

  MotionOptions motion_;
  std::vector<Pose2> world_from_pose_;                // of the poses that are measured
  std::vector<Pose2> at_last_move_;                   // the same when the caller's poses last moved
  std::vector<Step> step_to_;                         // per pose of the graph
  std::vector<Eigen::Matrix3d> information_of_pose_;  // of its returns against their surfaces
  std::vector<RelativePoseConstraint> long_motions_;  // odometry between poses that do not follow
  int num_scans_ = 0;
  std::size_t num_odometry_ = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INCREMENTAL_DRIVE_GRAPH_H_
