#include "plumbline/apps/live/ros_encoder.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "plumbline/apps/io/byte_reader.h"
#include "plumbline/apps/io/little_endian.h"
#include "plumbline/apps/live/ros_values.h"

namespace plumbline {
namespace {

constexpr std::size_t kCdrHeaderBytes = 4;

}  // namespace

template <typename T>
void CdrWriter::Append(T value) {
  const std::size_t size = bytes_.size() - kCdrHeaderBytes;
  const std::size_t begin = bytes_.size() + (sizeof(T) - size % sizeof(T)) % sizeof(T);
  bytes_.resize(begin + sizeof(T));
  StoreLittleEndian(value, reinterpret_cast<unsigned char*>(&bytes_[begin]));
}

void CdrWriter::Single(double value) {
  const auto single = static_cast<float>(value);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &single, sizeof(bits));
  Append(bits);
}

void CdrWriter::Double(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  Append(bits);
}

void CdrWriter::Text(const std::string& text) {
  Unsigned(static_cast<std::uint32_t>(text.size() + 1));
  bytes_.append(text.c_str(), text.size() + 1);
}

void CdrWriter::Time(double stamp_s) {
  const RosTime time = ToRosTime(stamp_s);
  Unsigned(static_cast<std::uint32_t>(time.sec));
  Unsigned(time.nanosec);
}

void CdrWriter::Header(double stamp_s, const std::string& frame) {
  Time(stamp_s);
  Text(frame);
}

void CdrWriter::Pose(const Pose2& pose) {
  for (const double value :
       {pose.x, pose.y, 0.0, 0.0, 0.0, std::sin(0.5 * pose.yaw), std::cos(0.5 * pose.yaw)}) {
    Double(value);
  }
}

std::string EncodeGrid(const LiveMap& map, const std::string& frame) {
  const OccupancyGrid& grid = map.grid;
  CdrWriter writer;
  writer.Header(map.stamp_s, frame);
  writer.Time(map.stamp_s);
  writer.Single(grid.resolution_m);
  writer.Unsigned(static_cast<std::uint32_t>(grid.width));
  writer.Unsigned(static_cast<std::uint32_t>(grid.height));
  writer.Pose({grid.left_m, grid.bottom_m, 0.0});
  writer.Unsigned(static_cast<std::uint32_t>(grid.cells.size()));
  std::string* bytes = &writer.bytes();
  bytes->reserve(bytes->size() + grid.cells.size());
  for (const Occupancy cell : grid.cells) *bytes += static_cast<char>(ToRosCell(cell));
  return std::move(*bytes);
}

std::string EncodePath(const LiveMap& map, const std::string& frame) {
  CdrWriter writer;
  writer.Header(map.stamp_s, frame);
  writer.Unsigned(static_cast<std::uint32_t>(map.path.size()));
  for (const TimedPose& pose : map.path) {
    writer.Header(pose.timestamp_s, frame);
    writer.Pose(pose.world_from_robot);
  }
  return std::move(writer.bytes());
}

std::string EncodeTransform(double stamp_s, const std::string& parent, const std::string& child,
                            const Pose2& parent_from_child) {
  CdrWriter writer;
  writer.Unsigned(1);
  writer.Header(stamp_s, parent);
  writer.Text(child);
  writer.Pose(parent_from_child);
  return std::move(writer.bytes());
}

std::string EncodePose(double stamp_s, const std::string& frame, const Pose2& pose) {
  CdrWriter writer;
  writer.Header(stamp_s, frame);
  writer.Pose(pose);
  for (const double value : RosPoseCovariance()) writer.Double(value);
  return std::move(writer.bytes());
}

std::string EncodeDiagnostic(double stamp_s, const Diagnostic& diagnostic) {
  CdrWriter writer;
  writer.Header(stamp_s, "");
  writer.Unsigned(1);
  writer.Byte(static_cast<int>(diagnostic.level));
  writer.Text(diagnostic.name);
  writer.Text(diagnostic.message);
  writer.Text("");
  writer.Unsigned(static_cast<std::uint32_t>(diagnostic.values.size()));
  for (const auto& [key, value] : diagnostic.values) {
    writer.Text(key);
    writer.Text(value);
  }
  return std::move(writer.bytes());
}

bool DecodeClock(const std::string& bytes, double* time_s) {
  ByteReader reader(bytes);
  const bool is_little_endian =
      reader.Bytes(kCdrHeaderBytes).substr(0, 2) == std::string_view("\0\1", 2);
  const auto seconds = static_cast<std::int32_t>(reader.Number<std::uint32_t>());
  const auto nanoseconds = reader.Number<std::uint32_t>();
  if (!reader.ok() || !is_little_endian) return false;
  *time_s = ToSeconds({seconds, nanoseconds});
  return true;
}

}  // namespace plumbline
