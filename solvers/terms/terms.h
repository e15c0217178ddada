#ifndef PLUMBLINE_SOLVERS_TERMS_TERMS_H_
#define PLUMBLINE_SOLVERS_TERMS_TERMS_H_

#include <memory>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/terms/pose_edges.h"
#include "plumbline/solvers/terms/term.h"

namespace plumbline {

/// @{
/// Names of terms that something is said of elsewhere.
constexpr char kMotionTerm[] = "motion";
constexpr char kRelativePoseTerm[] = "relative pose";
constexpr char kRangeBeamTerm[] = "range beam";
constexpr char kManifoldTerm[] = "manifold";
/// @}

/// All terms of the energy, in its order: those of the library, and then the host's own. Keeps
/// references to graph and associations. Shape pairs join returns of one scan and are in order of
/// scans, as FindShapePairs gives them.
TermList MakeTerms(const SlamGraph& graph, const Associations& associations,
                   const FactorOptions& options);

/// The terms of odometry and relative poses, from residuals of the caller's.
std::shared_ptr<const Term> MakeMotionTerm(std::vector<PoseEdge> motions);
std::shared_ptr<const Term> MakeRelativePoseTerm(std::vector<PoseEdge> relative_poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_TERMS_H_
