#include "plumbline/apps/io/ply_writer.h"

#include <cstdint>
#include <sstream>

#include "plumbline/apps/io/little_endian.h"

namespace plumbline {

Status StorePointsPly(const std::string& path, const SlamGraph& graph, const MapState& state,
                      ReturnRecords* file) {
  std::ostringstream header;
  header << "ply\nformat binary_little_endian 1.0\n"
         << "comment map points of Plumbline, x y z [m] in the world frame, z = 0\n"
         << "element vertex " << graph.num_returns_of_all() << "\n"
         << "property double x\nproperty double y\nproperty double z\n"
         << "property int scan\nend_header\n";
  const auto store = [&graph, &state](std::size_t i, unsigned char* out) {
    out = StoreDouble(state.points[2 * i], out);
    out = StoreDouble(state.points[2 * i + 1], out);
    out = StoreDouble(0.0, out);
    const int scan = graph.IdAmongAll(graph.ScanOfReturn(i));
    return StoreLittleEndian(static_cast<std::uint32_t>(scan), out);
  };
  constexpr std::size_t kBytesPerVertex = 3 * sizeof(double) + sizeof(std::int32_t);
  return file->Write(path, header.str(), graph, kBytesPerVertex, store);
}

Status WritePointsPly(const std::string& path, const SlamGraph& graph, const MapState& state) {
  ReturnRecords file;
  PLUMBLINE_RETURN_IF_ERROR(StorePointsPly(path, graph, state, &file));
  return file.Commit();
}

}  // namespace plumbline
