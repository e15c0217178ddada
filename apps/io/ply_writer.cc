#include "plumbline/apps/io/ply_writer.h"

#include <cstdint>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/little_endian.h"

namespace plumbline {

Status WritePointsPly(const std::string& path, const SlamGraph& graph, const MapState& state) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  file.stream() << "ply\nformat binary_little_endian 1.0\n"
                << "comment map points of Plumbline, x y z [m] in the world frame, z = 0\n"
                << "element vertex " << graph.num_returns() << "\n"
                << "property double x\nproperty double y\nproperty double z\n"
                << "property int scan\nend_header\n";
  const auto store = [&graph, &state](std::size_t i, unsigned char* out) {
    out = StoreDouble(state.points[2 * i], out);
    out = StoreDouble(state.points[2 * i + 1], out);
    out = StoreDouble(0.0, out);
    return StoreLittleEndian(static_cast<std::uint32_t>(graph.ScanOfReturn(i)), out);
  };
  constexpr std::size_t kBytesPerVertex = 3 * sizeof(double) + sizeof(std::int32_t);
  WriteRecords(graph.num_returns(), kBytesPerVertex, store, &file.stream());
  return file.Commit();
}

}  // namespace plumbline
