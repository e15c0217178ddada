#ifndef PLUMBLINE_APPS_BENCHMARK_KNOWN_WALLS_H_
#define PLUMBLINE_APPS_BENCHMARK_KNOWN_WALLS_H_

#include "plumbline/apps/benchmark/synthetic_drive.h"
#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// What a mapper is told of a building.
enum class Told {
  kWhoseReturn,  ///< of which straight wall each return is: faces in one line are one wall
  kDirections,   ///< that, and the direction of every wall
  kWalls,        ///< where all walls and pillars are
};

/// The best that any mapper could do that is told this much, and the true noise of laser and
/// odometry. What is left to estimate, by least squares over the returns' distances from their
/// surfaces and the odometry, are the poses, the walls' directions and offsets unless told, and the
/// points, each where its surface and its beam together put it. Returns that are not the building's
/// are left where their beams end; so are those of pillars, unless all is told. A wall that is not
/// told is within some 1 m and 0.3 rad of the truth.
///
/// The first pose is known, as it is for all mappers. The factors give the noise; the thickness of
/// surfaces is not looked at, since those of the simulation have none.
MapEstimate EstimateGivenTruth(const SyntheticDrive& drive, const FactorOptions& factors,
                               Told told);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_KNOWN_WALLS_H_
