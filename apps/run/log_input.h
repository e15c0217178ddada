#ifndef PLUMBLINE_APPS_RUN_LOG_INPUT_H_
#define PLUMBLINE_APPS_RUN_LOG_INPUT_H_

#include <string>

#include "plumbline/apps/report/run_summary.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Reads a log for a run (ReadLogIntoGraph), and says what was read, and on standard error what is
/// doubtful: no odometry, or a clock that is of no use. Fills in what the summary says of reading.
Status ReadLogInput(const std::string& path, int max_scans, double max_bytes, RunSummary* summary,
                    SlamGraph* graph);

/// The same for one of several logs, which may also be a pose graph with scans (LogOfPoseGraph).
Status ReadSession(const std::string& path, int max_scans, double max_bytes, RunSummary* summary,
                   SlamGraph* graph);

/// Reads a finished map, a pose graph with scans: all of its poses are fixed. InvalidArgument if it
/// is none.
Status ReadFixedMap(const std::string& path, double max_bytes, RunSummary* summary,
                    SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_LOG_INPUT_H_
