#ifndef PLUMBLINE_APPS_IO_BINARY_ARCHIVE_H_
#define PLUMBLINE_APPS_IO_BINARY_ARCHIVE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "plumbline/apps/io/little_endian.h"

namespace plumbline {

// A writer and a reader of the same interface, so that one function can say for both what a struct
// is made of: a template Visit(archive, &struct) that hands the fields to the archive, in order.
// Numbers take 8 bytes, the least significant first; a double keeps every bit.

/// Appends values to a string of bytes.
class BinaryWriter {
 public:
  template <typename... Values>
  void operator()(Values&... values) {
    (Put(values), ...);
  }

  const std::string& bytes() const { return bytes_; }

 private:
  void Put(double& value) {
    std::array<unsigned char, sizeof(double)> stored;
    Append(stored.data(), StoreDouble(value, stored.data()));
  }
  template <typename T, std::enable_if_t<std::is_integral_v<T> || std::is_enum_v<T>, int> = 0>
  void Put(T& value) {
    PutNumber(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)));
  }
  void Put(std::string& text) {
    PutNumber(text.size());
    bytes_ += text;
  }
  template <typename T>
  void Put(std::vector<T>& values) {
    PutNumber(values.size());
    for (T& value : values) Put(value);
  }
  template <typename T, std::enable_if_t<std::is_class_v<T>, int> = 0>
  void Put(T& value) {
    Visit(*this, &value);
  }

  void PutNumber(std::uint64_t value) {
    std::array<unsigned char, sizeof(value)> stored;
    Append(stored.data(), StoreLittleEndian(value, stored.data()));
  }
  void Append(const unsigned char* begin, const unsigned char* end) { bytes_.append(begin, end); }

  std::string bytes_;
};

/// Takes values back from bytes that a BinaryWriter has written, in the same order.
class BinaryReader {
 public:
  /// The bytes have to outlive the reader.
  explicit BinaryReader(std::string_view bytes) : rest_(bytes) {}

  template <typename... Values>
  void operator()(Values&... values) {
    (Get(values), ...);
  }

  /// False if the bytes ended too early, or held what a value cannot be: values are then zero from
  /// there on, and vectors empty.
  bool ok() const { return ok_; }
  /// Whether nothing is left to take.
  bool at_end() const { return rest_.empty(); }

 private:
  void Get(double& value) { value = Has(sizeof(value)) ? LoadDouble(Take(sizeof(value))) : 0.0; }
  template <typename T, std::enable_if_t<std::is_integral_v<T> || std::is_enum_v<T>, int> = 0>
  void Get(T& value) {
    const auto number = static_cast<std::int64_t>(GetNumber());
    value = static_cast<T>(number);
    if (static_cast<std::int64_t>(value) != number) Fail();
  }
  void Get(std::string& text) {
    const std::size_t size = GetSize();
    text.assign(Take(size), size);
  }
  template <typename T>
  void Get(std::vector<T>& values) {
    values.resize(GetSize());
    for (T& value : values) Get(value);
    if (!ok_) values.clear();
  }
  template <typename T, std::enable_if_t<std::is_class_v<T>, int> = 0>
  void Get(T& value) {
    Visit(*this, &value);
  }

  // Of a vector or text: every element takes a byte at least, which bounds what is allocated.
  std::size_t GetSize() {
    const std::uint64_t size = GetNumber();
    return Has(size) ? static_cast<std::size_t>(size) : 0;
  }
  std::uint64_t GetNumber() {
    return Has(sizeof(std::uint64_t)) ? LoadLittleEndian<std::uint64_t>(Take(sizeof(std::uint64_t)))
                                      : 0;
  }
  bool Has(std::uint64_t size) {
    if (size > rest_.size()) Fail();
    return ok_;
  }
  const char* Take(std::size_t size) {
    const char* begin = rest_.data();
    rest_.remove_prefix(size);
    return begin;
  }
  void Fail() {
    ok_ = false;
    rest_ = {};
  }

  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_BINARY_ARCHIVE_H_
