#ifndef PLUMBLINE_APPS_BENCHMARK_SEEDING_STUDY_H_
#define PLUMBLINE_APPS_BENCHMARK_SEEDING_STUDY_H_

#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/seeding/seed.h"

namespace plumbline {

/// How a drive is silently falsified once.
enum class Jump {
  kNone,
  kCarried,   ///< the robot is carried along its path, which its odometry does not notice
  kInjected,  ///< the sequential matching is made to say so: with its odometry, and as sure as ever
};

const char* ToString(Jump jump);

/// One run of the study.
struct SeedingCase {
  BuildingKind building = BuildingKind::kRandom;
  std::uint64_t seed = 1;        ///< of the building and of all noise
  double odometry_factor = 1.0;  ///< times all errors of the default OdometryNoise
  Jump jump = Jump::kNone;
  double jump_m = 0.0;
  double jump_share = 0.0;  ///< of the path driven before the jump
};

/// What the seeding made of it.
struct SeedingOutcome {
  SeedingCase run;
  int num_scans = 0;
  double path_length_m = 0.0;
  double carried_turn_rad = 0.0;  ///< by how much its heading changed while it was carried
  double max_error_m = 0.0;   ///< of a pose, after the rigid motion that fits the trajectory best
  double mean_error_m = 0.0;  ///< likewise
  bool alarm = false;         ///< as SeedingReport says
  bool repaired = false;
  double time_s = 0.0;  ///< of the seeding, on one thread

  /// Globally consistent: no pose is 0.15 m off, the width of a wall.
  bool IsRight() const { return max_error_m < 0.15; }
};

/// Random and repetitive buildings by turns; half of the runs have a jump of 0.5-6 m, which is
/// carried or injected by turns; the odometry is half, once and twice as bad as by default. Every
/// 24 runs hold each combination once.
std::vector<SeedingCase> SeedingCases(int num_runs);

/// InvalidArgument if the options are refused.
Status RunSeedingCase(const SeedingCase& run, const SeedingOptions& seeding,
                      const FactorOptions& factors, SeedingOutcome* outcome);

/// Spreads whole runs over the threads; `outcomes` are in the order of the cases and, but for the
/// times, do not depend on the number of threads. Fails with the first run that fails.
Status RunSeedingStudy(const std::vector<SeedingCase>& cases, const SeedingOptions& seeding,
                       const FactorOptions& factors, ThreadPool* pool,
                       std::vector<SeedingOutcome>* outcomes);

/// A table for people: how many runs of each class are right or wrong, with and without an alarm.
std::string SeedingTable(const std::vector<SeedingOutcome>& outcomes);

/// One line per run below a header line. Unavailable if the file cannot be written.
Status WriteSeedingCsv(const std::string& path, const std::vector<SeedingOutcome>& outcomes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SEEDING_STUDY_H_
