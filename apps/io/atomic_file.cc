#include "plumbline/apps/io/atomic_file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>

#include "plumbline/apps/io/file_status.h"

namespace plumbline {

AtomicFile::~AtomicFile() {
  if (temporary_path_.empty()) return;
  stream_.close();
  std::remove(temporary_path_.c_str());
}

Status AtomicFile::Open(const std::string& path) {
  static std::atomic<int> counter{0};
  path_ = path;
  const std::string candidate =
      path + ".tmp-" + std::to_string(getpid()) + "-" + std::to_string(counter++);
  errno = 0;
  stream_.open(candidate, std::ios::binary | std::ios::trunc);
  if (!stream_) return FileError("write", path, errno);
  temporary_path_ = candidate;
  return Status::Ok();
}

Status AtomicFile::Commit() {
  if (temporary_path_.empty()) return Status::Unavailable("no file is open for writing");
  errno = 0;
  stream_.close();  // Flushes; a failure of any earlier write shows as well.
  if (!stream_) return FileError("write", path_, errno);
  if (std::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
    return FileError("replace", path_, errno);
  }
  temporary_path_.clear();
  return Status::Ok();
}

}  // namespace plumbline
