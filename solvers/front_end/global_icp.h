#ifndef PLUMBLINE_SOLVERS_FRONT_END_GLOBAL_ICP_H_
#define PLUMBLINE_SOLVERS_FRONT_END_GLOBAL_ICP_H_

#include <string>

#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/pairwise_icp.h"

namespace plumbline {

/// One ICP over all scans of a drive.
struct GlobalIcpOptions {
  /// How two scans are matched. Its gate is what two poses of one place may be off to begin with.
  PairwiseIcpOptions icp;
  /// Scans are matched with others that were taken this close by [m]: they see the same walls, but
  /// for rooms next door.
  double reach_m = 5.0;
  /// Most scans that one is matched with; the first and the last near by are among them. From 1 to
  /// 1000.
  int max_partners = 8;
  /// A match closes a loop if this share of the one scan's points lies on the other.
  double min_inlier_ratio = 0.5;
  /// Better poses let more scans find each other: rounds of matching, at most.
  int max_rounds = 10;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// The options that suit the noise of a laser, see IcpOptionsFor.
GlobalIcpOptions GlobalIcpOptionsFor(const RangeBeamOptions& beam, IcpMetric metric);

/// Moves the poses of *state, which are the start, to where every scan fits all scans that see the
/// same place; its points with them. Pose 0 stays. Keyframes, a metre apart, are matched with each
/// other pair by pair (MatchPair), and a robust graph of these matches moves them, in rounds; the
/// scans in between ride along. Then all scans move jointly, by the matched points of all pairs
/// that the graph agrees with (AlignJointly); scans in between are matched to the keyframes before
/// and after them.
///
/// For starts whose loops are off by less than the reach of a match, as a chain of matches is on a
/// floor of a building. Unlike the seeding it has no search beyond that, no use of free space, and
/// no alarm. Source: Lu, Milios: Globally consistent range scan alignment for environment mapping
/// (1997); the robust graph is of later date, see robust_pose_graph.h.
///
/// The result does not depend on the number of threads. surface: as MeasureSurface gives it.
/// InvalidArgument on bad options or a wrong number of normals; *state is then as it was.
Status AlignScansGlobally(const GlobalIcpOptions& options, const MotionOptions& motion,
                          const MeasuredSurface& surface, ThreadPool* pool, const SlamGraph& graph,
                          MapState* state);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_GLOBAL_ICP_H_
