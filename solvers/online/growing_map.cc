#include "plumbline/solvers/online/growing_map.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/loop_closure/close_loops.h"

namespace plumbline {
namespace {

void AppendScan(const LiveScan& scan, SlamGraph* graph) {
  const int id = graph->AddPose(scan.measured.InitialPose(0), scan.measured.timestamp_s(0));
  graph->AddScanOf(scan.measured, 0, id);
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
    : motion_(motion) {
  for (const LaserModel& laser : lasers) {
    graph_.AddLaser(laser);
    std::ignore = graph_.TakeStatus();  // a laser that is refused has no scans
  }
}

Status GrowingMap::Add(const LiveScan& scan) {
  AppendScan(scan, &graph_);
  PLUMBLINE_RETURN_IF_ERROR(graph_.TakeStatus());
  const int id = graph_.num_poses() - 1;
  surface_.normals.insert(surface_.normals.end(), scan.surface.normals.begin(),
                          scan.surface.normals.end());
  steps_.push_back(scan.step);
  kept_.emplace_back();
  if (id == 0) {
    trajectory_.world_from_robot.push_back(scan.world_from_robot);
    trajectory_.odometry.emplace_back();
  } else {
    Append(scan.matched_step, scan.step_as_driven);
  }
  if (!trajectory_.given_poses.empty()) trajectory_.given_poses.push_back(graph_.InitialPose(id));
  if (scan.keyframe) {
    kept_.back() = *scan.key_surface;
    AddKeyframe(*scan.keyframe);
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
    keys_.world_from_key.push_back(poses[keyframe.pose]);
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
  first_new_key_ = keys_.size();
  for (std::size_t k = 0; k < before.size(); ++k) {
    largest_correction_m_ =
        std::max(largest_correction_m_, PathM(before[k], keys_.world_from_key[k]));
  }
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
  *log = graph_;
  std::vector<std::optional<Pose2>> steps = steps_;
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

std::vector<Pose2> GrowingMap::Poses() const {
  return PosesFollowingKeyframes(keys_, trajectory_.world_from_robot);
}

}  // namespace plumbline
