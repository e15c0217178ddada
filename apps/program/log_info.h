#ifndef PLUMBLINE_APPS_PROGRAM_LOG_INFO_H_
#define PLUMBLINE_APPS_PROGRAM_LOG_INFO_H_

#include <string>

#include "plumbline/apps/readers/log_reader.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Describes a log, a bag or a pose graph for people, a line each, without mapping it: topics or
/// records with their number, time and rate, the geometry of the laser, and the inputs of a run
/// with its warnings, or the reason for which a run would refuse the file. Fails like the reader of
/// the format; a log or bag that a run would refuse is described all the same.
Status DescribeInput(const std::string& path, const LogReadOptions& options, std::string* text);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_LOG_INFO_H_
