#ifndef PLUMBLINE_APPS_BENCHMARK_SENSOR_MATRIX_H_
#define PLUMBLINE_APPS_BENCHMARK_SENSOR_MATRIX_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "plumbline/apps/report/stage.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// A scanner in a building. Each case changes one thing of the first, "base".
struct SensorCase {
  std::string group;  ///< what is changed: "field of view"
  std::string name;   ///< to what: "270 deg"
  std::function<Building(std::uint64_t seed)> make_building;
  SimulationOptions simulation;  ///< but for its seed
  /// Of the building's faces, those that are glass; drawn at random, from 0 to 1.
  double glass_share = 0.0;
  bool shape = false;  ///< the joint estimation has its shape potential on
  /// Nobody knows that the laser measures its beams one after the other.
  bool sweeps_unknown = false;
};

/// Fields of view, resolutions, ranges, noise, mountings, few scans, sweeps, people, doors, glass,
/// and buildings other than offices at right angles.
std::vector<SensorCase> SensorCases();

/// What came of one case and seed, by seeding and joint estimation as plumbline_slam runs them. Of
/// the scanner they know what its data sheet says: beams, mounting, greatest range, range noise.
struct SensorOutcome {
  /// A pose further off has lost the building's topology: half of the way to a neighbouring wall.
  static constexpr double kLostM = 0.5;

  int case_index = 0;
  std::uint64_t seed = 1;
  int num_scans = 0;
  double outlier_share = 0.0;  ///< of the returns, those that are not the building's
  Stage seeded, refined;       ///< with errors
  /// Mean pose error of the joint estimation started within a centimetre of the truth: what noise
  /// leaves, as along a corridor whose ends the scanner does not reach.
  double floor_m = 0.0;
  bool alarm = false;

  /// The mean pose is off by more than the seed's and by more than noise leaves.
  bool IsWorse() const;
  /// A pose is lost, and the run does not warn.
  bool IsSilentlyLost() const;
  bool Failed() const { return IsWorse() || IsSilentlyLost(); }
};

/// Runs every case with the seeds 1 to num_seeds; outcomes are in this order. Spreads the runs over
/// the threads of the pool; the result does not depend on their number. Fails with the first run
/// that fails.
Status RunSensorCases(const std::vector<SensorCase>& cases, int num_seeds,
                      const SolverOptions& solver, const SeedingOptions& seeding, ThreadPool* pool,
                      std::vector<SensorOutcome>* outcomes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SENSOR_MATRIX_H_
