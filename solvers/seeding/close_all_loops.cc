#include "plumbline/solvers/seeding/close_all_loops.h"

#include <utility>
#include <vector>

#include "plumbline/solvers/hypotheses/hypothesis_search.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"
#include "plumbline/solvers/loop_closure/misplaced_scans.h"
#include "plumbline/solvers/seeding/seed_pose_graph.h"

namespace plumbline {

Status CloseAllLoops(const MotionOptions& motion, const ScanSurfaces& surfaces,
                     const SeedingProgress& progress, const KeyframeGraph* ties, ThreadPool* pool,
                     SequentialTrajectory* trajectory, KeyframeGraph* keys, SeedingReport* report) {
  MapHypothesis best;
  PLUMBLINE_RETURN_IF_ERROR(SearchMapHypotheses(motion, surfaces, progress, pool, *trajectory, ties,
                                                &best, &report->hypotheses));
  const std::vector<MisplacedScan> misplaced =
      FindMisplacedScans(surfaces, best.start->odometry, motion, best.world_from_robot, pool);
  for (const MisplacedScan& scan : misplaced) {
    best.world_from_robot[scan.pose] = scan.world_from_robot;
  }
  if (!misplaced.empty()) {
    best.consistency = MeasureMapConsistency(surfaces.graph(), best.world_from_robot, pool);
  }
  report->pose_graph = SeedPoseGraph(best.keys, *best.start, motion);
  // Between sessions things move.
  report->alarm = best.consistency.IsContradictory() || best.loops.IsUnresolved() ||
                  (ties == nullptr && best.consistency.PassesDisagree());
  report->loops = std::move(best.loops);
  report->consistency = std::move(best.consistency);
  report->sequential_poses = best.start->world_from_robot;
  *keys = std::move(best.keys);
  trajectory->world_from_robot = std::move(best.world_from_robot);
  return Status::Ok();
}

}  // namespace plumbline
