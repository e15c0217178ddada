#ifndef PLUMBLINE_APPS_IO_WHOLE_FILE_H_
#define PLUMBLINE_APPS_IO_WHOLE_FILE_H_

#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Reads all bytes of a file. NotFound if there is none, InvalidArgument if it is a folder, a pipe
/// or a device, or cannot be read; *bytes is then of no use.
Status ReadWholeFile(const std::string& path, std::string* bytes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_WHOLE_FILE_H_
