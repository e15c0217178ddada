#include "plumbline/apps/io/ply_writer.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"

namespace plumbline {
namespace {

constexpr std::size_t kBytesPerVertex = 3 * sizeof(double) + sizeof(std::int32_t);

/// Stores the bytes of an unsigned integer, the least significant first, on any machine.
template <typename T>
unsigned char* StoreLittleEndian(T value, unsigned char* out) {
  for (std::size_t i = 0; i < sizeof(T); ++i) *out++ = static_cast<unsigned char>(value >> (8 * i));
  return out;
}

unsigned char* StoreDouble(double value, unsigned char* out) {
  std::uint64_t bits = 0;
  static_assert(sizeof(bits) == sizeof(value), "PLY's double has 8 bytes");
  std::memcpy(&bits, &value, sizeof(bits));
  return StoreLittleEndian(bits, out);
}

}  // namespace

Status WritePointsPly(const std::string& path, const SlamGraph& graph) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  const std::size_t num_points = graph.num_returns();
  file.stream() << "ply\nformat binary_little_endian 1.0\n"
                << "comment map points of Plumbline, x y z [m] in the world frame, z = 0\n"
                << "element vertex " << num_points << "\n"
                << "property double x\nproperty double y\nproperty double z\n"
                << "property int scan\nend_header\n";

  constexpr std::size_t kPointsPerBlock = 1 << 14;
  std::vector<unsigned char> block(kPointsPerBlock * kBytesPerVertex);
  for (std::size_t begin = 0; begin < num_points; begin += kPointsPerBlock) {
    const std::size_t end = std::min(begin + kPointsPerBlock, num_points);
    unsigned char* out = block.data();
    for (std::size_t i = begin; i < end; ++i) {
      out = StoreDouble(graph.points()[2 * i], out);
      out = StoreDouble(graph.points()[2 * i + 1], out);
      out = StoreDouble(0.0, out);
      out = StoreLittleEndian(static_cast<std::uint32_t>(graph.returns().scan[i]), out);
    }
    file.stream().write(reinterpret_cast<const char*>(block.data()), out - block.data());
  }
  return file.Commit();
}

}  // namespace plumbline
