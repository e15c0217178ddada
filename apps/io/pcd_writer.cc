#include "plumbline/apps/io/pcd_writer.h"

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <sstream>

#include "plumbline/apps/io/little_endian.h"

namespace plumbline {
namespace {

// What the file's coordinates are relative to [m], a multiple of 10 km.
Eigen::Vector2d Offset(const MapState& state) {
  constexpr double kStepM = 10000.0;
  if (state.poses.empty()) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d start = state.WorldFromRobot(0).translation();
  // Plus zero: no "-0" in the header.
  return {kStepM * std::round(start.x() / kStepM) + 0.0,
          kStepM * std::round(start.y() / kStepM) + 0.0};
}

}  // namespace

Status StorePointsPcd(const std::string& path, const SlamGraph& graph, const MapState& state,
                      ReturnRecords* file) {
  const Eigen::Vector2d offset = Offset(state);
  if (!offset.allFinite()) {
    return Status::InvalidArgument("'" + path + "': the first pose is not finite");
  }
  std::ostringstream header;
  header.precision(17);
  header << "# .PCD v0.7 - Point Cloud Data file format\n"
         << "# map points of Plumbline [m], world point = VIEWPOINT + point, z = 0\n"
         << "VERSION 0.7\nFIELDS x y z scan\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
         << "WIDTH " << graph.num_returns_of_all() << "\nHEIGHT 1\n"
         << "VIEWPOINT " << offset.x() << ' ' << offset.y() << " 0 1 0 0 0\n"
         << "POINTS " << graph.num_returns_of_all() << "\nDATA binary\n";
  const auto store = [&graph, &state, &offset](std::size_t i, unsigned char* out) {
    out = StoreFloat(static_cast<float>(state.points[2 * i] - offset.x()), out);
    out = StoreFloat(static_cast<float>(state.points[2 * i + 1] - offset.y()), out);
    out = StoreFloat(0.0f, out);
    const int scan = graph.IdAmongAll(graph.ScanOfReturn(i));
    return StoreLittleEndian(static_cast<std::uint32_t>(scan), out);
  };
  constexpr std::size_t kBytesPerPoint = 3 * sizeof(float) + sizeof(std::uint32_t);
  return file->Write(path, header.str(), graph, kBytesPerPoint, store);
}

Status WritePointsPcd(const std::string& path, const SlamGraph& graph, const MapState& state) {
  ReturnRecords file;
  PLUMBLINE_RETURN_IF_ERROR(StorePointsPcd(path, graph, state, &file));
  return file.Commit();
}

}  // namespace plumbline
