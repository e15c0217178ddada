#include "plumbline/apps/program/read_log.h"

#include <iostream>

#include "plumbline/apps/program/log_flags.h"

namespace plumbline {

Status ReadLogIntoGraph(const std::string& path, int max_scans, LogCounts* counts, SlamGraph* graph,
                        double max_bytes) {
  LogReadOptions options;
  options.max_scans = max_scans;
  options.bag = BagReadOptionsFromFlags();
  options.sweep_time_s = SweepTimeFromFlags();
  options.max_bytes = max_bytes;
  LogNotes notes;
  Status status = ReadLog(path, options, &notes, graph);
  for (const std::string& line : notes.lines) std::cerr << line << '\n';
  if (status.ok()) *counts = notes.counts;
  return status;
}

}  // namespace plumbline
