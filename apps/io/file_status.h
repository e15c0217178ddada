#ifndef PLUMBLINE_APPS_IO_FILE_STATUS_H_
#define PLUMBLINE_APPS_IO_FILE_STATUS_H_

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include "plumbline/core/status.h"

namespace plumbline {

/// What the operating system says of a failed operation on a file, e.g. "cannot open 'a.log': No
/// such file or directory". `error_number` is the value of errno; 0 if the cause is unknown.
inline std::string FileErrorText(const std::string& action, const std::string& path,
                                 int error_number) {
  const std::string cause =
      error_number == 0 ? "unknown cause" : std::generic_category().message(error_number);
  return "cannot " + action + " '" + path + "': " + cause;
}

/// Of a file that cannot be read: NotFound, or InvalidArgument where there is something else.
inline Status ReadError(const std::string& action, const std::string& path, int error_number) {
  const std::string message = FileErrorText(action, path, error_number);
  return error_number == ENOENT ? Status::NotFound(message) : Status::InvalidArgument(message);
}

/// Of a file that cannot be written: Unavailable.
inline Status WriteError(const std::string& action, const std::string& path, int error_number) {
  return Status::Unavailable(FileErrorText(action, path, error_number));
}

/// InvalidArgument for a pipe, a socket or a device: they may never end, and cannot be read twice.
/// Whether anything else can be opened is for the reader to find out.
inline Status RefusePipe(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!std::filesystem::is_other(status)) return Status::Ok();
  return Status::InvalidArgument("cannot read '" + path + "': a pipe or a device, not a file");
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_FILE_STATUS_H_
