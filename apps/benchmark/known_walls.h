#ifndef PLUMBLINE_APPS_BENCHMARK_KNOWN_WALLS_H_
#define PLUMBLINE_APPS_BENCHMARK_KNOWN_WALLS_H_

#include "plumbline/apps/benchmark/synthetic_drive.h"
#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// The best that any mapper could do: someone tells the building's true surfaces, which of them
/// each return belongs to, and the true noise of laser and odometry. What is left to estimate are
/// the poses, by least squares over the returns' distances from their surfaces and the odometry,
/// and the points, each where its surface and its beam together put it. Returns that are not the
/// building's are left where their beams end.
///
/// The first pose is known, as it is for all mappers. The factors give the noise; the thickness of
/// surfaces is not looked at, since those of the simulation have none.
MapEstimate LocaliseAgainstTruth(const SyntheticDrive& drive, const FactorOptions& factors);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_KNOWN_WALLS_H_
