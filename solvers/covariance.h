#ifndef PLUMBLINE_SOLVERS_COVARIANCE_H_
#define PLUMBLINE_SOLVERS_COVARIANCE_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// Two poses of a graph, by their ids; they may be the same.
struct PosePair {
  int a = 0;  ///< pose id
  int b = 0;  ///< pose id
};

/// How far the poses may be off, and how much of that they share: per pair the covariance
/// E[e_a e_b^T] (3 x 3, rows of a, columns of b) of their errors e in world_from_robot, in the
/// order x, y [m], yaw [rad], world axes. (a, a) gives the marginal of a; a fixed pose is known,
/// and has none.
///
/// It is the inverse of the reduced solver's Gauss-Newton matrix at the state, with every
/// point and every tangent line eliminated: they count as unknown. So the state should be the
/// optimum (Solve), and the sigmas of `options` should be those of the data; errors that these do
/// not speak of, a wrong loop or a bent mounting, are not in it. Costs three solutions of the
/// linear system per distinct a, each some tens of passes over what the poses saw of the landmarks.
///
/// InvalidArgument, with nothing changed, on bad options, an unknown pose, and on poses that
/// nothing ties to a fixed one, or not in every direction: their covariance is infinite.
/// Unavailable if a system cannot be solved to full precision, or memory runs out.
Status ComputePoseCovariances(const SolverOptions& options, const SlamGraph& graph,
                              const MapState& state, const std::vector<PosePair>& pairs,
                              std::vector<Eigen::Matrix3d>* covariances);

/// The covariance of the motion a_from_b = a^-1 b between two poses (x, y [m], yaw [rad], axes of
/// a), from the three covariances that ComputePoseCovariances gives for (a, a), (a, b) and (b, b).
/// It suits RelativePoseConstraint, and gates the search for a loop closure.
Eigen::Matrix3d RelativePoseCovariance(const Pose2& world_from_a, const Pose2& world_from_b,
                                       const Eigen::Matrix3d& aa, const Eigen::Matrix3d& ab,
                                       const Eigen::Matrix3d& bb);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_COVARIANCE_H_
