#include "plumbline/solvers/acceptance/contradicted_edges.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"
#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/front_end/pairwise_icp.h"
#include "plumbline/solvers/front_end/surface_points.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"

namespace plumbline {
namespace {

constexpr double kMaxChi2 = 16.3;
constexpr double kUsualFactor = 3.0;
// Of returns that both sides must have seen, fewer say nothing.
constexpr int kFewestCompared = 50;
// How far along the path the scans beside one are taken [m], and at most.
constexpr double kBesideM = 1.0, kFarthestM = 5.0;
constexpr std::size_t kEdgesPerChunk = 16;

bool IsStep(int from, int to) { return std::abs(from - to) == 1; }
bool IsStep(const RelativePoseConstraint& edge) { return IsStep(edge.from, edge.to); }

// In the frame of `from`.
Eigen::Vector3d ErrorOf(const Pose2& measured, const Pose2& actual) {
  return {actual.x - measured.x, actual.y - measured.y, NormalizeAngle(actual.yaw - measured.yaw)};
}

double Chi2(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

// A scan, and where it was taken as seen from a pose near by.
struct Beside {
  int scan = 0;
  Pose2 pose_from_scan;
};

// What the scans say of an edge; without scans, nothing.
struct EdgeEvidence {
  PairMatch match;
  FreeSpaceConflict at_edge, at_match;
};

class EdgeTester {
 public:
  EdgeTester(const SlamGraph& graph, const MeasuredSurface& surface, const RangeBeamOptions& beam,
             ThreadPool* pool)
      : graph_(graph),
        icp_(IcpOptionsFor(beam, IcpMetric::kPointToLine)),
        surfaces_(ThinnedSurfacePoints(graph, surface.normals, kPointSpacingM, pool)),
        scan_of_pose_(MatchedScanOfPoses(graph, surfaces_)),
        step_to_(graph.num_poses()),
        pool_(pool) {}

  std::vector<ContradictedEdge> Run() {
    // The steps first: they tell how the scans beside each other lie, and what is usual.
    std::vector<RelativePoseConstraint> odometry;
    for (const OdometryConstraint& c : graph_.odometry()) {
      if (IsStep(c.from, c.to)) odometry.push_back({c.from, c.to, c.from_from_to});
    }
    const std::vector<RelativePoseConstraint>& edges = graph_.relative_poses();
    std::vector<EdgeEvidence> of_odometry(odometry.size()), evidence(edges.size());
    Test(odometry, true, &of_odometry);
    Test(edges, true, &evidence);
    SetUsualConflict(of_odometry, evidence);
    TakeSteps(odometry, of_odometry);
    TakeSteps(edges, evidence);
    Test(edges, false, &evidence);
    std::vector<ContradictedEdge> contradicted;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const std::optional<RelativePoseConstraint> match = MatchOf(edges[i], evidence[i]);
      if (IsContradicted(edges[i], match, evidence[i])) contradicted.push_back({i, match});
    }
    return contradicted;
  }

 private:
  // Either the steps from pose to pose, or the other edges.
  void Test(const std::vector<RelativePoseConstraint>& edges, bool steps,
            std::vector<EdgeEvidence>* evidence) const {
    pool_->ForEachChunk(edges.size(), kEdgesPerChunk,
                        [&](std::size_t, std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i) {
                            if (IsStep(edges[i]) == steps) (*evidence)[i] = Test(edges[i]);
                          }
                        });
  }

  EdgeEvidence Test(const RelativePoseConstraint& edge) const {
    EdgeEvidence seen;
    const int from = scan_of_pose_[edge.from], to = scan_of_pose_[edge.to];
    if (from < 0 || to < 0) return seen;
    seen.match = MatchPair(surfaces_[from], surfaces_[to], edge.from_from_to, icp_);
    const std::vector<Beside> scans_a = ScansOf(edge.from, IsStep(edge)),
                              scans_b = ScansOf(edge.to, IsStep(edge));
    const std::vector<FreeSpaceScan> free_a = FreeSpaceOf(scans_a), free_b = FreeSpaceOf(scans_b);
    for (std::size_t a = 0; a < scans_a.size(); ++a) {
      const Pose2 a_from_from = scans_a[a].pose_from_scan.Inverse();
      for (std::size_t b = 0; b < scans_b.size(); ++b) {
        const Pose2& to_from_b = scans_b[b].pose_from_scan;
        seen.at_edge +=
            CompareBothWays(free_a[a], free_b[b], a_from_from * edge.from_from_to * to_from_b);
        seen.at_match += CompareBothWays(free_a[a], free_b[b],
                                         a_from_from * seen.match.from_from_to * to_from_b);
      }
    }
    return seen;
  }

  // The scan of a pose, alone or with the first ones a metre of path before and after it.
  std::vector<Beside> ScansOf(int pose, bool alone) const {
    std::vector<Beside> scans = {{scan_of_pose_[pose], Pose2()}};
    if (alone) return scans;
    for (const int direction : {-1, 1}) {
      if (const std::optional<Beside> beside = FindBeside(pose, direction)) {
        scans.push_back(*beside);
      }
    }
    return scans;
  }

  std::optional<Beside> FindBeside(int pose, int direction) const {
    Beside beside;
    double path_m = 0.0;
    for (int other = pose + direction; other >= 0 && other < graph_.num_poses();
         other += direction) {
      const std::optional<Pose2>& step = step_to_[std::max(other, other - direction)];
      if (!step) return std::nullopt;
      beside.pose_from_scan = beside.pose_from_scan * (direction > 0 ? *step : step->Inverse());
      path_m += std::hypot(step->x, step->y);
      if (path_m > kFarthestM) return std::nullopt;
      beside.scan = scan_of_pose_[other];
      if (path_m >= kBesideM && beside.scan >= 0) return beside;
    }
    return std::nullopt;
  }

  std::vector<FreeSpaceScan> FreeSpaceOf(const std::vector<Beside>& scans) const {
    std::vector<FreeSpaceScan> free_space;
    free_space.reserve(scans.size());
    for (const Beside& one : scans) free_space.emplace_back(graph_, one.scan);
    return free_space;
  }

  // From the median of the steps.
  void SetUsualConflict(const std::vector<EdgeEvidence>& of_odometry,
                        const std::vector<EdgeEvidence>& of_edges) {
    std::vector<double> shares;
    for (const std::vector<EdgeEvidence>* all : {&of_odometry, &of_edges}) {
      for (const EdgeEvidence& seen : *all) {
        if (IsEnough(seen.at_match)) shares.push_back(seen.at_match.Share());
      }
    }
    if (shares.empty()) return;
    max_conflict_ = std::max(max_conflict_, kUsualFactor * Median(std::move(shares)));
  }

  // How consecutive scans lie: by their match, or else by the edge.
  void TakeSteps(const std::vector<RelativePoseConstraint>& edges,
                 const std::vector<EdgeEvidence>& evidence) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!IsStep(edges[i])) continue;
      const RelativePoseConstraint step = MatchOf(edges[i], evidence[i]).value_or(edges[i]);
      step_to_[std::max(step.from, step.to)] =
          step.from < step.to ? step.from_from_to : step.from_from_to.Inverse();
    }
  }

  static bool IsEnough(const FreeSpaceConflict& conflict) {
    return conflict.num_compared >= kFewestCompared;
  }
  bool IsContradictory(const FreeSpaceConflict& conflict) const {
    return IsEnough(conflict) && conflict.Share() > max_conflict_;
  }

  std::optional<RelativePoseConstraint> MatchOf(const RelativePoseConstraint& edge,
                                                const EdgeEvidence& seen) const {
    if (seen.match.inlier_ratio < LoopAcceptance::kMinInlierRatio ||
        IsContradictory(seen.at_match)) {
      return std::nullopt;
    }
    return RelativePoseConstraint{edge.from, edge.to, seen.match.from_from_to,
                                  seen.match.covariance};
  }

  bool IsContradicted(const RelativePoseConstraint& edge,
                      const std::optional<RelativePoseConstraint>& match,
                      const EdgeEvidence& seen) const {
    if (match && Chi2(ErrorOf(edge.from_from_to, match->from_from_to),
                      edge.covariance + match->covariance) > kMaxChi2) {
      return true;
    }
    return IsContradictory(seen.at_edge) && (match || !IsStep(edge));
  }

  const SlamGraph& graph_;
  const PairwiseIcpOptions icp_;
  const std::vector<SurfacePoints> surfaces_;  // per scan
  const std::vector<int> scan_of_pose_;
  std::vector<std::optional<Pose2>> step_to_;  // per pose, from the one before
  double max_conflict_ = LoopAcceptance::kMaxFreeSpaceConflict;
  ThreadPool* pool_;
};

}  // namespace

std::vector<ContradictedEdge> FindContradictedEdges(const SlamGraph& graph,
                                                    const MeasuredSurface& surface,
                                                    const RangeBeamOptions& beam,
                                                    ThreadPool* pool) {
  return EdgeTester(graph, surface, beam, pool).Run();
}

std::vector<IgnoredEdge> DescribeIgnored(const std::vector<ContradictedEdge>& contradicted,
                                         const SlamGraph& graph, const std::vector<double>& poses) {
  std::vector<IgnoredEdge> ignored;
  for (const ContradictedEdge& c : contradicted) {
    const RelativePoseConstraint& edge = graph.relative_poses()[c.edge];
    const Eigen::Vector3d error = ErrorOf(
        edge.from_from_to, Between(Pose2(&poses[3 * edge.from]), Pose2(&poses[3 * edge.to])));
    ignored.push_back({c.edge, edge.from, edge.to, error.head<2>().norm(), std::abs(error.z()),
                       std::sqrt(Chi2(error, edge.covariance))});
  }
  return ignored;
}

}  // namespace plumbline
