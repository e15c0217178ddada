#ifndef PLUMBLINE_APPS_IO_MEMORY_LIMIT_H_
#define PLUMBLINE_APPS_IO_MEMORY_LIMIT_H_

#include <cstddef>
#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Counts what a reader keeps of a file of text.
class MemoryLimit {
 public:
  /// 0: no limit.
  explicit MemoryLimit(double max_bytes) : max_bytes_(max_bytes) {}

  /// InvalidArgument, naming the file and its line, if that is more than allowed.
  Status Keep(std::size_t bytes, const std::string& path, std::size_t line) {
    constexpr double kBytesPerMb = 1e6;
    kept_bytes_ += static_cast<double>(bytes);
    if (max_bytes_ == 0.0 || kept_bytes_ <= max_bytes_) return Status::Ok();
    return Status::InvalidArgument(
        path + ":" + std::to_string(line) + ": what was read so far takes more memory than the " +
        std::to_string(static_cast<long long>(max_bytes_ / kBytesPerMb)) + " MB allowed");
  }

 private:
  double max_bytes_;
  double kept_bytes_ = 0.0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_MEMORY_LIMIT_H_
