#ifndef PLUMBLINE_APPS_PROGRAM_LOG_LIST_H_
#define PLUMBLINE_APPS_PROGRAM_LOG_LIST_H_

#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// The logs that the value of a flag names: a path, if there is such a file or folder;
/// "a.clf,b.bag", paths separated by commas; or "@logs.txt", a text file with a path per line. Its
/// paths start at its own folder; empty lines and those that start with # do not count.
///
/// InvalidArgument on an empty value or name, on a list of no logs, and on a log that is named
/// twice; NotFound or Unavailable if the list cannot be read, DataLoss if it is no text. The
/// message names the file and the line.
Status ParseLogList(const std::string& value, std::vector<std::string>* logs);

/// All files of these logs (LogFiles), and the list, if there is one.
std::vector<std::string> FilesOfLogList(const std::string& value);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_LOG_LIST_H_
