#include "plumbline/solvers/seeding/close_loops.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/pose_graph/robust_pose_graph.h"
#include "plumbline/solvers/seeding/closure_clusters.h"
#include "plumbline/solvers/seeding/match_covariance.h"
#include "plumbline/solvers/seeding/odometry_span.h"

namespace plumbline {
namespace {

constexpr int kMaxRounds = 5;
// Candidates between two reports of progress.
constexpr std::size_t kCandidatesPerReport = 64;

int NumClosuresAcross(int edge, const KeyGraph& keys) {
  return static_cast<int>(std::count_if(
      keys.closures.begin(), keys.closures.end(),
      [&](const RelativePoseConstraint& c) { return c.from <= edge && c.to > edge; }));
}

// A bridge that agrees with the edges below it is no second witness: both come from the same scans.
// Where the edge is not trusted, it at least shows that they fit.
bool OnlyRepeatsItsEdge(const RelativePoseConstraint& bridge, const KeyGraph& keys) {
  for (int edge = bridge.from; edge < bridge.to; ++edge) {
    if (keys.sequential[edge].untrusted()) return false;
  }
  return EdgeChi2(bridge, keys.world_from_key) <= LoopAcceptance::kMaxEdgeChi2;
}

// Breaks the doubtful edge that is farthest off the others, if it is too far and there are enough
// closures to do without it.
bool BreakWorstEdge(KeyGraph* keys) {
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
bool DropWorstClosures(KeyGraph* keys) {
  std::vector<double> wrong;
  for (const RelativePoseConstraint& closure : keys->closures) {
    const double chi2 = EdgeChi2(closure, keys->world_from_key);
    if (chi2 > LoopAcceptance::kMaxEdgeChi2) wrong.push_back(chi2);
  }
  if (wrong.empty()) return false;
  const auto median = wrong.begin() + static_cast<std::ptrdiff_t>(wrong.size() / 2);
  std::nth_element(wrong.begin(), median, wrong.end());
  const auto kept = std::stable_partition(
      keys->closures.begin(), keys->closures.end(), [&](const RelativePoseConstraint& closure) {
        return EdgeChi2(closure, keys->world_from_key) < *median;
      });
  keys->contradicted.insert(keys->contradicted.end(), kept, keys->closures.end());
  keys->closures.erase(kept, keys->closures.end());
  return true;
}

void OptimizeAndPrune(KeyGraph* keys) {
  do {
    OptimizeKeyScans(keys);
  } while (BreakWorstEdge(keys) || DropWorstClosures(keys));
}

// Tests the candidates that the memory does not know. One result per candidate, in their order.
Status TestInBatches(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                     const KeyGraph& keys, const std::vector<LoopCandidate>& candidates,
                     const SeedingProgress& progress, ThreadPool* pool, ClosureMemory* memory,
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
    const std::vector<TestedCandidate> results =
        TestLoopCandidates(graph, surfaces, keys, batch, pool);
    for (std::size_t i = 0; i < results.size(); ++i) {
      (*tested)[unknown[begin + i]] = results[i];
      memory->Add(batch[i], keys, results[i]);
    }
  }
  return Status::Ok();
}

// What nearly became a closure.
void KeepTentative(std::vector<TestedCandidate> refused, KeyGraph* keys) {
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
  keys->tentative.clear();
  for (const TestedCandidate& result : refused) keys->tentative.push_back(result.edge);
}

void WriteReport(const KeyGraph& keys, const std::vector<TestedCandidate>& refused_bridges,
                 const std::vector<TestedCandidate>& refused_closures, LoopClosingReport* report) {
  const auto record = [&](const RelativePoseConstraint& edge, ClosureVerdict verdict) {
    report->matches.push_back(
        {keys.key_scans[edge.from].pose, keys.key_scans[edge.to].pose, edge.from_from_to, verdict});
  };
  for (const auto& edge : keys.closures) record(edge, ClosureVerdict::kAccepted);
  for (const auto* wrong : {&keys.contradicted, &keys.refused}) {
    for (const auto& edge : *wrong) record(edge, ClosureVerdict::kContradicted);
  }
  for (const auto* refused : {&refused_bridges, &refused_closures}) {
    for (const TestedCandidate& result : *refused) record(result.edge, result.verdict);
  }
  report->num_closures = static_cast<int>(keys.closures.size());
  report->num_contradicted = static_cast<int>(keys.contradicted.size() + keys.refused.size());
  for (const SequentialEdge& edge : keys.sequential) {
    if (edge.evidence == 0.0) continue;
    const int from = edge.constraint.from;
    DoubtfulStep doubt;
    doubt.first_pose_after = edge.first_pose_after;
    doubt.evidence = edge.evidence;
    doubt.broken = edge.broken;
    if (edge.broken) {
      const Pose2 step = Between(keys.world_from_key[from], keys.world_from_key[from + 1]);
      doubt.turned_rad = NormalizeAngle(step.yaw - edge.constraint.from_from_to.yaw);
    }
    doubt.num_closures_across = NumClosuresAcross(from, keys);
    report->doubts.push_back(doubt);
  }
}

}  // namespace

void OptimizeKeyScans(KeyGraph* keys) {
  std::vector<RelativePoseConstraint> certain, doubtful = keys->closures;
  for (const SequentialEdge& edge : keys->sequential) {
    (edge.in_question && !edge.broken ? doubtful : certain).push_back(edge.InForce());
  }
  OptimizeRobustly(certain, doubtful, &keys->world_from_key);
}

KeyGraph MakeKeyGraph(const SequentialTrajectory& trajectory, const MotionOptions& motion) {
  KeyGraph graph;
  graph.key_scans = trajectory.key_scans;
  for (const KeyScan& key : trajectory.key_scans) {
    graph.world_from_key.push_back(trajectory.world_from_robot[key.pose]);
  }
  for (int k = 1; k < graph.size(); ++k) {
    const KeyScan& from = graph.key_scans[k - 1];
    const KeyScan& to = graph.key_scans[k];
    const Pose2 from_from_to = Between(graph.world_from_key[k - 1], graph.world_from_key[k]);
    const Eigen::Matrix3d known =
        ChainOdometry(trajectory.odometry, from.pose, to.pose, motion).covariance.inverse();
    graph.sequential.push_back(
        {{k - 1, k, from_from_to,
          MatchCovariance(RotateAxes(to.information, from_from_to.yaw), known)}});
  }
  return graph;
}

Status CloseLoops(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                  const SeedingProgress& progress, ThreadPool* pool, ClosureMemory* memory,
                  KeyGraph* keys, LoopClosingReport* report) {
  *report = LoopClosingReport();
  if (!keys->closures.empty()) OptimizeAndPrune(keys);
  std::vector<TestedCandidate> refused_bridges, refused_closures;
  for (int round = 0; round <= kMaxRounds; ++round) {
    // What the robot did at a doubtful edge is best told from what lies next to it.
    const bool bridging = round == 0;
    const std::vector<LoopCandidate> candidates =
        bridging ? FindBridges(*keys) : FindLoopCandidates(*keys, pool);
    std::vector<TestedCandidate> tested;
    PLUMBLINE_RETURN_IF_ERROR(
        TestInBatches(graph, surfaces, *keys, candidates, progress, pool, memory, &tested));
    report->num_candidates += static_cast<int>(candidates.size());
    std::vector<TestedCandidate>& refused = bridging ? refused_bridges : refused_closures;
    refused.clear();
    const std::size_t num_closures = keys->closures.size();
    for (const TestedCandidate& result : tested) {
      if (bridging && OnlyRepeatsItsEdge(result.edge, *keys)) continue;
      if (RepeatsRefused(result.edge, keys->refused, *keys)) continue;
      if (result.verdict == ClosureVerdict::kAccepted) {
        keys->closures.push_back(result.edge);
      } else if (result.verdict != ClosureVerdict::kNoMatch) {
        refused.push_back(result);
      }
    }
    const bool found = keys->closures.size() > num_closures;
    OptimizeAndPrune(keys);
    if (!found && !bridging) break;
  }
  KeepTentative(refused_closures, keys);
  WriteReport(*keys, refused_bridges, refused_closures, report);
  return Status::Ok();
}

std::vector<Pose2> PosesFollowingKeyScans(const KeyGraph& key_graph,
                                          const std::vector<Pose2>& before) {
  const std::vector<KeyScan>& keys = key_graph.key_scans;
  if (keys.empty()) return before;
  std::vector<Pose2> poses(before.size());
  std::size_t next = 0;
  for (int pose = 0; pose < static_cast<int>(before.size()); ++pose) {
    while (next < keys.size() && keys[next].pose <= pose) ++next;
    const std::size_t a = next > 0 ? next - 1 : 0;
    const std::size_t b = std::min(next, keys.size() - 1);
    const Pose2 from_a = key_graph.world_from_key[a] * Between(before[keys[a].pose], before[pose]);
    const Pose2 from_b = key_graph.world_from_key[b] * Between(before[keys[b].pose], before[pose]);
    const int span = keys[b].pose - keys[a].pose;
    double share = span > 0 ? static_cast<double>(pose - keys[a].pose) / span : 0.0;
    if (span > 0 && key_graph.sequential[a].broken) {
      share = pose < key_graph.sequential[a].first_pose_after ? 0.0 : 1.0;
    }
    const Pose2 a_from_b = Between(from_a, from_b);
    poses[pose] = from_a * Pose2(share * a_from_b.x, share * a_from_b.y, share * a_from_b.yaw);
  }
  return poses;
}

}  // namespace plumbline
