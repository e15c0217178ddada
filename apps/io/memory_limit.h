#ifndef PLUMBLINE_APPS_IO_MEMORY_LIMIT_H_
#define PLUMBLINE_APPS_IO_MEMORY_LIMIT_H_

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

namespace plumbline {

/// Counts what a reader keeps of a file.
class MemoryLimit {
 public:
  /// 0: no limit.
  explicit MemoryLimit(double max_bytes) : max_bytes_(max_bytes) {}

  /// False if that is more than allowed, all in all.
  bool Keep(std::size_t bytes) {
    kept_bytes_ += static_cast<double>(bytes);
    return max_bytes_ == 0.0 || kept_bytes_ <= max_bytes_;
  }

  /// How many more that may be.
  std::size_t Left() const {
    const double left = std::max(0.0, max_bytes_ - kept_bytes_);
    constexpr auto kMost = std::numeric_limits<std::size_t>::max();
    return max_bytes_ == 0.0 || left >= static_cast<double>(kMost) ? kMost
                                                                   : static_cast<std::size_t>(left);
  }

  /// What to say then, of the place where reading has come to.
  std::string Fault() const {
    constexpr double kBytesPerMb = 1e6;
    return "what was read so far takes more memory than the " +
           std::to_string(static_cast<long long>(max_bytes_ / kBytesPerMb)) + " MB allowed";
  }

 private:
  double max_bytes_;
  double kept_bytes_ = 0.0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_MEMORY_LIMIT_H_
