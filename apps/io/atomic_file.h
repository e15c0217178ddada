#ifndef PLUMBLINE_APPS_IO_ATOMIC_FILE_H_
#define PLUMBLINE_APPS_IO_ATOMIC_FILE_H_

#include <sys/stat.h>

#include <ostream>
#include <string>
#include <string_view>

#include "plumbline/apps/io/file_buffer.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A file that appears whole or not at all: what is written goes to a temporary file beside the
/// target, which Commit() moves into place once the disk has it. Without Commit() nothing remains
/// and an older file of that name is left as it was. A signal that ends the program can take the
/// temporary file along (TemporaryFiles); a program that is killed leaves it behind, see
/// TargetOfTemporary.
///
/// A symbolic link stays: what it leads to is written, and made if it is not there. A file that is
/// replaced hands on its permissions, and its owner where the system allows it. What is no regular
/// file (a device, a pipe) and what standard output or standard error goes to is written as it is,
/// without a temporary file.
class AtomicFile {
 public:
  AtomicFile() = default;
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Unavailable if the path is a folder, if its folder does not exist or if the system refuses. A
  /// pipe waits for its reader. Call once.
  Status Open(const std::string& path);

  /// Takes text and bytes alike. Errors in writing need no attention here: Commit() reports them.
  std::ostream& stream() { return stream_; }

  /// Where the bytes are until Commit(), for other processes to write some of them; empty if they
  /// go to the path itself.
  const std::string& temporary_path() const { return temporary_path_; }

  /// Unavailable if anything could not be written or the target cannot be replaced, NotFound if it
  /// or its folder is gone; the message gives the system's reason.
  Status Commit();

 private:
  // present: the file to replace, null if there is none.
  Status OpenTemporary(const struct stat* present);

  std::string path_;            // as it was given, for messages
  std::string target_path_;     // what it leads to
  std::string temporary_path_;  // empty while there is no temporary file
  FileBuffer buffer_;
  std::ostream stream_{&buffer_};
};

/// Whether a file can be written there, as far as that can be told now: of a pipe or a device
/// nothing is known. Fails like AtomicFile::Open, and leaves everything as it was.
Status CheckWritable(const std::string& path);

/// Where a path leads to if it names a symbolic link, or a link to a link; the end of it need not
/// be there. Any other path is itself.
std::string FollowLinks(const std::string& path);

/// Of the name of a temporary file, "map.pgm.4711-0.tmp", what it was to become: "map.pgm". Empty
/// for any other name.
std::string_view TargetOfTemporary(std::string_view name);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ATOMIC_FILE_H_
