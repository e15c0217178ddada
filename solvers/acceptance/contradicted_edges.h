#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_EDGES_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_EDGES_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/front_end/pairwise_icp.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/interface/acceptance.h"

namespace plumbline {

/// A relative pose that the scans of its two poses contradict.
struct ContradictedEdge {
  std::size_t edge = 0;  ///< index into SlamGraph::relative_poses()
  /// What the scans say in its place, if they fit each other well somewhere near.
  std::optional<RelativePoseConstraint> match;
};

/// Finds the relative poses that their own scans contradict, wherever the poses of the graph are:
///
/// - the two scans match each other, beginning at the edge, and the match is off it by more than
///   both covariances explain (chi-squared above its 99.9 % quantile), or
/// - at the edge, one side shows surfaces where the other looked through: more than loop closure
///   lets pass (LoopAcceptance::kMaxFreeSpaceConflict), and more than three times what is usual
///   from one scan to the next, as in a crowd. Each side is three scans, a metre of path apart: two
///   corridors look alike in a single one. Between consecutive poses this counts only if there is a
///   match in the edge's place, since something has to hold the drive together.
///
/// A match has to have loop closure's share of inliers and no such conflict. Edges whose scans have
/// too little in common, or of poses without scans, are not contradicted. In order of the edges;
/// the result does not depend on the number of threads. Collective for a shared graph.
std::vector<ContradictedEdge> FindContradictedEdges(const SlamGraph& graph,
                                                    const MeasuredSurface& surface,
                                                    const RangeBeamOptions& beam, ThreadPool* pool);

/// Finds the contradicted edges of a graph that grows. Edges are tested when they come, and those
/// of the newest poses again when what lies beyond these has been seen.
class EdgeTests {
 public:
  explicit EdgeTests(const RangeBeamOptions& beam);

  /// Takes in what the graph has gained since the last call. surface: of the graph.
  void Extend(const SlamGraph& graph, const MeasuredSurface& surface, ThreadPool* pool);

  /// Depends on all edges so far, by the usual conflict between scans.
  std::vector<ContradictedEdge> Contradicted(const SlamGraph& graph) const;

  /// Whether both poses of an edge have scans that match each other nowhere near it: these say
  /// nothing for the edge, contradicted or not.
  bool LacksMatch(const SlamGraph& graph, std::size_t edge) const {
    const RelativePoseConstraint& constraint = graph.relative_poses()[edge];
    return HaveScans(constraint) && !MatchOf(constraint, evidence_[edge]);
  }

 private:
  // A scan, and where it was taken as seen from a pose near by.
  struct Beside {
    int scan = 0;
    Pose2 pose_from_scan;
  };
  // What the scans say of an edge; without scans, nothing.
  struct Evidence {
    PairMatch match;
    FreeSpaceConflict at_edge, at_match;
  };

  std::vector<Evidence> Test(const ScanSurfaces& surfaces,
                             const std::vector<RelativePoseConstraint>& edges,
                             ThreadPool* pool) const;
  Evidence Test(const ScanSurfaces& surfaces, const RelativePoseConstraint& edge) const;
  bool HaveScans(const RelativePoseConstraint& edge) const {
    return scan_of_pose_[edge.from] >= 0 && scan_of_pose_[edge.to] >= 0;
  }
  std::vector<Beside> ScansBeside(int pose, bool alone) const;
  std::optional<Beside> FindBeside(int pose, int direction) const;
  void TestOthers(const ScanSurfaces& surfaces, std::vector<std::size_t> to_test, ThreadPool* pool);
  bool IsNearTheEnd(int pose) const;
  void TakeSteps(const std::vector<RelativePoseConstraint>& steps,
                 const std::vector<Evidence>& evidence);
  bool IsContradictory(const FreeSpaceConflict& conflict) const;
  bool IsContradicted(const RelativePoseConstraint& edge,
                      const std::optional<RelativePoseConstraint>& match,
                      const Evidence& seen) const;
  std::optional<RelativePoseConstraint> MatchOf(const RelativePoseConstraint& edge,
                                                const Evidence& seen) const;

  const PairwiseIcpOptions icp_;
  std::vector<int> scan_of_pose_;
  std::vector<std::optional<Pose2>> step_to_;  // per pose, from the one before
  std::size_t num_odometry_ = 0;               // that have been tested
  std::vector<Evidence> evidence_;             // per relative pose
  std::vector<std::size_t> waiting_;           // relative poses that are to be tested again
  std::vector<double> usual_shares_;           // of conflicting returns, per step
  double max_conflict_;
};

/// Describes a relative pose for a summary. poses: (x, y, yaw) each.
IgnoredEdge DescribeEdge(std::size_t index, const SlamGraph& graph,
                         const std::vector<double>& poses);

/// The same for contradicted edges.
std::vector<IgnoredEdge> DescribeIgnored(const std::vector<ContradictedEdge>& contradicted,
                                         const SlamGraph& graph, const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_EDGES_H_
