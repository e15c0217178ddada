#ifndef PLUMBLINE_APPS_IO_LITTLE_ENDIAN_H_
#define PLUMBLINE_APPS_IO_LITTLE_ENDIAN_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <vector>

namespace plumbline {

/// Stores the bytes of an unsigned integer, the least significant first, on any machine. Gives the
/// place behind them.
template <typename T>
unsigned char* StoreLittleEndian(T value, unsigned char* out) {
  for (std::size_t i = 0; i < sizeof(T); ++i) *out++ = static_cast<unsigned char>(value >> (8 * i));
  return out;
}

inline unsigned char* StoreDouble(double value, unsigned char* out) {
  std::uint64_t bits = 0;
  static_assert(sizeof(bits) == sizeof(value), "a double has 8 bytes");
  std::memcpy(&bits, &value, sizeof(bits));
  return StoreLittleEndian(bits, out);
}

inline unsigned char* StoreFloat(float value, unsigned char* out) {
  std::uint32_t bits = 0;
  static_assert(sizeof(bits) == sizeof(value), "a float has 4 bytes");
  std::memcpy(&bits, &value, sizeof(bits));
  return StoreLittleEndian(bits, out);
}

/// The unsigned integer that StoreLittleEndian has stored.
template <typename T>
T LoadLittleEndian(const char* bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = static_cast<T>(value | static_cast<T>(static_cast<unsigned char>(bytes[i])) << (8 * i));
  }
  return value;
}

inline double LoadDouble(const char* bytes) {
  const std::uint64_t bits = LoadLittleEndian<std::uint64_t>(bytes);
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

/// Writes records of one size: store(i, out) stores record i and gives the place behind it.
template <typename Store>
void WriteRecords(std::size_t num_records, std::size_t bytes_per_record, const Store& store,
                  std::ostream* stream) {
  constexpr std::size_t kRecordsPerBlock = 1 << 14;
  std::vector<unsigned char> block(std::min(num_records, kRecordsPerBlock) * bytes_per_record);
  for (std::size_t begin = 0; begin < num_records; begin += kRecordsPerBlock) {
    const std::size_t end = std::min(begin + kRecordsPerBlock, num_records);
    unsigned char* out = block.data();
    for (std::size_t i = begin; i < end; ++i) out = store(i, out);
    stream->write(reinterpret_cast<const char*>(block.data()), out - block.data());
  }
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_LITTLE_ENDIAN_H_
