#ifndef PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_
#define PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_

#include <optional>

#include "plumbline/apps/readers/log_reader.h"

namespace plumbline {

/// The options that the command line sets for reading a log.
LogReadOptions LogReadOptionsFromFlags();

/// Time that a sweep takes [s]; empty: what the log says.
std::optional<double> SweepTimeFromFlags();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_LOG_FLAGS_H_
