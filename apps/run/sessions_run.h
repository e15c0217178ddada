#ifndef PLUMBLINE_APPS_RUN_SESSIONS_RUN_H_
#define PLUMBLINE_APPS_RUN_SESSIONS_RUN_H_

#include <string>
#include <vector>

#include "plumbline/apps/run/memory_estimate.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

struct SessionsRunOptions {
  std::vector<std::string> logs;  ///< of any format, also pose graphs with scans
  /// Pose graph with scans whose poses stay where they are, in whose frame the logs are localised;
  /// may be empty.
  std::string fixed_map;
  std::string output_dir;
  int max_scans = 0;  ///< the first ones of each log are used; 0: all
  MapLogOptions mapping;
  RunOutputOptions outputs;
  double max_memory = 0.0;  ///< what needs more by estimate is refused [bytes]; 0: no limit
  /// Processes that run with the same options and share the work; null: this one does it all.
  const Peers* peers = nullptr;
};

/// Maps several logs, or one and a finished map, whose relative poses are unknown (SeedSessions):
/// those that show the same place become one map. Prints what happens. If all do, the output folder
/// gets what RunLog leaves there (but no map of the odometry, for each log has its own); if not,
/// each map gets a folder in it, map_1 and so on, and summary.json says which one has which logs.
/// Each map of several logs also gets
///   trajectory_N.tum  of the N-th log, as trajectory.tum has them one after the other
///   sessions.png      the map, coloured by log
///   changes.png       where one log shows what another one looked through
///
/// Stop signals as for RunLog. A failed Status names the culprit.
Status RunSessions(const SessionsRunOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_SESSIONS_RUN_H_
