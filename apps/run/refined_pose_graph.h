#ifndef PLUMBLINE_APPS_RUN_REFINED_POSE_GRAPH_H_
#define PLUMBLINE_APPS_RUN_REFINED_POSE_GRAPH_H_

#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// An edge between poses of a robot frame b, for poses of a frame a on the same robot, b_from_a;
/// the covariance to first order.
RelativePoseConstraint MoveRobotFrame(const RelativePoseConstraint& edge, const Pose2& b_from_a);

/// Writes what a run over a log has found as a pose graph for other programs, in g2o's format: the
/// poses, numbered from 0, and the seeding's edges, loop closures included. These know nothing of
/// the joint estimation: optimised alone, they give the seed again. Neither scans nor times, so
/// that the file stays small; the trajectory has the times, in the same order.
///
/// poses: as MapState::poses. edges: between poses of the robot frame before calibration, which may
/// have moved it: before_from_after. Unavailable if the file cannot be written.
Status WriteRefinedPoseGraph(const std::string& path, const std::vector<double>& poses,
                             const std::vector<RelativePoseConstraint>& edges,
                             const Pose2& before_from_after);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_REFINED_POSE_GRAPH_H_
