#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_CHORDAL_START_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_CHORDAL_START_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Places the poses of a pose graph without regard to where they are, as a start for its
/// optimisation: exact where the edges agree, and close to the global optimum for moderate noise.
///
/// Two linear least squares problems in turn. First the headings, z = (cos yaw, sin yaw), relaxed
/// from the unit circle to the plane:
///   min sum_edges |z_to - R(yaw_edge) z_from|^2 / yaw variance,
/// then, with the headings known, the positions:
///   min sum_edges |t_to - t_from - R(yaw_from) t_edge|^2, weighted with the inverse of the
/// covariance of t_edge.
/// Source: Carlone, Tron, Daniilidis, Dellaert: Initialization techniques for 3D SLAM (2015), the
/// chordal relaxation.
///
/// Edges name poses by their index; the `fixed` ones stay. Expects edges to connect every pose with
/// a fixed one: where they do not, rounding decides where a pose ends up. False, with the poses
/// untouched, if the equations cannot be solved, as where numbers leave the range of a double.
bool ChordalStart(const std::vector<RelativePoseConstraint>& edges, const std::vector<int>& fixed,
                  std::vector<Pose2>* world_from_pose);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_CHORDAL_START_H_
