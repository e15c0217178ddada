#ifndef PLUMBLINE_APPS_REPORT_RUN_SUMMARY_H_
#define PLUMBLINE_APPS_REPORT_RUN_SUMMARY_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/apps/report/report_json.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// Everything a run reports, for machines to read.
struct RunSummary {
  std::string log;
  std::size_t num_scans = 0;
  std::size_t num_returns = 0;
  std::size_t num_skipped_records = 0;
  double read_time_s = 0.0;
  double seed_time_s = 0.0;  ///< normals included
  MappingReport mapping;
  std::vector<Stage> stages;
  std::string stopped_by;             ///< name of the signal; empty if the run came to its own end
  std::vector<std::string> warnings;  ///< lines for people
};

/// Largest resident memory of this process so far [bytes].
std::size_t PeakMemoryBytes();

/// The content of summary.json, with the flags in force.
Json RunSummaryJson(const RunSummary& summary);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_RUN_SUMMARY_H_
