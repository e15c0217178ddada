#ifndef PLUMBLINE_APPS_IO_TEXT_READER_H_
#define PLUMBLINE_APPS_IO_TEXT_READER_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plumbline/core/status.h"

struct gzFile_s;

namespace plumbline {

/// Reads a text file line by line, gzip-compressed or plain (told by content, not by name). A byte
/// order mark of UTF-8 at its start is skipped. Memory is that of the longest line, 16 MiB at most.
/// What gzip expands to more than 64 MiB and 200 times its size is refused: logs shrink to a tenth,
/// and a hostile file could keep a program busy with a thousand times its size.
class TextReader {
 public:
  TextReader() = default;
  ~TextReader();
  TextReader(const TextReader&) = delete;
  TextReader& operator=(const TextReader&) = delete;

  /// NotFound if there is no such file, Unavailable if the system refuses, InvalidArgument for a
  /// pipe or a device. Call once.
  Status Open(const std::string& path);

  /// The next line without its line end (\n or \r\n), valid until the next call. False at the end
  /// of the file, or where a damaged file breaks off: the unfinished line is then withheld.
  bool NextLine(std::string_view* line);

  /// Of the line last handed out, counted from 1.
  std::size_t line_number() const { return line_number_; }

  /// Once NextLine has returned false. DataLoss: the compressed stream is corrupt, and since its
  /// checksum comes last, so may be lines handed out before. Unavailable: the system failed to
  /// read. InvalidArgument: a line is longer than 16 MiB, or a compressed file expands to too much.
  const Status& status() const { return status_; }

  /// Once NextLine has returned false: the compressed file lacks its end. Lines handed out are
  /// sound.
  bool truncated() const { return truncated_; }

  /// The same for a reader that wants all or nothing: the status, or DataLoss if truncated.
  Status CheckWhole() const;

 private:
  void Refill();

  std::string path_;
  gzFile_s* file_ = nullptr;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;                     // unread part of the buffer
  std::uintmax_t num_expanded_ = 0, max_expanded_ = 0;  // [bytes]
  bool at_end_ = false;
  bool truncated_ = false;
  std::size_t line_number_ = 0;
  Status status_;
};

/// The first bytes of a file, at most `size` of them, expanded if gzip has compressed it; none if
/// it cannot be read.
std::string StartOfFile(const std::string& path, std::size_t size);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_TEXT_READER_H_
