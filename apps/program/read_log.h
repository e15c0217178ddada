#ifndef PLUMBLINE_APPS_PROGRAM_READ_LOG_H_
#define PLUMBLINE_APPS_PROGRAM_READ_LOG_H_

#include <string>

#include "plumbline/apps/readers/log_reader.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// ReadLog for a program: log_flags.h says which topics of a bag, and the notes also go to
/// standard error. Fails like it; what the pointers lead to is then untouched.
Status ReadLogIntoGraph(const std::string& path, int max_scans, LogNotes* notes, SlamGraph* graph,
                        double max_bytes = 0.0);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_READ_LOG_H_
