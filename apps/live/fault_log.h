#ifndef PLUMBLINE_APPS_LIVE_FAULT_LOG_H_
#define PLUMBLINE_APPS_LIVE_FAULT_LOG_H_

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace plumbline {

/// The faults of a live drive, by kind. Each kind is told once and counted. Its memory is bounded.
class FaultLog {
 public:
  /// Counts a fault. kind: one of a few texts, as "scans without a frame"; detail: the first
  /// fault of its kind, for people. Kinds beyond the first 100 are counted as "other faults".
  void Add(const std::string& kind, const std::string& detail);

  /// The kinds that are new since the last call, each with its detail, a line each.
  std::vector<std::string> TakeNews();

  /// Number of faults by kind.
  const std::map<std::string, std::size_t>& counts() const { return counts_; }

 private:
  std::map<std::string, std::size_t> counts_;
  std::vector<std::string> news_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_FAULT_LOG_H_
