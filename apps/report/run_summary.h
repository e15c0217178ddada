#ifndef PLUMBLINE_APPS_REPORT_RUN_SUMMARY_H_
#define PLUMBLINE_APPS_REPORT_RUN_SUMMARY_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/io/warning.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// One of the processes that share a run.
struct ProcessSummary {
  std::size_t num_poses = 0;    ///< whose scans it has
  std::size_t num_returns = 0;  ///< that it has
  std::size_t peak_memory_bytes = 0;
  PeersTraffic traffic;  ///< of the joint estimation
};

/// Everything a run reports, for machines to read.
struct RunSummary {
  std::string log;
  std::size_t num_scans = 0;
  std::size_t num_returns = 0;
  std::size_t num_skipped_records = 0;
  std::optional<double> no_return_level_m;  ///< of the log, see FindNoReturnLevel
  double read_time_s = 0.0;
  double seed_time_s = 0.0;  ///< normals included
  MappingReport mapping;
  std::vector<Stage> stages;
  std::string stopped_by;         ///< name of the signal; empty if the run came to its own end
  std::vector<Warning> warnings;  ///< of the input first
  std::vector<ProcessSummary> processes;  ///< by rank; empty if there is one only
};

/// Largest resident memory of this process so far [bytes].
std::size_t PeakMemoryBytes();

/// What each of the processes that share a graph has to report, with the traffic of its own.
/// Collective.
std::vector<ProcessSummary> ProcessSummaries(const SlamGraph& graph, const PeersTraffic& traffic);

/// The content of summary.json, with the flags in force.
Json RunSummaryJson(const RunSummary& summary);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_RUN_SUMMARY_H_
