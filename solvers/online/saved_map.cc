#include "plumbline/solvers/online/saved_map.h"

#include <cmath>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {
namespace {

// A turn that makes a keyframe [rad]: as for the sequential matching.
constexpr double kKeyTurnRad = 0.35;
// Standard deviations of the relative pose of neighbouring keyframes of a finished map [m], [rad].
// They keep the pose graph in one piece; fixed keyframes do not move.
constexpr double kEdgeM = 0.01, kEdgeRad = 0.003;

std::vector<Pose2> PosesOfMap(const SlamGraph& map) {
  std::vector<Pose2> poses = PosesOf(map.initial_poses());
  if (!map.has_named_fixed_poses()) return poses;
  for (const FixedPose& fixed : map.fixed_poses()) poses[fixed.pose] = fixed.world_from_robot;
  return poses;
}

class KeyframeMaker {
 public:
  KeyframeMaker(const SeedingOptions& options, SavedSession* session)
      : options_(options), session_(*session) {}

  void Make() {
    const SlamGraph& graph = session_.graph;
    SeededDrive& drive = session_.drive;
    drive.surfaces.resize(graph.num_scans());
    drive.matched.world_from_robot = drive.world_from_robot;
    drive.matched.odometry.resize(drive.world_from_robot.size());
    for (int scan = 0; scan < graph.num_scans(); ++scan) {
      const int pose = graph.scan(scan).pose;
      Follow(pose);
      if (!IsNew(pose)) continue;
      const SurfacePoints points = ThinnedSurfaceOf(graph, scan, session_.surface, kPointSpacingM);
      if (points.empty()) continue;
      drive.surfaces[scan] = PackedSurface(points);
      AddKeyframe(pose, scan);
    }
    drive.matched.keyframes = drive.keys.keyframes;
    drive.keys.num_fixed = drive.keys.size();
  }

 private:
  const Pose2& PoseOf(int pose) const { return session_.drive.world_from_robot[pose]; }

  // Takes the path up to a pose.
  void Follow(int pose) {
    for (; last_pose_ < pose; ++last_pose_) {
      const Pose2 step = Between(PoseOf(last_pose_), PoseOf(last_pose_ + 1));
      session_.drive.matched.odometry[last_pose_ + 1] = step;
      path_m_ += step.translation().norm();
    }
  }

  bool IsNew(int pose) const {
    const KeyframeGraph& keys = session_.drive.keys;
    if (keys.size() == 0) return true;
    const Pose2 moved = Between(keys.world_from_key.back(), PoseOf(pose));
    return moved.translation().norm() >= options_.keyframe_distance_m ||
           std::abs(moved.yaw) >= kKeyTurnRad;
  }

  void AddKeyframe(int pose, int scan) {
    KeyframeGraph& keys = session_.drive.keys;
    Keyframe key;
    key.pose = pose;
    key.scan = scan;
    key.path_m = path_m_;
    if (keys.size() > 0) {
      SequentialEdge edge;
      edge.constraint.from = keys.size() - 1;
      edge.constraint.to = keys.size();
      edge.constraint.from_from_to = Between(keys.world_from_key.back(), PoseOf(pose));
      edge.constraint.covariance =
          Eigen::Vector3d(kEdgeM * kEdgeM, kEdgeM * kEdgeM, kEdgeRad * kEdgeRad).asDiagonal();
      keys.sequential.push_back(edge);
    }
    keys.keyframes.push_back(key);
    keys.world_from_key.push_back(PoseOf(pose));
  }

  const SeedingOptions& options_;
  SavedSession& session_;
  int last_pose_ = 0;
  double path_m_ = 0.0;
};

}  // namespace

bool IsFixedMap(const SlamGraph& map) {
  return map.has_named_fixed_poses() &&
         static_cast<int>(map.fixed_poses().size()) == map.num_poses();
}

Status MakeSavedSession(const SlamGraph& map, const SeedingOptions& options,
                        const ReturnNormalOptions& normals, ThreadPool* pool,
                        SavedSession* session) {
  if (map.has_named_fixed_poses() && !IsFixedMap(map)) {
    return Status::InvalidArgument("some poses of the map are fixed, and others are not");
  }
  *session = SavedSession();
  session->drive.world_from_robot = PosesOfMap(map);
  SlamGraph& graph = session->graph;
  graph.ReserveReturns(map.num_returns());
  for (int pose = 0; pose < map.num_poses(); ++pose) {
    graph.AddPose(session->drive.world_from_robot[pose], map.timestamp_s(pose));
  }
  for (int scan = 0; scan < map.num_scans(); ++scan) {
    graph.AddScanOf(map, scan, map.scan(scan).pose);
  }
  PLUMBLINE_RETURN_IF_ERROR(graph.status());
  session->surface = MeasureSurface(graph, normals, pool);
  KeyframeMaker(options, session).Make();
  if (session->drive.keys.size() > 0) return Status::Ok();
  return Status::InvalidArgument("no scan of the map shows a surface");
}

}  // namespace plumbline
