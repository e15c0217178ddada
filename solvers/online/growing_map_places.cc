// The segments of a drive in a saved map.

#include <algorithm>
#include <iterator>
#include <utility>

#include "plumbline/solvers/online/growing_map.h"

namespace plumbline {
namespace {

// Standard deviations of a place that a host gives [m], [rad].
constexpr double kGivenPlaceM = 0.5, kGivenPlaceRad = 0.15;
// Standard deviations of a pose that follows from settled ones [m], [rad].
constexpr double kSettledM = 0.05, kSettledRad = 0.02;
// Path [m] without a closure to a fixed map after which its place is not believed any more.
constexpr double kMaxPathUnseenM = 10.0;
// Keyframes of a segment in a fixed map: the older half is settled above this number, some 100 m.
constexpr int kMaxKeyframes = 400;

Eigen::Matrix3d Covariance(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

// Removes the keyframes [first, first + count) with all of their edges. The edge that leads to them
// from the keyframe before is left to the caller.
void RemoveKeyframes(int first, int count, KeyframeGraph* keys) {
  const auto erase = [first, count](auto* vector) {
    vector->erase(vector->begin() + first, vector->begin() + first + count);
  };
  erase(&keys->keyframes);
  erase(&keys->world_from_key);
  erase(&keys->sequential);
  const auto renumber = [first, count](int* key) {
    if (*key >= first) *key -= count;
  };
  for (SequentialEdge& edge : keys->sequential) {
    renumber(&edge.constraint.from);
    renumber(&edge.constraint.to);
  }
  const auto is_removed = [first, count](const RelativePoseConstraint& edge) {
    return (edge.from >= first && edge.from < first + count) ||
           (edge.to >= first && edge.to < first + count);
  };
  for (auto* edges : {&keys->closures, &keys->contradicted, &keys->refused, &keys->tentative}) {
    edges->erase(std::remove_if(edges->begin(), edges->end(), is_removed), edges->end());
    for (RelativePoseConstraint& edge : *edges) {
      renumber(&edge.from);
      renumber(&edge.to);
    }
  }
}

}  // namespace

double GrowingMap::segment_path_m() const {
  return num_keyframes() == 0 ? 0.0 : path_m_ - keys_.keyframes[keys_.num_fixed].path_m;
}

bool GrowingMap::PlaceAt(const Pose2& map_from_robot) {
  if (num_keyframes() == 0) return false;
  const Pose2 map_from_segment = map_from_robot * PosesOfSegment().front().Inverse();
  std::vector<Pose2> map_from_key = keys_.world_from_key;
  for (Pose2& key : map_from_key) key = map_from_segment * key;
  SequentialEdge boundary;
  boundary.constraint.covariance = Covariance(kGivenPlaceM, kGivenPlaceRad);
  PlaceBehindMap(map_from_key, boundary);
  first_new_key_ = keys_.num_fixed;
  return true;
}

Status GrowingMap::MakeSearch(PlaceSearch* search) const {
  const int first_pose = FirstIdOfSegment();
  const int first_scan = graph_.num_scans() - (graph_.num_poses() - first_pose);
  search->map = saved_.map;
  search->first_pose = first_pose_of_segment();
  for (int pose = first_pose; pose < graph_.num_poses(); ++pose) {
    search->graph.AddPose(graph_.InitialPose(pose), graph_.timestamp_s(pose));
    search->graph.AddScanOf(graph_, first_scan + pose - first_pose, pose - first_pose);
  }
  SeededDrive& drive = search->drive;
  drive.surfaces.assign(kept_.begin() + first_scan, kept_.end());
  drive.keys = keys_;
  for (Keyframe& key : drive.keys.keyframes) {
    key.pose -= first_pose;
    key.scan -= first_scan;
  }
  drive.world_from_robot = PosesOfSegment();
  drive.matched.world_from_robot = drive.world_from_robot;
  drive.matched.odometry.assign(trajectory_.odometry.begin() + first_pose,
                                trajectory_.odometry.end());
  drive.matched.keyframes = drive.keys.keyframes;
  return search->graph.status();
}

bool GrowingMap::Place(const PlaceSearch& found) {
  if (found.first_pose != first_pose_of_segment() || is_placed()) return false;
  const int num_fixed = saved_.map->drive.keys.num_fixed;
  const int num_found = found.keys.size() - num_fixed;
  std::vector<Pose2> map_from_key(found.keys.world_from_key.begin() + num_fixed,
                                  found.keys.world_from_key.end());
  for (int k = num_found; k < keys_.size(); ++k) {
    map_from_key.push_back(map_from_key.back() *
                           Between(keys_.world_from_key[k - 1], keys_.world_from_key[k]));
  }
  SequentialEdge boundary;
  boundary.broken = boundary.between_sessions = true;
  // The search knows the loops up to its last keyframe.
  const auto is_known = [num_found](const RelativePoseConstraint& edge) {
    return edge.to < num_found;
  };
  for (auto edges : {&KeyframeGraph::closures, &KeyframeGraph::contradicted}) {
    std::vector<RelativePoseConstraint>& own = keys_.*edges;
    own.erase(std::remove_if(own.begin(), own.end(), is_known), own.end());
  }
  PlaceBehindMap(map_from_key, boundary);
  for (auto edges : {&KeyframeGraph::closures, &KeyframeGraph::contradicted}) {
    (keys_.*edges)
        .insert((keys_.*edges).begin(), (found.keys.*edges).begin(), (found.keys.*edges).end());
  }
  first_new_key_ = num_fixed + num_found;
  return true;
}

// boundary: its covariance and its marks.
void GrowingMap::PlaceBehindMap(const std::vector<Pose2>& map_from_key,
                                const SequentialEdge& boundary) {
  const KeyframeGraph segment = std::exchange(keys_, saved_.map->drive.keys);
  const int num_fixed = keys_.num_fixed;
  const auto renumbered = [num_fixed](RelativePoseConstraint edge) {
    edge.from += num_fixed;
    edge.to += num_fixed;
    return edge;
  };
  keys_.keyframes.insert(keys_.keyframes.end(), segment.keyframes.begin(), segment.keyframes.end());
  keys_.world_from_key.insert(keys_.world_from_key.end(), map_from_key.begin(), map_from_key.end());
  keys_.sequential.push_back(boundary);
  RelativePoseConstraint& edge = keys_.sequential.back().constraint;
  edge.from = num_fixed - 1;
  edge.to = num_fixed;
  edge.from_from_to = Between(keys_.world_from_key[num_fixed - 1], keys_.world_from_key[num_fixed]);
  for (SequentialEdge step : segment.sequential) {
    step.constraint = renumbered(step.constraint);
    keys_.sequential.push_back(step);
  }
  for (auto edges : {&KeyframeGraph::closures, &KeyframeGraph::contradicted}) {
    std::transform((segment.*edges).begin(), (segment.*edges).end(),
                   std::back_inserter(keys_.*edges), renumbered);
  }
  memory_ = ClosureMemory();
}

// Whether the new keyframes say that the place is not known any more.
bool GrowingMap::IsLost(int first_new_key) const {
  const auto is_unmatched = [](const Keyframe& key) { return key.after_unmatched; };
  const auto first_new = keys_.keyframes.begin() + std::max(first_new_key, keys_.num_fixed + 1);
  if (first_new < keys_.keyframes.end() &&
      std::any_of(first_new, keys_.keyframes.end(), is_unmatched)) {
    return true;
  }
  if (!is_placed() || num_keyframes() == 0) return false;
  int last_seen = keys_.num_fixed;
  for (const RelativePoseConstraint& closure : keys_.closures) {
    if (closure.from < keys_.num_fixed) last_seen = std::max(last_seen, closure.to);
  }
  return keys_.keyframes.back().path_m - keys_.keyframes[last_seen].path_m > kMaxPathUnseenM;
}

// The poses so far are settled.
void GrowingMap::BeginSegment() {
  settled_ = Poses();
  world_from_matched_ = settled_.back() * trajectory_.world_from_robot.back().Inverse();
  keys_ = KeyframeGraph();
  memory_ = ClosureMemory();
  first_new_key_ = 0;
  // The next pose follows the last one.
  if (!saved_.keeps_scans) ForgetBefore(graph_.num_poses() - 1);
}

void GrowingMap::SettleOldKeyframes() {
  if (num_keyframes() <= kMaxKeyframes) return;
  const int first = keys_.num_fixed, count = num_keyframes() / 2;
  const int pose = keys_.keyframes[first + count].pose;
  std::vector<Pose2> poses = Poses();
  poses.resize(pose - first_pose_ + num_forgotten_);
  settled_ = std::move(poses);
  RemoveKeyframes(first, count, &keys_);
  first_new_key_ -= count;
  memory_ = ClosureMemory();
  if (is_placed()) {
    SequentialEdge& boundary = keys_.sequential[first - 1];
    boundary = SequentialEdge();
    boundary.between_sessions = true;
    boundary.constraint = {first - 1, first,
                           Between(keys_.world_from_key[first - 1], keys_.world_from_key[first]),
                           Covariance(kSettledM, kSettledRad)};
  }
  if (!saved_.keeps_scans) ForgetBefore(pose);
}

}  // namespace plumbline
