#include "plumbline/apps/live/fault_log.h"

#include <utility>

#include "plumbline/apps/io/field_reader.h"

namespace plumbline {

void FaultLog::Add(const std::string& kind, const std::string& detail) {
  constexpr std::size_t kMaxKinds = 100, kMaxDetail = 400;
  const bool fits = counts_.size() < kMaxKinds || counts_.count(kind) > 0;
  const std::string counted = fits ? kind : "other faults";
  if (++counts_[counted] > 1) return;
  news_.push_back(counted + (detail.empty() ? "" : ": " + Printable(detail, kMaxDetail)));
}

std::vector<std::string> FaultLog::TakeNews() { return std::exchange(news_, {}); }

}  // namespace plumbline
