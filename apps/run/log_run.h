#ifndef PLUMBLINE_APPS_RUN_LOG_RUN_H_
#define PLUMBLINE_APPS_RUN_LOG_RUN_H_

#include <string>

#include "plumbline/apps/run/memory_estimate.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

struct LogRunOptions {
  std::string log;
  std::string output_dir;
  int max_scans = 0;  ///< the first ones are used; 0: all
  MapLogOptions mapping;
  RunOutputOptions outputs;
  double max_memory = 0.0;  ///< what needs more by estimate is refused [bytes]; 0: no limit
  std::string truth, hits;  ///< of a simulated log, see ReadTruth; may be empty
  /// Processes that run with the same options and share the work; null: this one does it all.
  /// Without calibration then.
  const Peers* peers = nullptr;
};

/// Maps a log: reads it, finds the seed, estimates all poses and points, and leaves all results in
/// the output folder. Prints what happens. Until there is a seed, a stop signal (stop_signal.h)
/// ends the program; after that it ends the estimation, and what is written is the best state so
/// far. A failed Status names the culprit.
Status RunLog(const LogRunOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_LOG_RUN_H_
