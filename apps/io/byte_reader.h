#ifndef PLUMBLINE_APPS_IO_BYTE_READER_H_
#define PLUMBLINE_APPS_IO_BYTE_READER_H_

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "plumbline/apps/io/little_endian.h"

namespace plumbline {

/// Takes bytes one after the other. The first failure sticks: numbers are then zero and views
/// empty, so that a record is read in one go and checked once.
class ByteReader {
 public:
  /// The bytes have to outlive the reader, and the views that it gives.
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  /// The next bytes. Fails if there are fewer.
  std::string_view Bytes(std::uint64_t size) {
    if (size > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const std::string_view bytes = rest_.substr(0, static_cast<std::size_t>(size));
    rest_.remove_prefix(bytes.size());
    return bytes;
  }

  /// An unsigned integer, the least significant byte first.
  template <typename T>
  T Number() {
    const std::string_view bytes = Bytes(sizeof(T));
    return ok_ ? LoadLittleEndian<T>(bytes.data()) : T{0};
  }

  /// A length of four bytes, and as many bytes.
  std::string_view Text() { return Bytes(Number<std::uint32_t>()); }

  /// False once there was less than was asked for.
  bool ok() const { return ok_; }
  /// What has not been taken.
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_BYTE_READER_H_
