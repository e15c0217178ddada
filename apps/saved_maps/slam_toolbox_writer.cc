#include "plumbline/apps/saved_maps/slam_toolbox_writer.h"

#include <cstddef>
#include <unordered_map>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/little_endian.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// The scans that have moved, by their ids.
using MovedScans = std::unordered_map<int, Pose2>;

bool IsSamePose(const Pose2& a, const Pose2& b) {
  return a.x == b.x && a.y == b.y && a.yaw == b.yaw;
}

void ReplaceNumber(const ArchiveObject& object, const char* member, double value,
                   std::string* bytes) {
  StoreDouble(value, reinterpret_cast<unsigned char*>(bytes->data()) + object.Place(member));
}

void ReplacePose(const ArchiveObject& pose, const Pose2& value, std::string* bytes) {
  ReplaceNumber(pose.Object("position"), "x", value.x, bytes);
  ReplaceNumber(pose.Object("position"), "y", value.y, bytes);
  ReplaceNumber(pose, "heading", NormalizeAngle(value.yaw), bytes);
}

void MoveScans(const std::vector<ArchiveObject>& scans, const MovedScans& moved,
               std::string* bytes) {
  for (const ArchiveObject& scan : scans) {
    const auto pose = moved.find(ScanId(scan));
    if (pose == moved.end()) continue;
    ReplacePose(scan.Object("corrected_pose"), pose->second, bytes);
    (*bytes)[scan.Place("is_dirty")] = 1;
  }
}

void MoveEdges(const std::vector<ArchiveObject>& edges, const MovedScans& moved,
               std::string* bytes) {
  for (const ArchiveObject& edge : edges) {
    const ArchiveObject from = edge.Object("source").Object("object");
    const ArchiveObject to = edge.Object("target").Object("object");
    const auto moved_from = moved.find(ScanId(from)), moved_to = moved.find(ScanId(to));
    if (moved_from == moved.end() && moved_to == moved.end()) continue;
    const Pose2 from_pose =
        moved_from == moved.end() ? PoseOf(from.Object("corrected_pose")) : moved_from->second;
    const Pose2 to_pose =
        moved_to == moved.end() ? PoseOf(to.Object("corrected_pose")) : moved_to->second;
    const ArchiveObject link = edge.Object("label");
    ReplacePose(link.Object("pose_1"), from_pose, bytes);
    ReplacePose(link.Object("pose_2"), to_pose, bytes);
    ReplacePose(link.Object("pose_difference"), Between(from_pose, to_pose), bytes);
  }
}

Status WriteBytes(const std::string& path, const std::string& bytes) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file.Commit();
}

}  // namespace

Status WriteSlamToolboxMap(const std::string& path, const SlamToolboxMap& map,
                           const std::vector<double>& poses) {
  MovedScans moved;
  const std::vector<ArchiveObject> scans = GraphScansOf(map);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Pose2 pose(&poses[3 * i]);
    if (IsSamePose(pose, PoseOf(scans[i].Object("corrected_pose")))) continue;
    moved.emplace(ScanId(scans[i]), pose);
  }
  std::string mapper = map.mapper.bytes(), dataset = map.dataset.bytes();
  MoveScans(scans, moved, &mapper);
  MoveEdges(GraphEdgesOf(map), moved, &mapper);
  MoveScans(DatasetScansOf(map), moved, &dataset);
  PLUMBLINE_RETURN_IF_ERROR(WriteBytes(path, mapper));
  return WriteBytes(SlamToolboxFiles(path)[1], dataset);
}

}  // namespace plumbline
