#ifndef PLUMBLINE_APPS_IO_WARNING_H_
#define PLUMBLINE_APPS_IO_WARNING_H_

#include <string>

#include "plumbline/apps/io/field_reader.h"

namespace plumbline {

/// A doubt about an input or a result, for people and for scripts.
struct Warning {
  std::string id;       ///< names the cause, e.g. "mirrored_scans"; apps/README.md lists all
  std::string message;  ///< one sentence or several, with the path of the file
};

/// "warning: MESSAGE [ID]", the line that programs print.
inline std::string WarningLine(const Warning& warning) {
  return "warning: " + Legible(warning.message) + " [" + warning.id + "]";
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_WARNING_H_
