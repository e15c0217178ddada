#ifndef PLUMBLINE_SOLVERS_FRONT_END_PAIRWISE_ICP_H_
#define PLUMBLINE_SOLVERS_FRONT_END_PAIRWISE_ICP_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

/// What ICP makes small.
enum class IcpMetric {
  kPointToPoint,  ///< distance of matched points; Besl & McKay: Registration of 3-D shapes (1992)
  kPointToLine,   ///< distance from the matched point's tangent; Chen & Medioni (1991)
};

/// The classic baseline: each scan is matched against the one before it, without a local map and
/// without weight on the odometry. Scans are thinned as for the seeding: both metrics then weigh
/// surfaces by their length, not by how near they are to the laser.
struct PairwiseIcpOptions {
  IcpMetric metric = IcpMetric::kPointToLine;
  /// Farthest correspondence [m] in the first iterations: what the guess may be off by, a turn's
  /// effect on far points included.
  double gate_m = 1.0;
  /// Farthest correspondence [m] in the last iterations: noise, and what one scan does not see of
  /// the other.
  double fine_gate_m = 0.12;
  /// Standard deviation [m] of a point across its surface, for the covariance and for the weights
  /// of point-to-line.
  double sigma_m = 0.03;

  bool Check(std::string* error) const;
};

/// The options that suit the noise of a laser: both points of a correspondence are noisy, and the
/// gate has to let three standard deviations of that through.
PairwiseIcpOptions IcpOptionsFor(const RangeBeamOptions& beam, IcpMetric metric);

/// Below this share of matched points a match of two scans has failed, and the odometry stands.
constexpr double kMinPairInlierRatio = 0.4;

struct PairMatch {
  Pose2 from_from_to;
  /// Order x, y [m], yaw [rad] in the frame of `from`, by the matched surfaces' normals for both
  /// metrics: large along a bare corridor.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double inlier_ratio = 0.0;  ///< share of the points of `to` within the fine gate of `from`
  bool converged = false;
};

/// Moves scan `to` onto scan `from`, starting at `guess`. Correspondences are nearest points whose
/// normals are within 45 degrees of each other, within a gate that narrows as the match settles.
/// Point-to-point takes the best rigid motion of the matched points at each iteration;
/// point-to-line is MatchScan without a prior, robust. Where the scans say nothing, and with an
/// empty scan, the guess stands.
PairMatch MatchPair(const SurfacePoints& from, const SurfacePoints& to, const Pose2& guess,
                    const PairwiseIcpOptions& options);

/// Puts every pose at the chain of its matches, each started from the odometry, and the points with
/// them; the first pose is at its initial guess. A pose is matched to the last one before it that
/// shows a surface. Expects poses in order of time, joined by odometry from each to the next. Lost
/// signs of the odometry's translation are not recognised. The result does not depend on the number
/// of threads. surface: as MeasureSurface gives it. InvalidArgument on bad options, missing
/// odometry or a wrong number of normals; *state is then as it was.
Status ChainPairs(const PairwiseIcpOptions& options, const MeasuredSurface& surface,
                  ThreadPool* pool, const SlamGraph& graph, MapState* state);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_PAIRWISE_ICP_H_
