#ifndef PLUMBLINE_APPS_SAVED_MAPS_PROTO_WRITER_H_
#define PLUMBLINE_APPS_SAVED_MAPS_PROTO_WRITER_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "plumbline/apps/io/little_endian.h"

namespace plumbline {

/// Puts together a message of Protocol Buffers, field by field, see ProtoReader.
class ProtoWriter {
 public:
  void Double(int number, double value) {
    char bytes[sizeof(value)];
    StoreDouble(value, reinterpret_cast<unsigned char*>(bytes));
    Tag(number, 1);
    bytes_.append(bytes, sizeof(bytes));
  }
  /// Text, or a message.
  void Bytes(int number, std::string_view value) {
    Tag(number, 2);
    Varint(value.size());
    bytes_.append(value);
  }
  /// A field as another message has it, see ProtoReader::field.
  void Field(std::string_view field) { bytes_.append(field); }

  const std::string& bytes() const { return bytes_; }

 private:
  void Tag(int number, int wire_type) {
    Varint(static_cast<std::uint64_t>(number << 3 | wire_type));
  }
  void Varint(std::uint64_t number) {
    for (; number >= 0x80; number >>= 7) bytes_ += static_cast<char>(number | 0x80);
    bytes_ += static_cast<char>(number);
  }

  std::string bytes_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_PROTO_WRITER_H_
