#ifndef PLUMBLINE_APPS_LIVE_DIAGNOSTIC_H_
#define PLUMBLINE_APPS_LIVE_DIAGNOSTIC_H_

#include <string>
#include <utility>
#include <vector>

namespace plumbline {

/// Levels of a diagnostic_msgs/DiagnosticStatus.
enum class DiagnosticLevel { kOk = 0, kWarn = 1, kError = 2 };

/// A diagnostic_msgs/DiagnosticStatus.
struct Diagnostic {
  DiagnosticLevel level = DiagnosticLevel::kOk;
  std::string name, message;
  std::vector<std::pair<std::string, std::string>> values;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_DIAGNOSTIC_H_
