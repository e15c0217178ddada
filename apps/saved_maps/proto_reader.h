#ifndef PLUMBLINE_APPS_SAVED_MAPS_PROTO_READER_H_
#define PLUMBLINE_APPS_SAVED_MAPS_PROTO_READER_H_

#include <cstdint>
#include <string_view>

#include "plumbline/apps/io/byte_reader.h"
#include "plumbline/apps/io/little_endian.h"

namespace plumbline {

/// Goes through the fields of a message of Protocol Buffers (protobuf.dev, Encoding). A field whose
/// value is not taken is skipped. The first failure sticks: there are no fields then, and values
/// are zero or empty, so that a message is read in one go and checked once.
///
///   for (ProtoReader fields(bytes); fields.Next();) {
///     if (fields.number() == 1) x = fields.Double();
///   }
class ProtoReader {
 public:
  /// The bytes have to outlive the reader, and the views that it gives.
  explicit ProtoReader(std::string_view bytes) : rest_(bytes) {}

  /// Goes to the next field; false at the end of the message or where it is damaged.
  bool Next() {
    if (!ok() || rest_.rest().empty()) return false;
    const std::string_view begin = rest_.rest();
    const std::uint64_t tag = Varint(&rest_);
    number_ = tag >> 3;
    wire_type_ = static_cast<int>(tag & 7);
    if (number_ == 0) is_damaged_ = true;
    switch (wire_type_) {
      case kVarint:
        integer_ = Varint(&rest_);
        break;
      case kFixed64:
        value_ = rest_.Bytes(8);
        break;
      case kLengthDelimited:
        value_ = rest_.Bytes(Varint(&rest_));
        break;
      case kFixed32:
        value_ = rest_.Bytes(4);
        break;
      default:  // groups, which nobody writes any more, and what does not exist
        is_damaged_ = true;
    }
    field_ = begin.substr(0, begin.size() - rest_.rest().size());
    return ok();
  }

  /// Of the field: its number, and its bytes with tag and length.
  std::uint64_t number() const { return number_; }
  std::string_view field() const { return field_; }

  /// The value of the field. Each fails if the field has no value of this kind.
  std::string_view Bytes() { return Is(kLengthDelimited) ? value_ : std::string_view(); }
  double Double() { return Is(kFixed64) ? LoadDouble(value_.data()) : 0.0; }
  /// int64, or int32, whose upper half is cut off as other readers do.
  std::int64_t Int64() { return Is(kVarint) ? static_cast<std::int64_t>(integer_) : 0; }
  std::int32_t Int32() { return static_cast<std::int32_t>(Int64()); }
  /// Hands out what a repeated int32 has here: one number, or several that are packed.
  template <typename Take>
  void Int32s(const Take& take) {
    if (wire_type_ == kVarint) return take(Int32());
    ByteReader packed(Bytes());
    while (packed.ok() && !packed.rest().empty()) {
      const auto number = static_cast<std::int32_t>(Varint(&packed));
      if (packed.ok() && !is_damaged_) take(number);
    }
    if (!packed.ok()) is_damaged_ = true;
  }

  /// False once the message turned out to be damaged.
  bool ok() const { return rest_.ok() && !is_damaged_; }

 private:
  enum WireType { kVarint = 0, kFixed64 = 1, kLengthDelimited = 2, kFixed32 = 5 };

  // Seven bits a byte, the lowest first; the highest bit of a byte says whether more follow.
  std::uint64_t Varint(ByteReader* bytes) {
    constexpr int kMaxBytes = 10;
    std::uint64_t number = 0;
    for (int i = 0; i < kMaxBytes; ++i) {
      const auto byte = bytes->Number<std::uint8_t>();
      number |= static_cast<std::uint64_t>(byte & 0x7f) << (7 * i);
      if (byte < 0x80) return number;
    }
    is_damaged_ = true;
    return 0;
  }

  bool Is(WireType type) {
    if (wire_type_ != type) is_damaged_ = true;
    return ok();
  }

  ByteReader rest_;
  bool is_damaged_ = false;
  std::uint64_t number_ = 0;
  int wire_type_ = 0;
  std::uint64_t integer_ = 0;
  std::string_view value_, field_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_PROTO_READER_H_
