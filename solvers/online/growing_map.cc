#include "plumbline/solvers/online/growing_map.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/loop_closure/close_loops.h"

namespace plumbline {
namespace {

// Path between a saved map and the drive: more than what counts as one pass through a place [m].
constexpr double kGapM = 20.0;

void AppendScan(const LiveScan& scan, SlamGraph* graph) {
  const int id = graph->AddPose(scan.measured.InitialPose(0), scan.measured.timestamp_s(0));
  graph->AddScanOf(scan.measured, 0, id);
}

SlamGraph GraphOfLasers(const std::vector<LaserModel>& lasers) {
  SlamGraph graph;
  for (const LaserModel& laser : lasers) {
    graph.AddLaser(laser);
    std::ignore = graph.TakeStatus();  // a laser that is refused has no scans
  }
  return graph;
}

// Appends the poses from `first` on, with their scans.
void AppendPoses(const SlamGraph& graph, int first, SlamGraph* appended_to) {
  const int moved = appended_to->num_poses() - first;
  for (int pose = first; pose < graph.num_poses(); ++pose) {
    appended_to->AddPose(graph.InitialPose(pose), graph.timestamp_s(pose));
  }
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    const int pose = graph.scan(scan).pose;
    if (pose >= first) appended_to->AddScanOf(graph, scan, pose + moved);
  }
}

double PathM(const Pose2& from, const Pose2& to) { return Between(from, to).translation().norm(); }

// Moves a pose graph to refined poses, which then satisfy all its edges.
void MoveTo(const std::vector<Pose2>& world_from_robot, KeyframeGraph* keys) {
  for (int k = 0; k < keys->size(); ++k) {
    keys->world_from_key[k] = world_from_robot[keys->keyframes[k].pose];
  }
  const auto measure = [keys](RelativePoseConstraint* edge) {
    edge->from_from_to = Between(keys->world_from_key[edge->from], keys->world_from_key[edge->to]);
  };
  for (SequentialEdge& edge : keys->sequential) measure(&edge.constraint);
  for (RelativePoseConstraint& closure : keys->closures) measure(&closure);
}

}  // namespace

GrowingMap::GrowingMap(const std::vector<LaserModel>& lasers, const MotionOptions& motion)
    : lasers_(GraphOfLasers(lasers)), motion_(motion), graph_(lasers_) {}

void GrowingMap::StartIn(InSavedMap saved) {
  const SeededDrive& drive = saved.map->drive;
  graph_ = saved.map->graph;
  surface_ = saved.map->surface;
  kept_ = drive.surfaces;
  trajectory_ = drive.matched;
  trajectory_.keyframes.clear();
  first_pose_ = graph_.num_poses();
  steps_.resize(first_pose_);
  path_m_ = drive.keys.keyframes.back().path_m + kGapM;
  saved_ = std::move(saved);
}

Status GrowingMap::Add(const LiveScan& scan) {
  AppendScan(scan, &graph_);
  PLUMBLINE_RETURN_IF_ERROR(graph_.TakeStatus());
  const int id = graph_.num_poses() - 1;
  surface_.normals.insert(surface_.normals.end(), scan.surface.normals.begin(),
                          scan.surface.normals.end());
  steps_.push_back(scan.step);
  kept_.emplace_back();
  if (id == first_pose_ && num_forgotten_ == 0) {
    trajectory_.world_from_robot.push_back(scan.world_from_robot);
    trajectory_.odometry.emplace_back();
  } else {
    Append(scan.matched_step, scan.step_as_driven);
  }
  if (!trajectory_.given_poses.empty()) trajectory_.given_poses.push_back(graph_.InitialPose(id));
  if (scan.keyframe) {
    kept_.back() = *scan.key_surface;
    Keyframe keyframe = *scan.keyframe;
    keyframe.pose = id;
    keyframe.scan = graph_.num_scans() - 1;
    AddKeyframe(keyframe);
  }
  return Status::Ok();
}

void GrowingMap::Append(const Pose2& step, const Pose2& step_as_driven) {
  std::vector<Pose2>& poses = trajectory_.world_from_robot;
  poses.push_back(poses.back() * step);
  trajectory_.odometry.push_back(step_as_driven);
  path_m_ += step.translation().norm();
}

void GrowingMap::AddKeyframe(Keyframe keyframe) {
  keyframe.path_m = path_m_;
  const std::vector<Pose2>& poses = trajectory_.world_from_robot;
  if (keys_.size() == 0) {
    keys_.world_from_key.push_back(world_from_matched_ * poses[keyframe.pose]);
  } else {
    const Keyframe& last = keys_.keyframes.back();
    keys_.world_from_key.push_back(keys_.world_from_key.back() *
                                   Between(poses[last.pose], poses[keyframe.pose]));
    keys_.sequential.push_back(MatchedEdge(keys_.size() - 1, last, keyframe, trajectory_, motion_));
  }
  if (!trajectory_.given_poses.empty()) {
    keys_.given.given_from_key.push_back(trajectory_.given_poses[keyframe.pose]);
  }
  keys_.keyframes.push_back(keyframe);
  has_unmatched_ = has_unmatched_ || keyframe.after_unmatched;
}

Status GrowingMap::CloseLoops(const SeedingProgress& progress, ThreadPool* pool) {
  if (first_new_key_ == keys_.size()) return Status::Ok();
  const std::vector<Pose2> before = keys_.world_from_key;
  ScanSurfaces surfaces(graph_, surface_, std::move(kept_));
  // Key 0 has no earlier ones.
  const Status status =
      CloseNewLoops(std::max(1, first_new_key_), surfaces, progress, pool, &memory_, &keys_);
  kept_ = std::move(surfaces).TakeKept();
  PLUMBLINE_RETURN_IF_ERROR(status);
  for (std::size_t k = 0; k < before.size(); ++k) {
    largest_correction_m_ =
        std::max(largest_correction_m_, PathM(before[k], keys_.world_from_key[k]));
  }
  const bool is_lost = saved_.is_fixed && IsLost(first_new_key_);
  first_new_key_ = keys_.size();
  if (is_lost) BeginSegment();
  if (saved_.is_fixed) SettleOldKeyframes();
  return Status::Ok();
}

void GrowingMap::Adopt(SeededDrive seeded, const MotionOptions& motion) {
  const int num_seeded = static_cast<int>(seeded.world_from_robot.size());
  const SequentialTrajectory before = std::move(trajectory_);
  std::vector<Keyframe> later;
  for (const Keyframe& key : keys_.keyframes) {
    if (key.pose >= num_seeded) later.push_back(key);
  }
  motion_ = motion;
  keys_ = std::move(seeded.keys);
  MoveTo(seeded.world_from_robot, &keys_);
  trajectory_ = std::move(seeded.matched);
  trajectory_.keyframes.clear();
  trajectory_.world_from_robot = std::move(seeded.world_from_robot);
  for (int pose = 0; pose < num_seeded; ++pose) {
    kept_[pose] = std::move(seeded.surfaces[pose]);
  }
  path_m_ = 0.0;
  const std::vector<Pose2>& poses = trajectory_.world_from_robot;
  if (keys_.size() > 0) {
    path_m_ = keys_.keyframes.back().path_m;
    for (int pose = keys_.keyframes.back().pose + 1; pose < num_seeded; ++pose) {
      path_m_ += PathM(poses[pose - 1], poses[pose]);
    }
  }
  memory_ = ClosureMemory();
  first_new_key_ = keys_.size();
  largest_correction_m_ = 0.0;
  has_unmatched_ = false;
  auto key = later.begin();
  for (int pose = num_seeded; pose < graph_.num_poses(); ++pose) {
    Append(Between(before.world_from_robot[pose - 1], before.world_from_robot[pose]),
           before.odometry[pose]);
    if (!trajectory_.given_poses.empty()) {
      trajectory_.given_poses.push_back(graph_.InitialPose(pose));
    }
    if (key != later.end() && key->pose == pose) AddKeyframe(*key++);
  }
}

Status GrowingMap::MakeLog(const std::vector<LiveScan>& later, SlamGraph* log) const {
  if (num_forgotten_ > 0) {
    return Status::InvalidArgument("old scans of the drive were not kept, as the options say");
  }
  *log = first_pose_ == 0 ? graph_ : lasers_;
  if (first_pose_ > 0) AppendPoses(graph_, first_pose_, log);
  std::vector<std::optional<Pose2>> steps(steps_.begin() + first_pose_, steps_.end());
  for (const LiveScan& scan : later) {
    AppendScan(scan, log);
    steps.push_back(scan.step);
  }
  if (std::none_of(steps.begin(), steps.end(), [](const auto& step) { return step.has_value(); })) {
    return log->status();
  }
  for (int pose = 1; pose < log->num_poses(); ++pose) {
    OdometryConstraint step{pose - 1, pose, steps[pose].value_or(Pose2())};
    step.is_measured = steps[pose].has_value();
    log->AddOdometry(step);
  }
  return log->status();
}

// Removes the poses of the drive before this id of the graph, with their scans.
void GrowingMap::ForgetBefore(int pose) {
  const int count = pose - first_pose_;
  if (count <= 0) return;
  const int first_scan = saved_.map->graph.num_scans();
  const auto erase = [count](int first, auto* vector) {
    vector->erase(vector->begin() + first, vector->begin() + first + count);
  };
  const std::size_t num_returns = graph_.scan(first_scan + count).first_return;
  surface_.normals.erase(
      surface_.normals.begin() + static_cast<std::ptrdiff_t>(saved_.map->graph.num_returns()),
      surface_.normals.begin() + static_cast<std::ptrdiff_t>(num_returns));
  SlamGraph graph = saved_.map->graph;
  AppendPoses(graph_, pose, &graph);
  graph_ = std::move(graph);
  erase(first_scan, &kept_);
  erase(first_pose_, &steps_);
  erase(first_pose_, &trajectory_.world_from_robot);
  erase(first_pose_, &trajectory_.odometry);
  for (int k = keys_.num_fixed; k < keys_.size(); ++k) {
    keys_.keyframes[k].pose -= count;
    keys_.keyframes[k].scan -= count;
  }
  num_forgotten_ += count;
}

std::vector<Pose2> GrowingMap::Poses() const {
  std::vector<Pose2> poses = settled_;
  const std::vector<Pose2> newest = PosesOfSegment();
  poses.insert(poses.end(), newest.begin(), newest.end());
  return poses;
}

std::vector<Pose2> GrowingMap::PosesOfSegment() const {
  const int first = FirstIdOfSegment();
  std::vector<Pose2> poses(trajectory_.world_from_robot.begin() + first,
                           trajectory_.world_from_robot.end());
  if (num_keyframes() == 0) {
    for (Pose2& pose : poses) pose = world_from_matched_ * pose;
    return poses;
  }
  KeyframeGraph segment;
  segment.keyframes.assign(keys_.keyframes.begin() + keys_.num_fixed, keys_.keyframes.end());
  segment.world_from_key.assign(keys_.world_from_key.begin() + keys_.num_fixed,
                                keys_.world_from_key.end());
  segment.sequential.assign(keys_.sequential.begin() + keys_.num_fixed, keys_.sequential.end());
  for (Keyframe& key : segment.keyframes) key.pose -= first;
  for (SequentialEdge& edge : segment.sequential) edge.first_pose_after -= first;
  return PosesFollowingKeyframes(segment, poses);
}

}  // namespace plumbline
