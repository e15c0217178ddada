#ifndef PLUMBLINE_APPS_PROGRAM_READ_LOG_H_
#define PLUMBLINE_APPS_PROGRAM_READ_LOG_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What did not fit into the graph as it stood.
struct LogCounts {
  std::size_t num_skipped_records = 0;
  std::size_t num_out_of_order = 0;
};

/// The files that a log is made of, see FilesOfLog; of what cannot be read, the path itself.
std::vector<std::string> LogFiles(const std::string& path);

/// Reads the first `max_scans` scans of a CARMEN log or of a bag of ROS 1 or ROS 2 (0 = all) into a
/// graph placed by odometry, for a program: log_flags.h says which topics of a bag; the first
/// records that are skipped, and what is doubtful about the laser's mounting, the order of its
/// beams or its readings (ImplausibleReadings), are named on standard error. A map that
/// slam_toolbox has saved is read as well, with its own poses and edges and all of its scans. Fails
/// like the reader of the format and its BuildGraph, and with InvalidArgument if no scan has a
/// return, or if reading takes more than max_bytes of memory (0: no limit); what the
/// pointers lead to is then untouched.
Status ReadLogIntoGraph(const std::string& path, int max_scans, LogCounts* counts, SlamGraph* graph,
                        double max_bytes = 0.0);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_READ_LOG_H_
