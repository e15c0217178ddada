#ifndef PLUMBLINE_TEST_APPS_SAVED_MAPS_PBSTREAM_TESTING_H_
#define PLUMBLINE_TEST_APPS_SAVED_MAPS_PBSTREAM_TESTING_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/test/apps/io/gzip_bytes.h"

namespace plumbline {

// Writes messages of Protocol Buffers independently of the code under test. Numbers that are zero
// are left out, as they are by version 3 of the language.

inline std::string PbVarint(std::uint64_t number) {
  std::string bytes;
  do {
    const auto low = static_cast<unsigned char>(number % 128);
    number /= 128;
    bytes += static_cast<char>(number == 0 ? low : low + 128);
  } while (number != 0);
  return bytes;
}
inline std::string PbTag(int field, int wire_type) { return PbVarint(field * 8 + wire_type); }
inline std::string PbInt(int field, std::int64_t value) {
  if (value == 0) return "";
  return PbTag(field, 0) + PbVarint(static_cast<std::uint64_t>(value));
}
inline std::string PbDouble(int field, double value) {
  if (value == 0.0) return "";
  char bytes[8];
  std::memcpy(bytes, &value, 8);
  return PbTag(field, 1) + std::string(bytes, 8);
}
inline std::string PbBytes(int field, const std::string& bytes) {
  return PbTag(field, 2) + PbVarint(bytes.size()) + bytes;
}

inline std::string PbQuaternion(const Eigen::Quaterniond& q) {
  return PbDouble(1, q.x()) + PbDouble(2, q.y()) + PbDouble(3, q.z()) + PbDouble(4, q.w());
}
inline std::string PbRigid3(const Eigen::Vector3d& t, const Eigen::Quaterniond& q) {
  return PbBytes(1, PbDouble(1, t.x()) + PbDouble(2, t.y()) + PbDouble(3, t.z())) +
         PbBytes(2, PbQuaternion(q));
}
inline Eigen::Quaterniond Turn(double yaw) {
  return Eigen::Quaterniond(std::cos(0.5 * yaw), 0.0, 0.0, std::sin(0.5 * yaw));
}

/// A node of a test: its level frame is turned and tilted against the tracking frame.
struct PbNode {
  int trajectory = 0, index = 0;
  std::int64_t time_ticks = 0;
  Pose2 map_from_level, local_from_level;
  Eigen::Quaterniond level_from_tracking = Eigen::Quaterniond::Identity();
  std::vector<Eigen::Vector2d> points_in_level;
};
struct PbSubmap {
  int trajectory = 0, index = 0;
  Pose2 map_from_submap;
};
struct PbConstraint {
  int submap = 0, node = 0;  // index into the state's arrays
  Pose2 submap_from_level;
  bool is_intra = true;
};
struct PbState {
  std::vector<PbNode> nodes;
  std::vector<PbSubmap> submaps;
  std::vector<PbConstraint> constraints;
  std::string pose_graph_extras;  // more fields of it
};

/// The tracking frame, given where the level frame lies.
inline std::string PbTrackingPose(const Pose2& parent_from_level, const PbNode& node) {
  return PbRigid3({parent_from_level.x, parent_from_level.y, 0.0},
                  Turn(parent_from_level.yaw) * node.level_from_tracking);
}
inline std::string PbPose(const Pose2& pose) {
  return PbRigid3({pose.x, pose.y, 0.0}, Turn(pose.yaw));
}
inline std::string PbId(int trajectory, int index) {
  return PbInt(1, trajectory) + PbInt(2, index);
}

/// In blocks of 1024 mm, as CompressedPointCloud has them.
inline std::string PbCloud(const std::vector<Eigen::Vector2d>& points, bool packed = true) {
  using Block = std::pair<std::int64_t, std::int64_t>;
  std::map<Block, std::vector<std::int64_t>> blocks;
  for (const Eigen::Vector2d& point : points) {
    const auto x = static_cast<std::int64_t>(std::lround(1000.0 * point.x()));
    const auto y = static_cast<std::int64_t>(std::lround(1000.0 * point.y()));
    const auto block = [](std::int64_t mm) { return mm >= 0 ? mm / 1024 : -((1023 - mm) / 1024); };
    blocks[{block(x), block(y)}].push_back((y - 1024 * block(y)) * 1024 + x - 1024 * block(x));
  }
  std::vector<std::int64_t> numbers;
  for (const auto& [block, in_block] : blocks) {
    numbers.insert(numbers.end(),
                   {static_cast<std::int64_t>(in_block.size()), block.first, block.second, 0});
    numbers.insert(numbers.end(), in_block.begin(), in_block.end());
  }
  std::string data, fields;
  for (const std::int64_t number : numbers) {
    data += PbVarint(static_cast<std::uint64_t>(number));
    fields += PbTag(3, 0) + PbVarint(static_cast<std::uint64_t>(number));
  }
  return PbInt(1, static_cast<std::int64_t>(points.size())) + (packed ? PbBytes(3, data) : fields);
}

inline std::string PbPoseGraph(const PbState& state) {
  std::string bytes;
  for (const PbConstraint& c : state.constraints) {
    const PbSubmap& submap = state.submaps[c.submap];
    const PbNode& node = state.nodes[c.node];
    bytes +=
        PbBytes(2, PbBytes(1, PbId(submap.trajectory, submap.index)) +
                       PbBytes(2, PbId(node.trajectory, node.index)) +
                       PbBytes(3, PbTrackingPose(c.submap_from_level, node)) +
                       PbInt(5, c.is_intra ? 0 : 1) + PbDouble(6, 500.0) + PbDouble(7, 1600.0));
  }
  std::map<int, std::string> trajectories;
  for (const PbNode& node : state.nodes) {
    trajectories[node.trajectory] += PbBytes(
        1, PbInt(1, node.time_ticks) + PbBytes(5, PbTrackingPose(node.map_from_level, node)) +
               PbInt(7, node.index));
  }
  for (const PbSubmap& submap : state.submaps) {
    trajectories[submap.trajectory] +=
        PbBytes(2, PbBytes(1, PbPose(submap.map_from_submap)) + PbInt(2, submap.index));
  }
  for (const auto& [id, fields] : trajectories) bytes += PbBytes(4, fields + PbInt(3, id));
  return bytes + state.pose_graph_extras;
}

inline std::string PbNodeMessage(const PbNode& node) {
  const std::string data = PbInt(1, node.time_ticks) +
                           PbBytes(2, PbQuaternion(node.level_from_tracking)) +
                           PbBytes(3, PbCloud(node.points_in_level)) + PbBytes(4, "") +
                           PbBytes(5, "") + PbBytes(7, PbTrackingPose(node.local_from_level, node));
  return PbBytes(4, PbBytes(1, PbId(node.trajectory, node.index)) + PbBytes(5, data));
}

inline std::string PbSubmapMessage(const PbSubmap& submap, double cell_m = 0.05) {
  const std::string limits = PbDouble(1, cell_m) + PbBytes(2, PbDouble(1, 5.0) + PbDouble(2, 5.0));
  return PbBytes(
      3, PbBytes(1, PbId(submap.trajectory, submap.index)) +
             PbBytes(2, PbBytes(1, PbPose({})) + PbInt(2, 70) + PbInt(3, 1) +
                            PbBytes(4, PbBytes(1, limits) + PbBytes(2, std::string(2000, '\1')))));
}

/// The messages of a file: header, pose graph, options, submaps, nodes, a message of an IMU.
inline std::vector<std::string> PbMessages(const PbState& state, int version = 2) {
  std::vector<std::string> messages = {PbInt(1, version), PbBytes(1, PbPoseGraph(state)),
                                       PbBytes(2, PbBytes(1, "options"))};
  for (const PbSubmap& submap : state.submaps) messages.push_back(PbSubmapMessage(submap));
  for (const PbNode& node : state.nodes) messages.push_back(PbNodeMessage(node));
  messages.push_back(PbBytes(6, PbInt(1, 7) + PbBytes(2, "imu")));
  return messages;
}

const std::string kPbMagic("\xdb\x01\xf5\x5b\x7b\x1f\x1d\x7b", 8);

inline std::string PbLength(std::uint64_t size) {
  std::string bytes;
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>(size >> (8 * i));
  return bytes;
}
inline std::string PbFile(const std::vector<std::string>& messages) {
  std::string bytes = kPbMagic;
  for (const std::string& message : messages) {
    const std::string gzip = GzipBytes(message);
    bytes += PbLength(gzip.size()) + gzip;
  }
  return bytes;
}

constexpr std::int64_t kPbStart = 637574841938168822;  // 1621887393.8168822 s since 1970

/// Three nodes of four points, which one submap was made of, and a second one that closes a loop.
inline PbState SmallPbState() {
  PbState state;
  state.submaps = {{0, 0, {0.5, -0.25, 0.1}}, {0, 1, {1.0, 0.5, -0.2}}};
  for (int i = 0; i < 3; ++i) {
    PbNode node;
    node.index = i;
    node.time_ticks = kPbStart + 2500000 * i;
    node.map_from_level = {0.5 * i, 0.125, 0.3 * i};
    node.local_from_level = {0.5 * i, 0.25, 0.3 * i};
    node.level_from_tracking = Turn(-0.4 + 0.1 * i);
    node.points_in_level = {{1.5, 0.25 * i}, {-2.0, 1.125}, {0.5, -3.0}, {-1.0, -1.0}};
    state.nodes.push_back(node);
    state.constraints.push_back(
        {0, i, Between(state.submaps[0].map_from_submap, node.map_from_level), true});
  }
  state.constraints.push_back(
      {1, 2, Between(state.submaps[1].map_from_submap, state.nodes[2].map_from_level), false});
  return state;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_SAVED_MAPS_PBSTREAM_TESTING_H_
