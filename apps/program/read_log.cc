#include "plumbline/apps/program/read_log.h"

#include <iostream>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/log_flags.h"

namespace plumbline {

Status ReadLogIntoGraph(const std::string& path, int max_scans, LogNotes* notes, SlamGraph* graph,
                        double max_bytes) {
  LogReadOptions options = LogReadOptionsFromFlags();
  options.max_scans = max_scans;
  options.max_bytes = max_bytes;
  Status status = ReadLog(path, options, notes, graph);
  for (const std::string& line : notes->skipped) std::cerr << Legible(line) << '\n';
  PrintWarnings(notes->warnings);
  return status;
}

}  // namespace plumbline
