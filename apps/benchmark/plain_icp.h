#ifndef PLUMBLINE_APPS_BENCHMARK_PLAIN_ICP_H_
#define PLUMBLINE_APPS_BENCHMARK_PLAIN_ICP_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/point_index.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Iterative closest point as published, without the refinements of MatchPair: point to point over
/// all returns of two scans. Source: Besl, McKay: A method for registration of 3-D shapes (1992);
/// the gate, which partial overlap needs: Zhang: Iterative point matching for registration of
/// free-form curves and surfaces (1994), there adaptive, here fixed.
struct PlainIcpOptions {
  /// Farthest correspondence [m], in all iterations: bounds the error of the guess that can be
  /// corrected, and how far returns on surfaces that only one scan sees pull.
  double gate_m = 1.8;
};

struct PlainMatch {
  Pose2 from_from_to;  ///< pose of the robot at `to` in its frame at `from`
  /// Of the least-squares fit of the matched points, as if these were independent: order x, y [m],
  /// yaw [rad] in the frame of `from`. Source: Lu, Milios: Globally consistent range scan alignment
  /// for environment mapping (1997).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double matched_ratio = 0.0;  ///< share of the returns of `to` within the gate of `from`
  bool converged = false;
};

/// The returns of all scans of a drive, ready to be matched.
class PlainIcp {
 public:
  /// graph: one scan per pose; poses in order of time, joined by odometry from each to the next.
  explicit PlainIcp(const SlamGraph& graph);

  const SlamGraph& graph() const { return graph_; }

  /// Moves scan `to` onto scan `from`, starting at `guess`, a pose like PlainMatch::from_from_to,
  /// until an iteration moves no return by more than 0.1 mm; not converged after 100 iterations.
  /// With fewer than three correspondences the guess stands, not converged, with a covariance of
  /// 1 m^2 and 1 rad^2.
  PlainMatch Match(int from, int to, const Pose2& guess, const PlainIcpOptions& options) const;

  /// Each scan against the one before it, starting at the odometry.
  std::vector<RelativePoseConstraint> MatchConsecutive(const PlainIcpOptions& options) const;

 private:
  struct Scan {
    Eigen::Matrix2Xd points;  // in the frame of the robot [m]
    PointIndex index;
    double reach_m = 0.0;  // distance of the farthest point
  };

  const SlamGraph& graph_;
  std::vector<Scan> scans_;
};

/// Chains edges between consecutive poses, the first pose at its initial guess.
std::vector<Pose2> ChainEdges(const SlamGraph& graph,
                              const std::vector<RelativePoseConstraint>& consecutive);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_PLAIN_ICP_H_
