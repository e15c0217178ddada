#include "plumbline/solvers/acceptance/contradicted_edges.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/pose2.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"

namespace plumbline {
namespace {

// 99.9 % quantile of chi-squared with three degrees of freedom.
constexpr double kMaxChi2 = LoopAcceptance::kMaxRelief;
// Conflicts at an edge over the usual ones from one scan to the next, above which they count.
constexpr double kUsualFactor = 3.0;
// Returns that both sides must have seen: fewer say nothing.
constexpr int kMinCompared = 50;
// Path [m] to the scans beside one: at least, and at most.
constexpr double kBesideM = 1.0, kMaxBesideM = 5.0;

bool IsStep(int from, int to) { return std::abs(from - to) == 1; }
bool IsStep(const RelativePoseConstraint& edge) { return IsStep(edge.from, edge.to); }

// In the frame of `from`.
Eigen::Vector3d ErrorOf(const Pose2& measured, const Pose2& actual) {
  return {actual.x - measured.x, actual.y - measured.y, NormalizeAngle(actual.yaw - measured.yaw)};
}

double Chi2(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

bool IsEnough(const FreeSpaceConflict& conflict) { return conflict.num_compared >= kMinCompared; }

}  // namespace

EdgeTests::EdgeTests(const RangeBeamOptions& beam)
    : icp_(IcpOptionsFor(beam, IcpMetric::kPointToLine)),
      max_conflict_(LoopAcceptance::kMaxFreeSpaceConflict) {}

void EdgeTests::Extend(const SlamGraph& graph, const MeasuredSurface& surface, ThreadPool* pool) {
  const ScanSurfaces surfaces(graph, surface);
  scan_of_pose_ = surfaces.scan_of_pose();
  step_to_.resize(graph.num_poses());
  // The steps first: they tell how the scans beside each other lie, and what is usual.
  const std::vector<RelativePoseConstraint>& all = graph.relative_poses();
  std::vector<RelativePoseConstraint> odometry, steps;
  for (; num_odometry_ < graph.odometry().size(); ++num_odometry_) {
    const OdometryConstraint& c = graph.odometry()[num_odometry_];
    if (IsStep(c.from, c.to)) odometry.push_back({c.from, c.to, c.from_from_to});
  }
  for (std::size_t i = evidence_.size(); i < all.size(); ++i) {
    if (IsStep(all[i])) steps.push_back(all[i]);
  }
  const std::vector<Evidence> of_odometry = Test(surfaces, odometry, pool);
  const std::vector<Evidence> of_steps = Test(surfaces, steps, pool);
  for (const std::vector<Evidence>* evidence : {&of_odometry, &of_steps}) {
    for (const Evidence& seen : *evidence) {
      if (IsEnough(seen.at_match)) usual_shares_.push_back(seen.at_match.Share());
    }
  }
  max_conflict_ = LoopAcceptance::kMaxFreeSpaceConflict;
  if (!usual_shares_.empty()) {
    max_conflict_ = std::max(max_conflict_, kUsualFactor * Median(usual_shares_));
  }
  TakeSteps(odometry, of_odometry);
  TakeSteps(steps, of_steps);
  auto step = of_steps.begin();
  std::vector<std::size_t> others;
  for (std::size_t i = evidence_.size(); i < all.size(); ++i) {
    if (!IsStep(all[i])) others.push_back(i);
    evidence_.push_back(IsStep(all[i]) ? *step++ : Evidence());
  }
  TestOthers(surfaces, std::move(others), pool);
}

// Tests new edges, and once more those whose scan beyond the later pose was still to come.
void EdgeTests::TestOthers(const ScanSurfaces& surfaces, std::vector<std::size_t> to_test,
                           ThreadPool* pool) {
  const std::vector<RelativePoseConstraint>& all = surfaces.graph().relative_poses();
  const auto is_near_the_end = [&](std::size_t i) {
    return IsNearTheEnd(std::max(all[i].from, all[i].to));
  };
  const auto ready = std::stable_partition(waiting_.begin(), waiting_.end(), is_near_the_end);
  const std::vector<std::size_t> again(ready, waiting_.end());
  waiting_.erase(ready, waiting_.end());
  std::copy_if(to_test.begin(), to_test.end(), std::back_inserter(waiting_), is_near_the_end);
  to_test.insert(to_test.end(), again.begin(), again.end());
  std::vector<RelativePoseConstraint> edges;
  edges.reserve(to_test.size());
  for (const std::size_t i : to_test) edges.push_back(all[i]);
  const std::vector<Evidence> evidence = Test(surfaces, edges, pool);
  for (std::size_t k = 0; k < edges.size(); ++k) evidence_[to_test[k]] = evidence[k];
}

// True if less than kBesideM of path follows the pose.
bool EdgeTests::IsNearTheEnd(int pose) const {
  double path_m = 0.0;
  for (std::size_t next = pose + 1; next < step_to_.size(); ++next) {
    if (!step_to_[next]) return false;
    path_m += std::hypot(step_to_[next]->x, step_to_[next]->y);
    if (path_m >= kBesideM) return false;
  }
  return true;
}

std::vector<ContradictedEdge> EdgeTests::Contradicted(const SlamGraph& graph) const {
  std::vector<ContradictedEdge> contradicted;
  for (std::size_t i = 0; i < evidence_.size(); ++i) {
    const RelativePoseConstraint& edge = graph.relative_poses()[i];
    const std::optional<RelativePoseConstraint> match = MatchOf(edge, evidence_[i]);
    if (IsContradicted(edge, match, evidence_[i])) contradicted.push_back({i, match});
  }
  return contradicted;
}

std::vector<EdgeTests::Evidence> EdgeTests::Test(const ScanSurfaces& surfaces,
                                                 const std::vector<RelativePoseConstraint>& edges,
                                                 ThreadPool* pool) const {
  const SlamGraph& graph = surfaces.graph();
  std::vector<std::size_t> own;
  std::vector<int> scans;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const RelativePoseConstraint& edge = edges[i];
    if (!HaveScans(edge) || !graph.HasScansOf(edge.from)) continue;
    own.push_back(i);
    if (graph.peers() == nullptr) continue;
    for (const int pose : {edge.from, edge.to}) {
      for (const Beside& one : ScansBeside(pose, IsStep(edge))) scans.push_back(one.scan);
    }
  }
  const ScanSurfaces known = surfaces.With(scans);
  std::vector<Evidence> evidence(edges.size());
  constexpr std::size_t kEdgesPerChunk = 16;
  pool->ForEach(own.size(), kEdgesPerChunk,
                [&](std::size_t i) { evidence[own[i]] = Test(known, edges[own[i]]); });
  if (graph.peers() == nullptr) return evidence;
  std::vector<std::pair<std::size_t, Evidence>> of_own;
  of_own.reserve(own.size());
  for (const std::size_t i : own) of_own.emplace_back(i, evidence[i]);
  for (const auto& [edge, seen] : JoinOverPeers(graph.peers(), std::move(of_own))) {
    evidence[edge] = seen;
  }
  return evidence;
}

EdgeTests::Evidence EdgeTests::Test(const ScanSurfaces& surfaces,
                                    const RelativePoseConstraint& edge) const {
  Evidence seen;
  seen.match = MatchPair(surfaces.Of(scan_of_pose_[edge.from]), surfaces.Of(scan_of_pose_[edge.to]),
                         edge.from_from_to, icp_);
  const std::vector<Beside> scans_b = ScansBeside(edge.to, IsStep(edge));
  std::vector<FreeSpaceScan> free_b;
  free_b.reserve(scans_b.size());
  for (const Beside& b : scans_b) free_b.push_back(surfaces.FreeSpaceOf(b.scan));
  for (const Beside& a : ScansBeside(edge.from, IsStep(edge))) {
    const FreeSpaceScan free_a = surfaces.FreeSpaceOf(a.scan);
    const Pose2 a_from_from = a.pose_from_scan.Inverse();
    for (std::size_t b = 0; b < scans_b.size(); ++b) {
      const auto conflict_at = [&](const Pose2& from_from_to) {
        return CompareBothWays(free_a, free_b[b],
                               a_from_from * from_from_to * scans_b[b].pose_from_scan);
      };
      seen.at_edge += conflict_at(edge.from_from_to);
      seen.at_match += conflict_at(seen.match.from_from_to);
    }
  }
  return seen;
}

// The scan of a pose, alone or with the first ones kBesideM before and after it.
std::vector<EdgeTests::Beside> EdgeTests::ScansBeside(int pose, bool alone) const {
  std::vector<Beside> scans = {{scan_of_pose_[pose], Pose2()}};
  if (alone) return scans;
  for (const int direction : {-1, 1}) {
    if (const std::optional<Beside> beside = FindBeside(pose, direction)) {
      scans.push_back(*beside);
    }
  }
  return scans;
}

std::optional<EdgeTests::Beside> EdgeTests::FindBeside(int pose, int direction) const {
  Beside beside;
  double path_m = 0.0;
  const int num_poses = static_cast<int>(step_to_.size());
  for (int other = pose + direction; other >= 0 && other < num_poses; other += direction) {
    const std::optional<Pose2>& step = step_to_[std::max(other, other - direction)];
    if (!step) return std::nullopt;
    beside.pose_from_scan = beside.pose_from_scan * (direction > 0 ? *step : step->Inverse());
    path_m += std::hypot(step->x, step->y);
    if (path_m > kMaxBesideM) return std::nullopt;
    beside.scan = scan_of_pose_[other];
    if (path_m >= kBesideM && beside.scan >= 0) return beside;
  }
  return std::nullopt;
}

// Notes how consecutive scans lie: by their match, or else by the edge.
void EdgeTests::TakeSteps(const std::vector<RelativePoseConstraint>& steps,
                          const std::vector<Evidence>& evidence) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const RelativePoseConstraint step = MatchOf(steps[i], evidence[i]).value_or(steps[i]);
    step_to_[std::max(step.from, step.to)] =
        step.from < step.to ? step.from_from_to : step.from_from_to.Inverse();
  }
}

bool EdgeTests::IsContradictory(const FreeSpaceConflict& conflict) const {
  return IsEnough(conflict) && conflict.Share() > max_conflict_;
}

std::optional<RelativePoseConstraint> EdgeTests::MatchOf(const RelativePoseConstraint& edge,
                                                         const Evidence& seen) const {
  if (seen.match.inlier_ratio < LoopAcceptance::kMinInlierRatio || IsContradictory(seen.at_match)) {
    return std::nullopt;
  }
  return RelativePoseConstraint{edge.from, edge.to, seen.match.from_from_to, seen.match.covariance};
}

bool EdgeTests::IsContradicted(const RelativePoseConstraint& edge,
                               const std::optional<RelativePoseConstraint>& match,
                               const Evidence& seen) const {
  if (match && Chi2(ErrorOf(edge.from_from_to, match->from_from_to),
                    edge.covariance + match->covariance) > kMaxChi2) {
    return true;
  }
  return IsContradictory(seen.at_edge) && (match || !IsStep(edge));
}

std::vector<ContradictedEdge> FindContradictedEdges(const SlamGraph& graph,
                                                    const MeasuredSurface& surface,
                                                    const RangeBeamOptions& beam,
                                                    ThreadPool* pool) {
  EdgeTests tests(beam);
  tests.Extend(graph, surface, pool);
  return tests.Contradicted(graph);
}

IgnoredEdge DescribeEdge(std::size_t index, const SlamGraph& graph,
                         const std::vector<double>& poses) {
  const RelativePoseConstraint& edge = graph.relative_poses()[index];
  const Eigen::Vector3d error =
      ErrorOf(edge.from_from_to, Between(Pose2(&poses[3 * edge.from]), Pose2(&poses[3 * edge.to])));
  return {index,
          edge.from,
          edge.to,
          error.head<2>().norm(),
          std::abs(error.z()),
          std::sqrt(Chi2(error, edge.covariance))};
}

std::vector<IgnoredEdge> DescribeIgnored(const std::vector<ContradictedEdge>& contradicted,
                                         const SlamGraph& graph, const std::vector<double>& poses) {
  std::vector<IgnoredEdge> ignored;
  ignored.reserve(contradicted.size());
  for (const ContradictedEdge& c : contradicted) {
    ignored.push_back(DescribeEdge(c.edge, graph, poses));
  }
  return ignored;
}

}  // namespace plumbline
