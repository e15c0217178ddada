#ifndef PLUMBLINE_TEST_APPS_BAGS_BAG_TESTING_H_
#define PLUMBLINE_TEST_APPS_BAGS_BAG_TESTING_H_

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "plumbline/apps/bags/bag_container.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/pose2.h"

namespace plumbline {

/// How a test writes messages.
enum class TestEncoding { kRos1, kCdr, kBigEndianCdr };

inline const char* NameOf(TestEncoding encoding) {
  return encoding == TestEncoding::kRos1 ? "ros1" : "cdr";
}

/// Writes the fields of a message one by one, independently of the decoder under test.
class MessageWriter {
 public:
  explicit MessageWriter(TestEncoding encoding) : encoding_(encoding) {
    if (encoding == TestEncoding::kCdr) header_ = std::string("\0\1\0\0", 4);
    if (encoding == TestEncoding::kBigEndianCdr) header_ = std::string("\0\0\0\0", 4);
  }

  void Unsigned(std::uint32_t value) { Append(value); }
  void Byte(int value) { body_ += static_cast<char>(value); }
  void Raw(const std::string& bytes) { body_ += bytes; }
  void Single(double value) { Append(static_cast<float>(value)); }
  void Double(double value) { Append(value); }
  void Text(const std::string& text) {
    const bool has_end = encoding_ != TestEncoding::kRos1;
    Unsigned(static_cast<std::uint32_t>(text.size() + (has_end ? 1 : 0)));
    body_ += text;
    if (has_end) body_ += '\0';
  }
  void Header(std::int64_t stamp_ns, const std::string& frame) {
    if (encoding_ == TestEncoding::kRos1) Unsigned(7);
    Unsigned(static_cast<std::uint32_t>(stamp_ns / 1000000000));
    Unsigned(static_cast<std::uint32_t>(stamp_ns % 1000000000));
    Text(frame);
  }
  // In the plane, at a height; upside down: turned by half a turn about x.
  void Pose(const Pose2& pose, double z, bool upside_down = false) {
    for (const double value : {pose.x, pose.y, z}) Double(value);
    const double c = std::cos(pose.yaw / 2.0), s = std::sin(pose.yaw / 2.0);
    if (upside_down) {
      for (const double value : {c, s, 0.0, 0.0}) Double(value);
    } else {
      for (const double value : {0.0, 0.0, s, c}) Double(value);
    }
  }
  void Doubles(int count) {
    for (int i = 0; i < count; ++i) Double(0.25 * i);
  }

  std::string bytes() const { return header_ + body_; }

 private:
  template <typename T>
  void Append(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));  // tests run on little-endian machines
    if (encoding_ == TestEncoding::kBigEndianCdr) std::reverse(bytes, bytes + sizeof(T));
    if (encoding_ != TestEncoding::kRos1)
      body_.resize((body_.size() + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    body_.append(bytes, sizeof(T));
  }

  const TestEncoding encoding_;
  std::string header_, body_;
};

inline std::string ScanBytes(TestEncoding encoding, std::int64_t stamp_ns,
                             const std::vector<double>& ranges, const LaserModel& laser) {
  MessageWriter writer(encoding);
  writer.Header(stamp_ns, "laser");
  writer.Single(laser.first_bearing_rad);
  writer.Single(laser.Bearing(laser.num_beams - 1));
  writer.Single(laser.bearing_step_rad);
  writer.Single(0.0);
  writer.Single(0.0);
  writer.Single(laser.min_range_m);
  writer.Single(laser.max_range_m);
  writer.Unsigned(static_cast<std::uint32_t>(ranges.size()));
  for (const double range : ranges) writer.Single(range);
  writer.Unsigned(1);  // intensities
  writer.Single(47.0);
  return writer.bytes();
}

inline std::string OdometryBytes(TestEncoding encoding, std::int64_t stamp_ns, const Pose2& pose) {
  MessageWriter writer(encoding);
  writer.Header(stamp_ns, "odom");
  writer.Text("base_link");
  writer.Pose(pose, 0.0);
  writer.Doubles(36 + 6 + 36);
  return writer.bytes();
}

inline std::string TransformBytes(TestEncoding encoding, std::int64_t stamp_ns,
                                  const std::string& parent, const std::string& child,
                                  const Pose2& pose, bool upside_down = false) {
  MessageWriter writer(encoding);
  writer.Unsigned(1);
  writer.Header(stamp_ns, parent);
  writer.Text(child);
  writer.Pose(pose, 0.2, upside_down);
  return writer.bytes();
}

struct TestMessage {
  std::string topic, type, encoding;
  std::int64_t time_ns = 0;
  std::string bytes;
};
using TestBag = std::vector<TestMessage>;

constexpr std::int64_t kStart_ns = 1500000000000000000;  // as of a clock on the wall

/// Two scans of three beams and their odometry, a transform, and an image between them.
inline TestBag SmallBag(TestEncoding encoding = TestEncoding::kCdr,
                        const std::string& scan_topic = "/scan") {
  const std::string name = NameOf(encoding);
  const std::string infix = encoding == TestEncoding::kRos1 ? "/" : "/msg/";
  LaserModel laser;
  laser.num_beams = 3;
  laser.first_bearing_rad = -0.5;
  laser.bearing_step_rad = 0.5;
  laser.min_range_m = 0.125;
  laser.max_range_m = 30.0;
  TestBag bag;
  bag.push_back({"/tf_static", "tf2_msgs" + infix + "TFMessage", name, kStart_ns,
                 TransformBytes(encoding, 0, "base_link", "laser", {0.1, 0.2, 0.3})});
  for (int i = 0; i < 2; ++i) {
    const std::int64_t stamp_ns = kStart_ns + i * 250000000;
    bag.push_back({"/odom", "nav_msgs" + infix + "Odometry", name, stamp_ns,
                   OdometryBytes(encoding, stamp_ns, {0.1 * i, 0.0, 0.2 * i})});
    bag.push_back({"/image", "sensor_msgs" + infix + "Image", name, stamp_ns, "no image"});
    bag.push_back({scan_topic, "sensor_msgs" + infix + "LaserScan", name, stamp_ns + 1000,
                   ScanBytes(encoding, stamp_ns, {1.25, std::nan(""), 3.5}, laser)});
  }
  return bag;
}

inline std::string ZstdBytes(const std::string& bytes) {
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), 1));
  return frame;
}

inline std::string Lz4Bytes(const std::string& bytes) {
  std::string frame(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  frame.resize(LZ4F_compressFrame(frame.data(), frame.size(), bytes.data(), bytes.size(), nullptr));
  return frame;
}

/// Topics, times and bytes of the messages that a container holds, or why they cannot be read.
inline Status ReadAll(BagContainer* bag, std::string* content) {
  content->clear();
  return bag->ReadMessages([](const BagTopic& topic) { return topic.name != "/image"; },
                           [content](const BagTopic& topic, double time_s, std::string_view bytes) {
                             *content +=
                                 topic.name + topic.type + topic.encoding + std::to_string(time_s);
                             content->append(bytes);
                             return Status::Ok();
                           });
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_BAGS_BAG_TESTING_H_
