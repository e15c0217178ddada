#ifndef PLUMBLINE_APPS_IO_FILE_STATUS_H_
#define PLUMBLINE_APPS_IO_FILE_STATUS_H_

#include <cerrno>
#include <cstring>
#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// What the operating system says of a failed operation on a file, e.g. "cannot open 'a.log': No
/// such file or directory". `error_number` is the value of errno; 0 if the cause is unknown.
inline Status FileError(const std::string& action, const std::string& path, int error_number) {
  const std::string cause = error_number == 0 ? "unknown cause" : std::strerror(error_number);
  const std::string message = "cannot " + action + " '" + path + "': " + cause;
  return error_number == ENOENT ? Status::NotFound(message) : Status::Unavailable(message);
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_FILE_STATUS_H_
