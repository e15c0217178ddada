#ifndef PLUMBLINE_APPS_BENCHMARK_REPLAY_REPORT_H_
#define PLUMBLINE_APPS_BENCHMARK_REPLAY_REPORT_H_

#include <string>

#include "plumbline/apps/benchmark/replay.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// For people: how many solves of each kind there were and how long they took, and how the result
/// compares to the batch solution. The replay must have steps, here as below.
std::string ReplayTable(const Replay& replay);

/// One line per solve. Unavailable if the file cannot be written.
Status WriteReplayCsv(const std::string& path, const Replay& replay);

/// A picture of the seconds per solve over the poses that had arrived. Fails likewise.
Status WriteReplayChart(const std::string& path, const Replay& replay);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_REPLAY_REPORT_H_
