#ifndef PLUMBLINE_SOLVERS_INTERFACE_BUILT_IN_SOLVERS_H_
#define PLUMBLINE_SOLVERS_INTERFACE_BUILT_IN_SOLVERS_H_

#include <string>

namespace plumbline {

class Solver;
struct SolverOptions;

/// The solvers that come with the library.
enum class SolverType {
  kReduced,        ///< points and lines eliminated exactly; poses by Gauss-Newton
  kAlternatingCg,  ///< conjugate gradients, preconditioned by moving map and poses in turn
  kPublished,      ///< the method as published: see published_method.cc
  kCeres,          ///< one ceres::Problem over all poses and points
  kPoseGraph,      ///< poses by relative poses alone: Gauss-Newton
  kSgd,            ///< the same by stochastic gradient descent
};
/// "reduced", "alternating_cg", "published", "ceres", "pose_graph" or "sgd".
const char* ToString(SolverType type);
/// The inverse; false, with *type unchanged, for another name.
bool FromString(const std::string& name, SolverType* type);

/// The solver that the options ask for: the host's own, or one of these.
const Solver& SolverOf(const SolverOptions& options);

/// @{
/// Each is defined beside its minimiser.
const Solver& ReducedSolver();
const Solver& AlternatingCgSolver();
const Solver& PublishedSolver();
const Solver& CeresSolver();
const Solver& CeresReducedSolver();  ///< kCeres with CeresOptions::reduced
/// @}

/// @{
/// Move the poses of a state down the error of the graph's relative poses, chi2, the sum of their
/// squared whitened errors; odometry and returns are not looked at. Every map point keeps its place
/// in the frame of its robot. Fixed poses stay. The given state comes back, bit for bit, if chi2
/// does not become lower. PoseGraphSolver starts at the given poses or at a chordal start, see
/// refine_pose_graph.h; SgdSolver starts at the given poses.
const Solver& PoseGraphSolver();
const Solver& SgdSolver();
/// @}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_BUILT_IN_SOLVERS_H_
