#ifndef PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_STREAM_H_
#define PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_STREAM_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "plumbline/apps/io/byte_reader.h"
#include "plumbline/apps/io/memory_limit.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How files of Cartographer begin.
constexpr std::string_view kCartographerMagic("\xdb\x01\xf5\x5b\x7b\x1f\x1d\x7b", 8);

/// Takes the messages out of a file of Cartographer (.pbstream): the magic, then for each message
/// its length (8 bytes, the least significant first) and as many bytes of gzip. Messages that
/// expand to more than 1 GiB, or together to more than 64 MiB and 200 times the file, are refused:
/// states shrink to a fifth, and a hostile file could keep a program busy with a thousand times its
/// size. So are those that take more memory than is left.
class CartographerStream {
 public:
  /// The content of the file and the memory, if one is given, have to outlive the stream. path: for
  /// messages.
  CartographerStream(std::string path, std::string_view content,
                     const MemoryLimit* memory = nullptr);

  /// Goes to the next message; false at the end of the file or where it is damaged, see status().
  bool Next();

  /// Of the message: its number, from 1; what it expands to; and the file after it.
  std::size_t number() const { return number_; }
  std::string_view message() const { return message_; }
  std::string_view rest() const { return file_.rest(); }

  /// Once Next() has returned false: DataLoss if the file is damaged, InvalidArgument if it takes
  /// more memory than there is, naming it and the message.
  const Status& status() const { return status_; }
  /// DataLoss that names the file and the message.
  Status Error(const std::string& problem) const;
  /// InvalidArgument that names the file and the message: it is sound, but not what can be read.
  Status Unsupported(const std::string& problem) const;

 private:
  std::string Place() const;

  const std::string path_;
  ByteReader file_;
  const MemoryLimit* memory_;
  std::uint64_t num_left_;  // that messages may expand to [bytes]
  std::size_t number_ = 0;
  std::string message_;
  Status status_;
};

/// A message as such files have it: its length, and the gzip.
std::string CartographerMessage(std::string_view message);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_STREAM_H_
