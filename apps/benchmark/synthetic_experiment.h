#ifndef PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_EXPERIMENT_H_
#define PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_EXPERIMENT_H_

#include <array>
#include <cstdint>
#include <vector>

#include "plumbline/apps/benchmark/map_errors.h"
#include "plumbline/apps/benchmark/synthetic_drive.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// The algorithms that map a drive. All get the same data, and are told the noise of the laser.
enum class Mapper {
  // The rows of the paper's table.
  kPlainIcp,        ///< each scan against the one before it by PlainIcp, with its default gate
  kOlson,           ///< SGD over a MatchGraph, Olson et al. (2006)
  kPublished,       ///< the paper's method, from the row below
  kPublishedStart,  ///< line 7 of its Algorithm 1: one ICP over all scans, from kPlainIcp
  kSeed,            ///< Plumbline's starting point
  kPlumbline,       ///< poses and points
  kGaussNewton,     ///< over the edges of kOlson
  kOdometry,
  // Lower bounds of the error for a mapper with this knowledge, see EstimateGivenTruth:
  kKnownAssociation,
  kKnownDirections,
  kKnownWalls,
  kTruePoses,  ///< raw ranges placed by the true poses
};
constexpr int kNumMappers = 12;
const char* ToString(Mapper mapper);

/// Three levels of range noise, and one with noise of all kinds beyond.
std::vector<SyntheticNoise> SyntheticNoises();

/// The map of every mapper, in order of the enum. options: those of kPlumbline, and what the others
/// share with it, but for the noise of the laser. InvalidArgument if a mapper refuses the drive.
Status MakeMaps(const SyntheticDrive& drive, const SyntheticNoise& noise,
                const MapLogOptions& options, std::array<MapEstimate, kNumMappers>* maps);

/// What one mapper made of one drive.
struct SyntheticOutcome {
  /// A pose further off has lost the building's topology: half of the way to a neighbouring wall.
  static constexpr double kFailureM = 0.5;
  /// Map errors are kept as means over this many stretches of returns, in order of time.
  static constexpr int kNumStretches = 64;

  std::uint64_t seed = 1;
  int noise = 0;  ///< index
  Mapper mapper = Mapper::kOdometry;
  MeanAndVariance pose_m, heading_rad, point_m;
  double max_pose_m = 0.0;
  std::vector<double> pose_errors_m;   ///< per pose
  std::vector<double> point_errors_m;  ///< per stretch

  bool Failed() const { return !(max_pose_m <= kFailureM); }
};

/// Runs the seeds 1 to num_seeds at every noise and with every mapper; outcomes are in this order.
/// Spreads the drives over the threads; the result does not depend on their number. Fails with the
/// first drive that fails.
Status RunSyntheticExperiment(int num_seeds, const std::vector<SyntheticNoise>& noises,
                              const MapLogOptions& options, ThreadPool* pool,
                              std::vector<SyntheticOutcome>* outcomes);

/// The figures of one mapper at one noise, over the seeds. Failures are among them, and counted.
struct SyntheticSummary {
  int noise = 0;
  Mapper mapper = Mapper::kOdometry;
  int num_runs = 0, num_failures = 0;
  Quartiles pose_mean_m, pose_variance_m2, point_mean_m, point_variance_m2, heading_mean_rad;
};

/// In order of noise and mapper.
std::vector<SyntheticSummary> SummariseOutcomes(const std::vector<SyntheticOutcome>& outcomes);

/// The seed whose mean pose error is the median of one mapper's at one noise, for pictures of a
/// typical drive; the lower one of two. There is an outcome of that mapper and noise.
std::uint64_t MedianSeed(const std::vector<SyntheticOutcome>& outcomes, int noise, Mapper mapper);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SYNTHETIC_EXPERIMENT_H_
