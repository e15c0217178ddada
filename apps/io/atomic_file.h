#ifndef PLUMBLINE_APPS_IO_ATOMIC_FILE_H_
#define PLUMBLINE_APPS_IO_ATOMIC_FILE_H_

#include <ostream>
#include <string>
#include <string_view>

#include "plumbline/apps/io/file_buffer.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A file that appears whole or not at all: what is written goes to a temporary file beside the
/// target, which Commit() moves into place once the disk has it. Without Commit() nothing remains
/// and an older file of that name is left as it was. A program that is killed leaves the temporary
/// file behind, see TargetOfTemporary.
class AtomicFile {
 public:
  AtomicFile() = default;
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Unavailable if the folder does not exist or the system refuses. Call once.
  Status Open(const std::string& path);

  /// Takes text and bytes alike. Errors in writing need no attention here: Commit() reports them.
  std::ostream& stream() { return stream_; }

  /// Unavailable if anything could not be written or the target cannot be replaced, NotFound if it
  /// or its folder is gone; the message gives the system's reason.
  Status Commit();

 private:
  std::string path_;
  std::string temporary_path_;  // empty while there is no temporary file
  FileBuffer buffer_;
  std::ostream stream_{&buffer_};
};

/// Of the name of a temporary file, "map.pgm.4711-0.tmp", what it was to become: "map.pgm". Empty
/// for any other name.
std::string_view TargetOfTemporary(std::string_view name);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ATOMIC_FILE_H_
