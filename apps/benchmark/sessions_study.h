#ifndef PLUMBLINE_APPS_BENCHMARK_SESSIONS_STUDY_H_
#define PLUMBLINE_APPS_BENCHMARK_SESSIONS_STUDY_H_

#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// One run of the study: drives through one building on several days, each from another place and
/// with furniture moved, and a drive through another building of the same kind.
struct SessionsCase {
  BuildingKind building = BuildingKind::kRandom;
  std::uint64_t seed = 1;  ///< of the building and of all noise
  int num_visits = 5;      ///< days, without the drive through the other building
};

/// What became of a run.
struct SessionsOutcome {
  SessionsCase run;
  int num_scans = 0;
  int num_tied = 0;           ///< visits in the map that holds most of them
  int num_wrong_ties = 0;     ///< visits of one building in a map with those of the other
  bool has_alarm = false;     ///< of any of the maps
  double max_error_m = 0.0;   ///< of a pose, after one rigid motion per map
  double mean_error_m = 0.0;  ///< of the largest map
  double floor_m = 0.0;       ///< mean error of the same map from a start within 1 cm of the truth
  double time_s = 0.0;        ///< of MapSessions, on one thread

  /// No session lies where it is not: no pose of any map is 0.15 m off, the width of a wall.
  bool IsRight() const { return num_wrong_ties == 0 && max_error_m < 0.15; }
  /// All visits are in one map, and it is right.
  bool IsComplete() const { return IsRight() && num_tied == run.num_visits; }
};

/// Five random buildings to one repetitive one, where all places look alike; the seeds count from
/// first_seed.
std::vector<SessionsCase> SessionsCases(int num_runs, std::uint64_t first_seed);

/// InvalidArgument if the options are refused.
Status RunSessionsCase(const SessionsCase& run, const MapLogOptions& options,
                       SessionsOutcome* outcome);

/// Spreads whole runs over the threads; `outcomes` are in the order of the cases and, but for the
/// times, do not depend on the number of threads. Fails with the first run that fails.
Status RunSessionsStudy(const std::vector<SessionsCase>& cases, const MapLogOptions& options,
                        ThreadPool* pool, std::vector<SessionsOutcome>* outcomes);

/// A table for people: per kind of building how many runs are complete, right, or wrong with and
/// without an alarm, and the errors.
std::string SessionsTable(const std::vector<SessionsOutcome>& outcomes);

/// One line per run below a header line. Unavailable if the file cannot be written.
Status WriteSessionsCsv(const std::string& path, const std::vector<SessionsOutcome>& outcomes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SESSIONS_STUDY_H_
