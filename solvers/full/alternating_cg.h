#ifndef PLUMBLINE_SOLVERS_FULL_ALTERNATING_CG_H_
#define PLUMBLINE_SOLVERS_FULL_ALTERNATING_CG_H_

#include "plumbline/core/map_state.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/full/energy.h"
#include "plumbline/solvers/interface/inner_result.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// Minimises the joint energy by conjugate gradients over all poses and points. The preconditioner
/// is a sweep of an alternation: iterations on the map with the poses fixed, then on the poses with
/// the map fixed, then on the poses with each scan carrying its points along. All of these are
/// preconditioned with the diagonal blocks of the Gauss-Newton Hessian (2x2 per point, 3x3 per
/// pose), which takes out the difference between metres and radians and between near and far
/// points. The cost never rises; *state is the best one on return.
InnerResult SolveByAlternatingCg(const Energy& energy, const AlternatingCgOptions& options,
                                 const ProgressCallback& report, MapState* state);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_ALTERNATING_CG_H_
