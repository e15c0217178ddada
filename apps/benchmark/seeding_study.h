#ifndef PLUMBLINE_APPS_BENCHMARK_SEEDING_STUDY_H_
#define PLUMBLINE_APPS_BENCHMARK_SEEDING_STUDY_H_

#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/faulty_drive.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/seeding_options.h"

namespace plumbline {

/// What the robot of a run scans with, how it drives, and among whom. The field of view is 180 deg.
enum class StudyScanner {
  kFine,     ///< a beam every 0.5 deg, to 80 m; a scan every 0.18 m
  kShort,    ///< a beam every 1 deg, to 8 m, range noise 15 mm; a scan every 0.18 m
  kThinned,  ///< a beam every 1 deg, to 80 m; a scan every 0.8 m
  kFast,     ///< a beam every 1 deg, to 80 m; 1 m/s, turning by 80 deg/s, a scan every 0.45 m
  kPeople,   ///< as kFine, with four people who go around the robot, and doors that move
};

const char* ToString(StudyScanner scanner);

/// fine, short, thinned, fast or people; false if it is none of them.
bool FromString(const std::string& name, StudyScanner* scanner);

/// One run of the study.
struct SeedingCase {
  StudyScanner scanner = StudyScanner::kFine;
  BuildingKind building = BuildingKind::kRandom;
  std::uint64_t seed = 1;        ///< of the building and of all noise
  double odometry_factor = 1.0;  ///< times all errors of the default OdometryNoise
  Fault fault;                   ///< the mapper does not know of it
};

/// Whether the map cannot be right as a whole, for nothing tells where the robot is in a part of
/// it: with a laser frozen to the end, and with two buildings. All other faults can be put right,
/// or do no harm; an alarm on a right map is a false one there.
bool IsAlarmDue(FaultKind kind);

/// What the seeding made of a run, and then the estimation.
struct SeedingOutcome {
  SeedingCase run;
  int num_scans = 0;
  double path_length_m = 0.0;
  double carried_turn_rad = 0.0;  ///< by how much its heading changed while it was carried
  /// Of a pose, after the rigid motion that fits the trajectory best. Two buildings: after one such
  /// motion for each. Laser frozen to the end: of the poses before that only, as nothing but the
  /// odometry tells of the others.
  double max_error_m = 0.0;
  double mean_error_m = 0.0;  ///< likewise
  bool alarm = false;         ///< as SeedingReport says
  bool repaired = false;
  double time_s = 0.0;               ///< of the seeding, on one thread
  double max_refined_error_m = 0.0;  ///< as max_error_m, of the map that the run ends with
  bool refined_alarm = false;        ///< of the whole run

  /// Globally consistent: no pose is 0.15 m off, the width of a wall; and there is an alarm if one
  /// is due. Without the alarm that is due, a map is wrong and silent.
  bool IsRight() const { return IsRight(max_error_m, alarm); }
  /// The same of the map that the run ends with.
  bool IsRefinedRight() const { return IsRight(max_refined_error_m, refined_alarm); }

 private:
  bool IsRight(double error_m, bool is_warned) const {
    return error_m < 0.15 && (is_warned || !IsAlarmDue(run.fault.kind));
  }
};

/// Random and repetitive buildings by turns, two of one seed; the seeds count from first_seed.
/// Of 15 seeds in a row four are of sound drives and each of the others is of another fault. The
/// odometry is half, once and twice as bad as by default. Every 90 runs hold each combination once,
/// sound ones four times.
///
/// The robot is carried, in a gap of 5 s or none, or matching is made to err, by 0.5-6 m; a slip of
/// 0.5-3 m, too much or too little, takes 15 scans; scans are dropped for 3 s; the clocks differ by
/// 0.2 s, either way; 10 s are repeated; the laser is frozen for 12 s or to the end, or turned by
/// 5 deg, either way. It happens at 20-80 % of the path, freezing to the end at 60-90 %.
std::vector<SeedingCase> SeedingCases(int num_runs, std::uint64_t first_seed);

/// InvalidArgument if the options are refused.
Status RunSeedingCase(const SeedingCase& run, const SeedingOptions& seeding,
                      const FactorOptions& factors, SeedingOutcome* outcome);

/// Spreads whole runs over the threads; `outcomes` are in the order of the cases and, but for the
/// times, do not depend on the number of threads. Fails with the first run that fails.
Status RunSeedingStudy(const std::vector<SeedingCase>& cases, const SeedingOptions& seeding,
                       const FactorOptions& factors, ThreadPool* pool,
                       std::vector<SeedingOutcome>* outcomes);

/// A table for people: how many runs with each fault, and in each kind of building, are right or
/// wrong, each with and without an alarm; how many were repaired; the share of the right ones; the
/// time of their seeding, in sum [s]; and how many maps are wrong once they are refined, and
/// silent.
std::string SeedingTable(const std::vector<SeedingOutcome>& outcomes);

/// One line per run below a header line. Unavailable if the file cannot be written.
Status WriteSeedingCsv(const std::string& path, const std::vector<SeedingOutcome>& outcomes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SEEDING_STUDY_H_
