#include "plumbline/solvers/loop_closure/close_loops.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/solvers/front_end/odometry_span.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/loop_closure/closure_clusters.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/pose_graph/robust_pose_graph.h"

namespace plumbline {
namespace {

constexpr int kMaxRounds = 5;
// Candidates between two reports of progress.
constexpr std::size_t kCandidatesPerReport = 64;

// Those that tie the part of a session before the edge to the one after it, be it by way of other
// sessions: then as many as lead there from both.
int NumClosuresAcross(int edge, const KeyframeGraph& keys) {
  const int begin = keys.BeginOfSession(edge), end = keys.EndOfSession(edge);
  int num_direct = 0, num_before = 0, num_after = 0;
  for (const RelativePoseConstraint& closure : keys.closures) {
    int before = 0, after = 0;
    for (const int key : {closure.from, closure.to}) {
      if (key >= begin && key <= edge) ++before;
      if (key > edge && key < end) ++after;
    }
    if (before == 1 && after == 1) ++num_direct;
    if (before == 1 && after == 0) ++num_before;
    if (before == 0 && after == 1) ++num_after;
  }
  return num_direct + std::min(num_before, num_after);
}

// Breaks the suspect edge that is farthest off the others, if it is too far and there are enough
// closures to do without it.
bool BreakWorstEdge(KeyframeGraph* keys) {
  SequentialEdge* worst = nullptr;
  double worst_chi2 = LoopAcceptance::kMaxEdgeChi2;
  for (SequentialEdge& edge : keys->sequential) {
    if (!edge.in_question || edge.broken) continue;
    const double chi2 = EdgeChi2(edge.constraint, keys->world_from_key);
    if (chi2 <= worst_chi2) continue;
    if (NumClosuresAcross(edge.constraint.from, *keys) < LoopAcceptance::kMinClosuresAcross)
      continue;
    worst_chi2 = chi2;
    worst = &edge;
  }
  if (worst != nullptr) worst->broken = true;
  return worst != nullptr;
}

// Drops the closures that the others contradict, the worst half of them since a wrong one bends its
// neighbours.
bool DropWorstClosures(KeyframeGraph* keys) {
  std::vector<double> wrong;
  for (const RelativePoseConstraint& closure : keys->closures) {
    const double chi2 = EdgeChi2(closure, keys->world_from_key);
    if (chi2 > LoopAcceptance::kMaxEdgeChi2) wrong.push_back(chi2);
  }
  if (wrong.empty()) return false;
  const double median = Median(std::move(wrong));
  const auto kept = std::stable_partition(keys->closures.begin(), keys->closures.end(),
                                          [&](const RelativePoseConstraint& closure) {
                                            return EdgeChi2(closure, keys->world_from_key) < median;
                                          });
  keys->contradicted.insert(keys->contradicted.end(), kept, keys->closures.end());
  keys->closures.erase(kept, keys->closures.end());
  return true;
}

void OptimizeAndPrune(KeyframeGraph* keys) {
  do {
    OptimizeKeyframes(keys);
  } while (BreakWorstEdge(keys) || DropWorstClosures(keys));
}

// Tests the candidates that the memory does not know. One result per candidate, in their order.
Status TestInBatches(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                     const std::vector<LoopCandidate>& candidates, const SeedingProgress& progress,
                     ThreadPool* pool, ClosureMemory* memory,
                     std::vector<TestedCandidate>* tested) {
  tested->resize(candidates.size());
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (const TestedCandidate* known = memory->Find(candidates[i], keys)) {
      (*tested)[i] = *known;
    } else {
      unknown.push_back(i);
    }
  }
  for (std::size_t begin = 0; begin < unknown.size(); begin += kCandidatesPerReport) {
    if (progress && !progress(SeedingPhase::kClosingLoops, static_cast<int>(begin),
                              static_cast<int>(unknown.size()))) {
      return Status::Unavailable("loop closing was stopped by its caller");
    }
    const std::size_t end = std::min(unknown.size(), begin + kCandidatesPerReport);
    std::vector<LoopCandidate> batch;
    for (std::size_t i = begin; i < end; ++i) batch.push_back(candidates[unknown[i]]);
    const std::vector<TestedCandidate> results = TestLoopCandidates(surfaces, keys, batch, pool);
    for (std::size_t i = 0; i < results.size(); ++i) {
      (*tested)[unknown[begin + i]] = results[i];
      memory->Add(batch[i], keys, results[i]);
    }
  }
  return Status::Ok();
}

// Rounds of closures whose later keyframe is `first_key` or after it. refused: the matches of the
// last round that are no closures.
Status CloseInRounds(int first_key, const ScanSurfaces& surfaces, const SeedingProgress& progress,
                     ThreadPool* pool, ClosureMemory* memory, KeyframeGraph* keys,
                     int* num_candidates, std::vector<TestedCandidate>* refused) {
  bool found = true;
  for (int round = 0; round < kMaxRounds && found; ++round) {
    const std::vector<LoopCandidate> candidates =
        FindLoopCandidates(*keys, surfaces.graph().peers(), pool, first_key);
    std::vector<TestedCandidate> tested;
    PLUMBLINE_RETURN_IF_ERROR(
        TestInBatches(surfaces, *keys, candidates, progress, pool, memory, &tested));
    *num_candidates += static_cast<int>(candidates.size());
    refused->clear();
    found = false;
    for (const TestedCandidate& result : tested) {
      if (RepeatsOneOf(result.edge, keys->refused, *keys)) continue;
      if (result.outcome == ClosureOutcome::kAccepted) {
        keys->closures.push_back(result.edge);
        found = true;
      } else if (result.outcome != ClosureOutcome::kNoMatch) {
        refused->push_back(result);
      }
    }
    if (found || first_key == 0) OptimizeAndPrune(keys);
  }
  return Status::Ok();
}

// What nearly became a closure, the best first and of each place once: as much as is weighed at a
// time.
void KeepTentative(std::vector<TestedCandidate> refused, KeyframeGraph* keys) {
  refused.erase(std::remove_if(refused.begin(), refused.end(),
                               [](const TestedCandidate& result) {
                                 return result.inlier_ratio <
                                            LoopAcceptance::kTentativeInlierRatio ||
                                        result.conflict > LoopAcceptance::kMaxFreeSpaceConflict;
                               }),
                refused.end());
  std::stable_sort(refused.begin(), refused.end(),
                   [](const TestedCandidate& a, const TestedCandidate& b) {
                     return a.inlier_ratio > b.inlier_ratio;
                   });
  std::vector<RelativePoseConstraint> matches;
  matches.reserve(refused.size());
  for (const TestedCandidate& result : refused) matches.push_back(result.edge);
  constexpr std::size_t kMostTentative = 8;
  keys->tentative = WithoutRepetitions(matches, kMostTentative, *keys);
}

// Where the laser sees too little again and again, as outdoors, that says nothing of a single step.
// One keyframe of a hundred may come after a scan that matched nothing: outdoors, in fr-clinic,
// more do; in the buildings of the other real logs it is one of 200 to 1000.
bool UnmatchedAreRare(const KeyframeGraph& keys) {
  constexpr int kOneIn = 100;
  const auto num_unmatched =
      std::count_if(keys.keyframes.begin(), keys.keyframes.end(),
                    [](const Keyframe& keyframe) { return keyframe.after_unmatched; });
  return num_unmatched <= std::max(1, keys.size() / kOneIn);
}

void WriteReport(const KeyframeGraph& keys, const std::vector<TestedCandidate>& refused,
                 LoopClosingReport* report) {
  const auto record = [&](const RelativePoseConstraint& edge, ClosureOutcome outcome) {
    report->matches.push_back(
        {keys.keyframes[edge.from].pose, keys.keyframes[edge.to].pose, edge.from_from_to, outcome});
  };
  for (const auto& edge : keys.closures) record(edge, ClosureOutcome::kAccepted);
  for (const auto* wrong : {&keys.contradicted, &keys.refused}) {
    for (const auto& edge : *wrong) record(edge, ClosureOutcome::kContradicted);
  }
  for (const TestedCandidate& result : refused) record(result.edge, result.outcome);
  report->num_closures = static_cast<int>(keys.closures.size());
  report->num_contradicted = static_cast<int>(keys.contradicted.size() + keys.refused.size());
  const bool unmatched_are_rare = UnmatchedAreRare(keys);
  for (const SequentialEdge& edge : keys.sequential) {
    if (edge.evidence == 0.0) continue;
    const int from = edge.constraint.from;
    SuspectStep suspect;
    suspect.first_pose_after = edge.first_pose_after;
    suspect.evidence = edge.evidence;
    suspect.broken = edge.broken;
    suspect.unmatched = unmatched_are_rare && keys.keyframes[from + 1].after_unmatched;
    if (edge.broken) {
      const Pose2 step = Between(keys.world_from_key[from], keys.world_from_key[from + 1]);
      suspect.turned_rad = NormalizeAngle(step.yaw - edge.constraint.from_from_to.yaw);
    }
    suspect.num_closures_across = NumClosuresAcross(from, keys);
    report->suspect_steps.push_back(suspect);
  }
}

// The finished map is one pose of the graph, which sees the other keyframes.
void OptimizeInFixedMap(std::vector<RelativePoseConstraint> certain,
                        std::vector<RelativePoseConstraint> uncertain, KeyframeGraph* keys) {
  const auto first = keys->world_from_key.begin() + keys->num_fixed;
  std::vector<Pose2> poses = {Pose2()};
  poses.insert(poses.end(), first, keys->world_from_key.end());
  for (std::vector<RelativePoseConstraint>* edges : {&certain, &uncertain}) {
    edges->erase(std::remove_if(edges->begin(), edges->end(),
                                [keys](const RelativePoseConstraint& edge) {
                                  return edge.from < keys->num_fixed && edge.to < keys->num_fixed;
                                }),
                 edges->end());
    for (RelativePoseConstraint& edge : *edges) {
      edge.to -= keys->num_fixed - 1;
      if (edge.from < keys->num_fixed) {
        const Pose2& world_from_from = keys->world_from_key[edge.from];
        edge.from = 0;
        edge.from_from_to = world_from_from * edge.from_from_to;
        edge.covariance = RotateAxes(edge.covariance, world_from_from.yaw);
      } else {
        edge.from -= keys->num_fixed - 1;
      }
    }
  }
  OptimizeRobustly(certain, uncertain, &poses);
  std::copy(poses.begin() + 1, poses.end(), first);
}

}  // namespace

void OptimizeKeyframes(KeyframeGraph* keys) {
  std::vector<RelativePoseConstraint> certain, uncertain = keys->closures;
  for (const SequentialEdge& edge : keys->sequential) {
    (edge.in_question && !edge.broken ? uncertain : certain).push_back(edge.InForce());
  }
  if (keys->num_fixed > 0) {
    OptimizeInFixedMap(std::move(certain), std::move(uncertain), keys);
    return;
  }
  if (keys->given.given_from_key.empty()) {
    OptimizeRobustly(certain, uncertain, &keys->world_from_key);
    return;
  }
  // The given frame is one more pose, which sees each keyframe.
  std::vector<Pose2> poses = keys->world_from_key;
  const int given_frame = keys->size();
  poses.push_back(keys->given.world_from_given);
  const double variance_m2 = keys->given.noise.position_m * keys->given.noise.position_m;
  const double variance_rad2 = keys->given.noise.yaw_rad * keys->given.noise.yaw_rad;
  const Eigen::Matrix3d covariance =
      Eigen::Vector3d(variance_m2, variance_m2, variance_rad2).asDiagonal();
  for (int k = 0; k < keys->size(); ++k) {
    uncertain.push_back({given_frame, k, keys->given.given_from_key[k], covariance});
  }
  OptimizeRobustly(certain, uncertain, &poses);
  keys->given.world_from_given = poses.back();
  poses.pop_back();
  keys->world_from_key = std::move(poses);
}

KeyframeGraph MakeKeyframeGraph(const SequentialTrajectory& trajectory,
                                const MotionOptions& motion) {
  KeyframeGraph graph;
  graph.keyframes = trajectory.keyframes;
  for (const Keyframe& key : trajectory.keyframes) {
    graph.world_from_key.push_back(trajectory.world_from_robot[key.pose]);
  }
  const bool has_given_poses = !trajectory.given_poses.empty();
  if (has_given_poses && graph.size() > 0) {
    graph.given.noise = trajectory.given_noise;
    for (const Keyframe& key : graph.keyframes) {
      graph.given.given_from_key.push_back(trajectory.given_poses[key.pose]);
    }
    graph.given.world_from_given =
        graph.world_from_key.front() * graph.given.given_from_key.front().Inverse();
  }
  for (int k = 1; k < graph.size(); ++k) {
    graph.sequential.push_back(
        MatchedEdge(k - 1, graph.keyframes[k - 1], graph.keyframes[k], trajectory, motion));
  }
  return graph;
}

SequentialEdge MatchedEdge(int from_key, const Keyframe& from, const Keyframe& to,
                           const SequentialTrajectory& trajectory, const MotionOptions& motion) {
  const bool has_given_poses = !trajectory.given_poses.empty();
  const std::vector<Pose2>& poses = trajectory.world_from_robot;
  const Pose2 from_from_to = Between(poses[from.pose], poses[to.pose]);
  Eigen::Matrix3d known = Eigen::Matrix3d::Zero();
  if (!has_given_poses) {
    known = ChainOdometry(trajectory.odometry, from.pose, to.pose, motion).covariance.inverse();
  }
  SequentialEdge edge{{from_key, from_key + 1, from_from_to,
                       MatchCovariance(RotateAxes(to.information, from_from_to.yaw), known)}};
  // The given poses may contradict it.
  edge.in_question = has_given_poses;
  return edge;
}

Status CloseLoops(const ScanSurfaces& surfaces, const SeedingProgress& progress, ThreadPool* pool,
                  ClosureMemory* memory, KeyframeGraph* keys, LoopClosingReport* report) {
  *report = LoopClosingReport();
  if (!keys->closures.empty()) OptimizeAndPrune(keys);
  std::vector<TestedCandidate> refused;
  PLUMBLINE_RETURN_IF_ERROR(
      CloseInRounds(0, surfaces, progress, pool, memory, keys, &report->num_candidates, &refused));
  KeepTentative(refused, keys);
  WriteReport(*keys, refused, report);
  return Status::Ok();
}

Status CloseNewLoops(int first_key, const ScanSurfaces& surfaces, const SeedingProgress& progress,
                     ThreadPool* pool, ClosureMemory* memory, KeyframeGraph* keys) {
  int num_candidates = 0;
  std::vector<TestedCandidate> refused;
  return CloseInRounds(first_key, surfaces, progress, pool, memory, keys, &num_candidates,
                       &refused);
}

}  // namespace plumbline
