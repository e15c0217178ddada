#ifndef PLUMBLINE_SOLVERS_ASSOCIATION_NOISE_SCALES_H_
#define PLUMBLINE_SOLVERS_ASSOCIATION_NOISE_SCALES_H_

#include "plumbline/core/return_normals.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// The window for surface normals that suits a laser of this range noise [m].
ReturnNormalOptions NormalOptionsFor(const RangeBeamOptions& beam);

/// Smallest radius [m] of the neighbourhoods that final tangent lines, and with them
/// MarginalEnergy, are taken from: fine_radius_m, or more where noise would make walls look like
/// clutter.
double FineRadius(const SolverOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ASSOCIATION_NOISE_SCALES_H_
