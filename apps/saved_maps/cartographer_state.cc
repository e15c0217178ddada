#include "plumbline/apps/saved_maps/cartographer_state.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/memory_limit.h"
#include "plumbline/apps/io/whole_file.h"
#include "plumbline/apps/saved_maps/cartographer_pose.h"
#include "plumbline/apps/saved_maps/cartographer_stream.h"
#include "plumbline/apps/saved_maps/proto_reader.h"

namespace plumbline {
namespace {

using IndexOfId = std::map<CartographerId, int>;

// What a cell of a grid may measure.
constexpr double kMinCellM = 1e-3, kMaxCellM = 100.0;

std::string NameOf(const char* kind, const CartographerId& id) {
  return std::string(kind) + " " + std::to_string(id.index) + " of trajectory " +
         std::to_string(id.trajectory);
}

// Seconds since 1970 of Cartographer's clock, which ticks since the year 1.
double UnixTime(std::int64_t ticks) {
  constexpr std::int64_t kTicksPerSecond = 10000000;
  constexpr std::int64_t kUnixEpochS = std::int64_t{719162} * 24 * 60 * 60;
  const std::int64_t seconds = ticks / kTicksPerSecond - kUnixEpochS;
  return static_cast<double>(seconds) + 1e-7 * static_cast<double>(ticks % kTicksPerSecond);
}

// The messages SubmapId and NodeId.
bool ReadId(std::string_view message, CartographerId* id) {
  ProtoReader fields(message);
  while (fields.Next()) {
    if (fields.number() == 1) id->trajectory = fields.Int32();
    if (fields.number() == 2) id->index = fields.Int32();
  }
  return fields.ok();
}

// Points come in blocks of 1024 mm: the number of points, the block's place, and for each point its
// place in the block, ten bits a coordinate. False if the numbers do not add up, or beyond the
// 8.4 km that Cartographer allows, and if there are too many.
bool ReadPoints(std::string_view message, std::vector<Eigen::Vector2i>* points_mm) {
  constexpr int kBlockMm = 1024, kMaxBlock = 1 << 13;
  // A scan of a million points takes less; what is read of it takes twelve times the bytes.
  constexpr std::size_t kMaxBytes = std::size_t{1} << 24;
  if (message.size() > kMaxBytes) return false;
  std::int32_t num_points = 0;
  std::vector<std::int32_t> data;
  ProtoReader fields(message);
  while (fields.Next()) {
    if (fields.number() == 1) num_points = fields.Int32();
    if (fields.number() == 3)
      fields.Int32s([&data](std::int32_t number) { data.push_back(number); });
  }
  if (!fields.ok()) return false;
  points_mm->clear();
  for (std::size_t i = 0; i < data.size();) {
    if (data.size() - i < 4 || data[i] < 0 ||
        data.size() - i - 4 < static_cast<std::size_t>(data[i])) {
      return false;
    }
    const Eigen::Vector2i block(data[i + 1], data[i + 2]);
    if (block.minCoeff() < -kMaxBlock || block.maxCoeff() >= kMaxBlock) return false;
    const std::size_t end = i + 4 + static_cast<std::size_t>(data[i]);
    for (i += 4; i < end; ++i) {
      const auto in_block = static_cast<std::uint32_t>(data[i]);
      const auto x = static_cast<int>(in_block % kBlockMm);
      const auto y = static_cast<int>(in_block / kBlockMm % kBlockMm);
      points_mm->emplace_back(kBlockMm * block.x() + x, kBlockMm * block.y() + y);
    }
  }
  return static_cast<std::int64_t>(points_mm->size()) == num_points;
}

class Parser {
 public:
  Parser(std::string path, std::string content, const MemoryLimit& memory)
      : path_(std::move(path)), memory_(memory) {
    state_.content = std::move(content);
  }

  Status Parse(CartographerState* state) {
    CartographerStream stream(path_, state_.content, &memory_);
    stream_ = &stream;
    PLUMBLINE_RETURN_IF_ERROR(ParseHeader());
    PLUMBLINE_RETURN_IF_ERROR(ParsePoseGraph());
    while (stream.Next()) PLUMBLINE_RETURN_IF_ERROR(ParseData());
    PLUMBLINE_RETURN_IF_ERROR(stream.status());
    PLUMBLINE_RETURN_IF_ERROR(CheckWhole());
    stream_ = nullptr;
    *state = std::move(state_);
    return Status::Ok();
  }

 private:
  Status Damaged(const std::string& what) const { return stream_->Error("a damaged " + what); }
  Status Keep(std::size_t bytes) {
    if (memory_.Keep(bytes)) return Status::Ok();
    return Status::InvalidArgument(path_ + ": message " + std::to_string(stream_->number()) + ": " +
                                   memory_.Fault());
  }

  // A file that is cut off between two messages shows it here.
  Status CheckWhole() const {
    const auto missing = std::find(has_data_.begin(), has_data_.end(), false);
    if (missing == has_data_.end()) return Status::Ok();
    const CartographerId& id = state_.nodes[missing - has_data_.begin()].id;
    return stream_->Error("the file ends after it, but the data of " + NameOf("node", id) +
                          " were still to come");
  }

  Status ParseHeader() {
    if (!stream_->Next()) {
      return stream_->status().ok() ? stream_->Error("there is no message in it")
                                    : stream_->status();
    }
    std::int64_t version = 0;
    ProtoReader fields(stream_->message());
    while (fields.Next()) {
      if (fields.number() != 1) {
        return stream_->Unsupported(
            "no header: the file is older than Cartographer 1.0, whose tool 'pbstream migrate' "
            "makes a newer one of it");
      }
      version = fields.Int64();
    }
    if (!fields.ok()) return Damaged("header");
    if (version == 1 || version == 2) return Status::Ok();
    return stream_->Unsupported("format version " + std::to_string(version) +
                                ", but only 1 and 2 are known");
  }

  Status ParsePoseGraph() {
    if (!stream_->Next()) {
      return stream_->status().ok() ? stream_->Error("no pose graph follows it")
                                    : stream_->status();
    }
    ProtoReader data(stream_->message());
    std::string_view pose_graph;
    int num_pose_graphs = 0;
    while (data.Next()) {
      if (data.number() != 1) continue;
      pose_graph = data.Bytes();
      ++num_pose_graphs;
    }
    if (!data.ok() || num_pose_graphs != 1) {
      return stream_->Error("not one pose graph, as there should be");
    }
    // Constraints come before what they name.
    ProtoReader trajectories(pose_graph);
    while (trajectories.Next()) {
      if (trajectories.number() == 4) {
        PLUMBLINE_RETURN_IF_ERROR(ParseTrajectory(trajectories.Bytes()));
      }
      if (trajectories.number() == 5) state_.has_landmarks = true;
    }
    ProtoReader constraints(pose_graph);
    while (constraints.Next()) {
      if (constraints.number() != 2) continue;
      PLUMBLINE_RETURN_IF_ERROR(ParseConstraint(constraints.Bytes()));
    }
    return trajectories.ok() && constraints.ok() ? Status::Ok() : Damaged("pose graph");
  }

  Status ParseTrajectory(std::string_view message) {
    int trajectory = 0;
    ProtoReader head(message);
    while (head.Next()) {
      if (head.number() == 3) trajectory = head.Int32();
    }
    ProtoReader fields(message);
    while (fields.Next()) {
      if (fields.number() == 1) {
        PLUMBLINE_RETURN_IF_ERROR(ParseNode(trajectory, fields.Bytes()));
      } else if (fields.number() == 2) {
        PLUMBLINE_RETURN_IF_ERROR(ParseSubmap(trajectory, fields.Bytes()));
      }
    }
    return head.ok() && fields.ok() ? Status::Ok() : Damaged("trajectory");
  }

  Status ParseNode(int trajectory, std::string_view message) {
    CartographerNode node;
    node.id.trajectory = trajectory;
    CartographerPose pose;
    bool has_pose = false;
    ProtoReader fields(message);
    while (fields.Next()) {
      if (fields.number() == 1) node.time_s = UnixTime(fields.Int64());
      if (fields.number() == 5) has_pose = ReadCartographerPose(fields.Bytes(), &pose);
      if (fields.number() == 7) node.id.index = fields.Int32();
    }
    if (!fields.ok() || !has_pose) return Damaged("pose of " + NameOf("node", node.id));
    node.map_from_tracking = pose.InPlane();
    const auto num_nodes = static_cast<int>(state_.nodes.size());
    if (!node_of_id_.emplace(node.id, num_nodes).second) {
      return stream_->Error(NameOf("node", node.id) + " is there twice");
    }
    state_.nodes.push_back(std::move(node));
    has_data_.push_back(false);
    return Keep(sizeof(CartographerNode));
  }

  Status ParseSubmap(int trajectory, std::string_view message) {
    CartographerSubmap submap;
    submap.id.trajectory = trajectory;
    CartographerPose pose;
    bool has_pose = false;
    ProtoReader fields(message);
    while (fields.Next()) {
      if (fields.number() == 1) has_pose = ReadCartographerPose(fields.Bytes(), &pose);
      if (fields.number() == 2) submap.id.index = fields.Int32();
    }
    if (!fields.ok() || !has_pose) return Damaged("pose of " + NameOf("submap", submap.id));
    submap.map_from_submap = pose.InPlane();
    const auto num_submaps = static_cast<int>(state_.submaps.size());
    if (!submap_of_id_.emplace(submap.id, num_submaps).second) {
      return stream_->Error(NameOf("submap", submap.id) + " is there twice");
    }
    state_.submaps.push_back(submap);
    return Keep(sizeof(submap));
  }

  // The weights are not read: they balance the costs of Cartographer's optimisation, and say
  // nothing of how exact a match is.
  Status ParseConstraint(std::string_view message) {
    const std::string name = "constraint " + std::to_string(state_.constraints.size() + 1);
    CartographerConstraint constraint;
    CartographerId submap, node;
    CartographerPose pose;
    bool is_sound = true, has_pose = false;
    ProtoReader fields(message);
    while (fields.Next()) {
      if (fields.number() == 1) is_sound = is_sound && ReadId(fields.Bytes(), &submap);
      if (fields.number() == 2) is_sound = is_sound && ReadId(fields.Bytes(), &node);
      if (fields.number() == 3) has_pose = ReadCartographerPose(fields.Bytes(), &pose);
      if (fields.number() == 5) constraint.is_intra = fields.Int32() == 0;
    }
    if (!fields.ok() || !is_sound || !has_pose) return Damaged(name);
    constraint.submap_from_tracking = pose.InPlane();
    PLUMBLINE_RETURN_IF_ERROR(Find(submap_of_id_, submap, name, "submap", &constraint.submap));
    PLUMBLINE_RETURN_IF_ERROR(Find(node_of_id_, node, name, "node", &constraint.node));
    state_.constraints.push_back(constraint);
    return Keep(sizeof(constraint));
  }

  Status Find(const IndexOfId& index_of_id, const CartographerId& id, const std::string& user,
              const char* kind, int* index) const {
    const auto known = index_of_id.find(id);
    if (known == index_of_id.end()) {
      return stream_->Error(user + " names " + NameOf(kind, id) + ", which has no pose");
    }
    *index = known->second;
    return Status::Ok();
  }

  // What comes after the pose graph. Sensor data and options are of no use here.
  Status ParseData() {
    ProtoReader data(stream_->message());
    while (data.Next()) {
      if (data.number() == 1) return stream_->Error("a second pose graph");
      if (data.number() == 3) PLUMBLINE_RETURN_IF_ERROR(ParseSubmapData(data.Bytes()));
      if (data.number() == 4) PLUMBLINE_RETURN_IF_ERROR(ParseNodeMessage(data.Bytes()));
    }
    return data.ok() ? Status::Ok() : stream_->Error("the message is damaged");
  }

  Status In3d() const {
    return stream_->Unsupported("a map in 3D; only maps in 2D can be refined");
  }

  Status ParseSubmapData(std::string_view message) {
    ProtoReader fields(message);
    while (fields.Next()) {
      if (fields.number() == 3) return In3d();
      if (fields.number() == 2 && !ReadCellSize(fields.Bytes())) return Damaged("submap");
    }
    return fields.ok() ? Status::Ok() : Damaged("submap");
  }

  // From Submap2D: grid, limits, resolution. Submaps that are not finished may come without.
  bool ReadCellSize(std::string_view submap) {
    ProtoReader fields(submap);
    while (fields.Next()) {
      if (fields.number() != 4) continue;
      ProtoReader grid(fields.Bytes());
      while (grid.Next()) {
        if (grid.number() != 1) continue;
        ProtoReader limits(grid.Bytes());
        while (limits.Next()) {
          if (limits.number() == 1) state_.cell_m = limits.Double();
        }
        const double cell_m = state_.cell_m.value_or(kMinCellM);
        if (!limits.ok() || !(cell_m >= kMinCellM && cell_m <= kMaxCellM)) return false;
      }
      if (!grid.ok()) return false;
    }
    return fields.ok();
  }

  Status ParseNodeMessage(std::string_view message) {
    CartographerId id;
    std::string_view data;
    bool is_sound = true;
    ProtoReader fields(message);
    while (fields.Next()) {
      if (fields.number() == 1) is_sound = is_sound && ReadId(fields.Bytes(), &id);
      if (fields.number() == 5) data = fields.Bytes();
    }
    if (!fields.ok() || !is_sound) return Damaged("node");
    int index = 0;
    PLUMBLINE_RETURN_IF_ERROR(Find(node_of_id_, id, "the message", "node", &index));
    if (has_data_[index])
      return stream_->Error("the data of " + NameOf("node", id) + " come twice");
    has_data_[index] = true;
    return ParseNodeData(data, &state_.nodes[index]);
  }

  Status ParseNodeData(std::string_view message, CartographerNode* node) {
    const std::string of_node = " of " + NameOf("node", node->id);
    Eigen::Quaterniond level_from_tracking(0, 0, 0, 0);
    CartographerPose local_pose;
    bool has_alignment = false, has_local_pose = false;
    ProtoReader fields(message);
    while (fields.Next()) {
      if (fields.number() == 2)
        has_alignment = ReadQuaternion(fields.Bytes(), &level_from_tracking);
      if (fields.number() == 3 && !ReadPoints(fields.Bytes(), &node->points_mm)) {
        return Damaged("point cloud" + of_node);
      }
      // Of these, a 2D node has none.
      if ((fields.number() == 4 || fields.number() == 5) && !fields.Bytes().empty()) return In3d();
      if (fields.number() == 7) has_local_pose = ReadCartographerPose(fields.Bytes(), &local_pose);
    }
    if (!fields.ok()) return stream_->Error("the data" + of_node + " are damaged");
    if (!has_alignment) return Damaged("alignment with gravity" + of_node);
    if (!has_local_pose) return Damaged("local pose" + of_node);
    node->tracking_from_level_rad = -YawOf(level_from_tracking);
    node->local_from_tracking = local_pose.InPlane();
    return Keep(node->points_mm.size() * sizeof(Eigen::Vector2i));
  }

  const std::string path_;
  MemoryLimit memory_;
  CartographerStream* stream_ = nullptr;
  CartographerState state_;
  IndexOfId node_of_id_, submap_of_id_;
  std::vector<bool> has_data_;  // per node
};

// The size is checked before the file is read; what has none is for the reader to name.
Status ReadContent(const std::string& path, MemoryLimit* memory, std::string* content) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && !memory->Keep(size)) {
    return Status::InvalidArgument(path + ": " + memory->Fault());
  }
  return ReadWholeFile(path, content);
}

}  // namespace

bool IsCartographerState(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".pbstream") return true;
  if (!RefusePipe(path).ok()) return false;
  std::string start(kCartographerMagic.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  return file.good() && start == kCartographerMagic;
}

Status ReadCartographerState(const std::string& path, CartographerState* state, double max_bytes) {
  MemoryLimit memory(max_bytes);
  std::string content;
  PLUMBLINE_RETURN_IF_ERROR(ReadContent(path, &memory, &content));
  return Parser(path, std::move(content), memory).Parse(state);
}

Status ParseCartographerState(const std::string& path, std::string content,
                              CartographerState* state) {
  return Parser(path, std::move(content), MemoryLimit(0.0)).Parse(state);
}

}  // namespace plumbline
