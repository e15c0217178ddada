#ifndef PLUMBLINE_APPS_LIVE_ROS_ENCODER_H_
#define PLUMBLINE_APPS_LIVE_ROS_ENCODER_H_

#include <cstdint>
#include <string>

#include "plumbline/apps/live/diagnostic.h"
#include "plumbline/apps/live/live_map.h"
#include "plumbline/core/pose2.h"

namespace plumbline {

/// Writes the fields of a message in plain CDR, little-endian, as ROS 2 sends it.
class CdrWriter {
 public:
  CdrWriter() : bytes_("\0\1\0\0", 4) {}

  void Byte(int value) { bytes_ += static_cast<char>(value); }
  void Unsigned(std::uint32_t value) { Append(value); }
  void Unsigned64(std::uint64_t value) { Append(value); }
  void Single(double value);
  void Double(double value);
  void Text(const std::string& text);
  /// A builtin_interfaces/Time.
  void Time(double stamp_s);
  /// A std_msgs/Header.
  void Header(double stamp_s, const std::string& frame);
  /// A geometry_msgs/Pose or Transform in the plane.
  void Pose(const Pose2& pose);
  std::string& bytes() { return bytes_; }

 private:
  template <typename T>
  void Append(T value);

  std::string bytes_;  // with the header of the encoding, from the end of which fields are aligned
};

/// A nav_msgs/OccupancyGrid: 100 occupied, 0 free, -1 unknown.
std::string EncodeGrid(const LiveMap& map, const std::string& frame);
/// A nav_msgs/Path.
std::string EncodePath(const LiveMap& map, const std::string& frame);
/// A tf2_msgs/TFMessage with one transform.
std::string EncodeTransform(double stamp_s, const std::string& parent, const std::string& child,
                            const Pose2& parent_from_child);
/// A geometry_msgs/PoseWithCovarianceStamped.
std::string EncodePose(double stamp_s, const std::string& frame, const Pose2& pose);

/// A diagnostic_msgs/DiagnosticArray with one status.
std::string EncodeDiagnostic(double stamp_s, const Diagnostic& diagnostic);

/// Reads a rosgraph_msgs/Clock. False if the bytes are none, or big-endian.
bool DecodeClock(const std::string& bytes, double* time_s);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_ROS_ENCODER_H_
