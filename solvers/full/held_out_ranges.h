#ifndef PLUMBLINE_SOLVERS_FULL_HELD_OUT_RANGES_H_
#define PLUMBLINE_SOLVERS_FULL_HELD_OUT_RANGES_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

/// How well a map predicts ranges that it was not made of. A held-out return (HeldOutReturns) whose
/// neighbours in the scan lie on the same surface is predicted from the map points of these: its
/// beam is intersected with the line through them. A map of noisy points predicts badly, one that
/// smoothing has bent does, too; distances from tangent lines would not tell, for a thick map has a
/// line near every point.
class HeldOutRanges {
 public:
  /// Keeps a reference to the graph. sigma_range_m: of a reading [m].
  HeldOutRanges(const SlamGraph& graph, double sigma_range_m, ThreadPool* pool);

  std::size_t size() const { return ranges_.size(); }

  /// Mean absolute error of the predictions in standard deviations of a reading; 0 without any. A
  /// perfect map comes to sqrt(2 / pi) = 0.80, one of raw returns to sqrt(3 / pi) = 0.98.
  double MeanError(const MapState& state) const;

 private:
  struct Range {
    int scan;
    std::size_t before, after;  // return ids of its neighbours
    double range_m;             // as measured
    double share_after;         // of the angle between its neighbours
  };

  const SlamGraph& graph_;
  double sigma_range_m_;
  std::vector<Range> ranges_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_HELD_OUT_RANGES_H_
