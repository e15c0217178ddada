#include "plumbline/apps/saved_maps/cartographer_writer.h"

#include <string_view>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/saved_maps/cartographer_pose.h"
#include "plumbline/apps/saved_maps/cartographer_stream.h"
#include "plumbline/apps/saved_maps/proto_reader.h"
#include "plumbline/apps/saved_maps/proto_writer.h"
#include "plumbline/core/pose2.h"

namespace plumbline {
namespace {

// The message with the field replaced.
template <typename Replace>
std::string Rewrite(std::string_view message, std::uint64_t number, const Replace& replace) {
  ProtoWriter rewritten;
  for (ProtoReader fields(message); fields.Next();) {
    if (fields.number() == number) {
      rewritten.Bytes(static_cast<int>(number), replace(fields.Bytes()));
    } else {
      rewritten.Field(fields.field());
    }
  }
  return rewritten.bytes();
}

// The pose moved there.
std::string MovePose(std::string_view message, const Pose2& to) {
  CartographerPose pose;
  ReadCartographerPose(message, &pose);
  const Pose2 from = pose.InPlane();
  if (from.x == to.x && from.y == to.y && from.yaw == to.yaw) return std::string(message);
  return CartographerPoseMessage(pose.MovedTo(to));
}

// Moves the poses of nodes and submaps, one after the other.
class PoseMover {
 public:
  // num_nodes: in the pose graph; the poses of the submaps come behind them.
  PoseMover(const std::vector<double>& poses, std::size_t num_nodes)
      : node_(poses.data()), submap_(poses.data() + 3 * num_nodes) {}

  std::string MoveTrajectory(std::string_view message) {
    constexpr std::uint64_t kNode = 1, kNodePose = 5, kSubmap = 2, kSubmapPose = 1;
    const std::string nodes_moved = Rewrite(
        message, kNode, [this](std::string_view node) { return Move(node, kNodePose, &node_); });
    return Rewrite(nodes_moved, kSubmap,
                   [this](std::string_view submap) { return Move(submap, kSubmapPose, &submap_); });
  }

 private:
  static std::string Move(std::string_view message, std::uint64_t number, const double** next) {
    const Pose2 to(*next);
    *next += 3;
    return Rewrite(message, number, [&to](std::string_view pose) { return MovePose(pose, to); });
  }

  const double *node_, *submap_;
};

std::size_t CountNodes(std::string_view pose_graph) {
  std::size_t count = 0;
  for (ProtoReader fields(pose_graph); fields.Next();) {
    if (fields.number() != 4) continue;
    for (ProtoReader trajectory(fields.Bytes()); trajectory.Next();) {
      if (trajectory.number() == 1) ++count;
    }
  }
  return count;
}

}  // namespace

void WriteCartographerState(const std::string& content, const std::vector<double>& poses,
                            std::ostream* stream) {
  constexpr std::uint64_t kPoseGraph = 1, kTrajectory = 4;
  CartographerStream messages("", content);
  messages.Next();
  const std::string_view header(content.data(), content.size() - messages.rest().size());
  messages.Next();
  const std::string moved =
      Rewrite(messages.message(), kPoseGraph, [&poses](std::string_view pose_graph) {
        PoseMover mover(poses, CountNodes(pose_graph));
        return Rewrite(pose_graph, kTrajectory, [&mover](std::string_view trajectory) {
          return mover.MoveTrajectory(trajectory);
        });
      });
  *stream << header << CartographerMessage(moved) << messages.rest();
}

Status WriteCartographerState(const std::string& path, const std::string& content,
                              const std::vector<double>& poses) {
  AtomicFile output;
  PLUMBLINE_RETURN_IF_ERROR(output.Open(path));
  WriteCartographerState(content, poses, &output.stream());
  return output.Commit();
}

}  // namespace plumbline
