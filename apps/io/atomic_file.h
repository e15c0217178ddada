#ifndef PLUMBLINE_APPS_IO_ATOMIC_FILE_H_
#define PLUMBLINE_APPS_IO_ATOMIC_FILE_H_

#include <fstream>
#include <ostream>
#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// A file that appears whole or not at all: what is written goes to a temporary file beside the
/// target, which Commit() moves into place. Without Commit() nothing remains and an older file of
/// that name is left as it was. Guards against a program that dies, not against a power failure.
class AtomicFile {
 public:
  AtomicFile() = default;
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// NotFound if the folder does not exist, Unavailable if the system refuses. Call once.
  Status Open(const std::string& path);

  /// Takes text and bytes alike. Errors in writing need no attention here: Commit() reports them.
  std::ostream& stream() { return stream_; }

  /// Unavailable if anything could not be written or the target cannot be replaced.
  Status Commit();

 private:
  std::string path_;
  std::string temporary_path_;  // empty while there is no temporary file
  std::ofstream stream_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ATOMIC_FILE_H_
