#ifndef PLUMBLINE_APPS_BENCHMARK_SEEDED_LOG_H_
#define PLUMBLINE_APPS_BENCHMARK_SEEDED_LOG_H_

#include <string>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// Reads a CARMEN log, or simulates a drive if the path is empty.
Status ReadDrive(const std::string& log, SlamGraph* graph);

/// Reads a CARMEN log, or simulates a drive if the path is empty, and prepares it (PrepareLog).
Status PrepareDrive(const std::string& log, const MapLogOptions& options, LogMapping* mapping);

/// Finds where the solvers start on a prepared log (SeedLog). All threads have ended on return.
/// *solver becomes the options of the joint estimation (RefinementOptions).
Status SeedPreparedDrive(const MapLogOptions& options, LogMapping* mapping, SolverOptions* solver);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SEEDED_LOG_H_
