#include "plumbline/solvers/sessions/session_set.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include "plumbline/core/copy_factor.h"
#include "plumbline/solvers/loop_closure/close_loops.h"

namespace plumbline {
namespace {

// Path between two sessions in a group: more than what counts as one pass through a place [m].
constexpr double kGapM = 20.0;

constexpr int kNowhere = -1;

// Appends the scans of the poses from `first` to before `end`, whose ids are `moved` higher there.
// All processes get the same ids of lasers, whoever has the scans.
void AppendScans(const SlamGraph& graph, int first, int end, int moved, SlamGraph* appended_to) {
  const auto is_appended = [&](const ScanEntry& scan) {
    return scan.pose >= first && scan.pose < end;
  };
  std::vector<ScanEntry> all_scans;
  if (graph.peers() != nullptr) all_scans = appended_to->all_scans();
  std::size_t num_returns = appended_to->num_returns_of_all();
  for (ScanEntry scan : graph.all_scans()) {
    if (!is_appended(scan)) continue;
    scan.laser = appended_to->AddLaser(graph.laser(scan.laser));
    scan.pose += moved;
    scan.first_return = num_returns;
    num_returns += scan.num_returns;
    if (graph.peers() != nullptr) all_scans.push_back(scan);
  }
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    const ScanEntry& entry = graph.scan(scan);
    if (!is_appended(entry)) continue;
    appended_to->AddScanOf(graph, scan, entry.pose + moved);
  }
  if (graph.peers() == nullptr) return;
  std::vector<int> rank_of_pose = appended_to->rank_of_pose();
  const auto begin = graph.rank_of_pose().begin();
  rank_of_pose.insert(rank_of_pose.end(), begin + first, begin + end);
  appended_to->ShareWith(graph.peers(), std::move(rank_of_pose), std::move(all_scans));
}

// Appends the poses from `first` to before `end`, with their scans and edges, to another graph.
void AppendPart(const SlamGraph& graph, int first, int end, const std::vector<Pose2>& initial_poses,
                SlamGraph* appended_to) {
  const int moved = appended_to->num_poses() - first;
  for (int pose = first; pose < end; ++pose) {
    appended_to->AddPose(initial_poses[pose - first], graph.timestamp_s(pose));
  }
  const auto pose_there = [&](int pose) {
    return pose >= first && pose < end ? pose + moved : kNowhere;
  };
  std::vector<int> scan_there(graph.num_scans(), kNowhere);
  int num_scans = appended_to->num_scans();
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    if (pose_there(graph.scan(scan).pose) != kNowhere) scan_there[scan] = num_scans++;
  }
  AppendScans(graph, first, end, moved, appended_to);
  for (OdometryConstraint step : graph.odometry()) {
    if (step.from < first || step.from >= end) continue;
    step.from += moved;
    step.to += moved;
    appended_to->AddOdometry(step);
  }
  for (RelativePoseConstraint edge : graph.relative_poses()) {
    if (edge.from < first || edge.from >= end) continue;
    edge.from += moved;
    edge.to += moved;
    appended_to->AddRelativePose(edge);
  }
  for (const CustomFactor& factor : graph.factors()) {
    CopyFactor(
        graph, factor, pose_there, [&](int scan) { return scan_there[scan]; }, appended_to);
  }
}

}  // namespace

Status AddSession(const SlamGraph& graph, SeededDrive drive, SessionSet* set) {
  const int first_pose = set->graph.num_poses(), first_scan = set->first_scan.back();
  AppendPart(graph, 0, graph.num_poses(), drive.world_from_robot, &set->graph);
  std::vector<PackedSurface> surfaces = std::move(set->surfaces).TakeKept();
  surfaces.insert(surfaces.end(), std::make_move_iterator(drive.surfaces.begin()),
                  std::make_move_iterator(drive.surfaces.end()));
  set->surfaces = ScanSurfaces(set->graph, std::move(surfaces));
  for (Keyframe& key : drive.keys.keyframes) {
    key.pose += first_pose;
    key.scan += first_scan;
  }
  for (SequentialEdge& edge : drive.keys.sequential) edge.first_pose_after += first_pose;
  set->keys.push_back(std::move(drive.keys));
  set->matched.push_back(std::move(drive.matched));
  set->first_pose.push_back(set->graph.num_poses());
  set->first_scan.push_back(static_cast<int>(set->graph.all_scans().size()));
  return set->graph.status();
}

void FinishSet(ThreadPool* pool, SessionSet* set) {
  std::vector<int> scans;
  for (const KeyframeGraph& keys : set->keys) {
    const std::vector<int> of_session = ScansOf(keys.keyframes);
    scans.insert(scans.end(), of_session.begin(), of_session.end());
  }
  set->surfaces = set->surfaces.WithKept(scans, pool);
}

SessionGroup GroupOfOne(const SessionSet& set, int session) {
  return {{session}, {0, set.keys[session].size()}, set.keys[session], {}};
}

SessionGroup Concatenated(const SessionGroup& a, const SessionGroup& b, const Pose2& a_from_b) {
  SessionGroup joined{a.sessions, a.first_key, a.keys, {}};
  KeyframeGraph& keys = joined.keys;
  const int num_before = keys.size();
  joined.sessions.insert(joined.sessions.end(), b.sessions.begin(), b.sessions.end());
  for (std::size_t i = 1; i < b.first_key.size(); ++i) {
    joined.first_key.push_back(num_before + b.first_key[i]);
  }
  const double path_m = keys.keyframes.back().path_m + kGapM - b.keys.keyframes.front().path_m;
  for (Keyframe key : b.keys.keyframes) {
    key.path_m += path_m;
    keys.keyframes.push_back(key);
  }
  for (const Pose2& b_from_key : b.keys.world_from_key) {
    keys.world_from_key.push_back(a_from_b * b_from_key);
  }
  const auto renumbered = [num_before](RelativePoseConstraint edge) {
    edge.from += num_before;
    edge.to += num_before;
    return edge;
  };
  SequentialEdge boundary;
  boundary.constraint.from = num_before - 1;
  boundary.constraint.to = num_before;
  boundary.constraint.from_from_to =
      Between(keys.world_from_key[num_before - 1], keys.world_from_key[num_before]);
  boundary.first_pose_after = b.keys.keyframes.front().pose;
  boundary.broken = boundary.between_sessions = true;
  keys.sequential.push_back(boundary);
  for (SequentialEdge edge : b.keys.sequential) {
    edge.constraint = renumbered(edge.constraint);
    keys.sequential.push_back(edge);
  }
  for (auto closures : {&KeyframeGraph::closures, &KeyframeGraph::contradicted,
                        &KeyframeGraph::refused, &KeyframeGraph::tentative}) {
    std::transform((b.keys.*closures).begin(), (b.keys.*closures).end(),
                   std::back_inserter(keys.*closures), renumbered);
  }
  return joined;
}

Status JoinDrives(const SessionSet& set, const SessionGroup& group, const MotionOptions& motion,
                  JoinedDrive* joined) {
  std::vector<Pose2>& poses = joined->matched.world_from_robot;
  std::vector<Keyframe>& keyframes = joined->matched.keyframes;
  joined->graph.ReserveReturns(set.graph.num_returns());
  for (std::size_t i = 0; i < group.sessions.size(); ++i) {
    const int session = group.sessions[i];
    const SequentialTrajectory& own = set.matched[session];
    const int first_pose = joined->first_pose.back(), first_scan = joined->first_scan.back();
    const Pose2 world_from_session = group.keys.world_from_key[group.first_key[i]] *
                                     own.world_from_robot[own.keyframes.front().pose].Inverse();
    std::vector<Pose2> placed;
    for (const Pose2& pose : own.world_from_robot) placed.push_back(world_from_session * pose);
    AppendPart(set.graph, set.first_pose[session], set.first_pose[session + 1], placed,
               &joined->graph);
    std::vector<Pose2> odometry = own.odometry;
    odometry.front() = i == 0 ? Pose2() : Between(poses.back(), placed.front());
    poses.insert(poses.end(), placed.begin(), placed.end());
    joined->matched.odometry.insert(joined->matched.odometry.end(), odometry.begin(),
                                    odometry.end());
    const double path_m = i == 0 ? 0.0 : keyframes.back().path_m + kGapM;
    for (Keyframe key : own.keyframes) {
      key.pose += first_pose;
      key.scan += first_scan;
      key.path_m += path_m;
      keyframes.push_back(key);
    }
    const std::vector<PackedSurface>& kept = set.surfaces.kept();
    joined->surfaces.insert(joined->surfaces.end(), kept.begin() + set.first_scan[session],
                            kept.begin() + set.first_scan[session + 1]);
    joined->first_pose.push_back(joined->graph.num_poses());
    joined->first_scan.push_back(static_cast<int>(joined->graph.all_scans().size()));
  }
  joined->ties = MakeKeyframeGraph(joined->matched, motion);
  joined->ties.world_from_key = group.keys.world_from_key;
  for (std::size_t i = 1; i < group.sessions.size(); ++i) {
    SequentialEdge& boundary = joined->ties.sequential[group.first_key[i] - 1];
    boundary.first_pose_after = joined->first_pose[i];
    boundary.broken = boundary.between_sessions = true;
  }
  for (const RelativePoseConstraint& closure : group.keys.closures) {
    if (joined->ties.EndOfSession(closure.from) <= closure.to) {
      joined->ties.closures.push_back(closure);
    }
  }
  return joined->graph.status();
}

}  // namespace plumbline
