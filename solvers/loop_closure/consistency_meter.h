#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_CONSISTENCY_METER_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_CONSISTENCY_METER_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// Compares scans every half metre of the path with a bounded number of others: of the same pass
/// (1 m to 5 m of path away), and of other passes (at least 8 m of path and at most about 4 m of
/// distance away). The work is linear in the length of the path. Expects poses in order of time.
///
/// The constructor chooses the scans and finds the moving returns by one estimate of the poses;
/// Measure then takes any estimate of the same drive. Const, so that several threads can measure at
/// a time; but constructor and Measure are collective if the graph has peers. The result does not
/// depend on the number of threads.
class ConsistencyMeter {
 public:
  /// world_from_robot: one finite pose per pose of the graph, which must outlive the meter.
  ConsistencyMeter(const SlamGraph& graph, const std::vector<Pose2>& world_from_robot,
                   ThreadPool* pool);

  MapConsistency Measure(const std::vector<Pose2>& world_from_robot, ThreadPool* pool) const;

  /// Measures several maps, one per thread; processes measure each map together.
  std::vector<MapConsistency> MeasureEach(const std::vector<std::vector<Pose2>>& maps,
                                          ThreadPool* pool) const;

 private:
  const SlamGraph& graph_;
  std::vector<int> scans_;                                // by their ids among all
  std::vector<std::optional<FreeSpaceScan>> free_space_;  // of those that the graph has
  std::vector<std::vector<int>> moving_;                  // returns of each
};

/// Measures one estimate of the poses.
MapConsistency MeasureMapConsistency(const SlamGraph& graph,
                                     const std::vector<Pose2>& world_from_robot, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_CONSISTENCY_METER_H_
