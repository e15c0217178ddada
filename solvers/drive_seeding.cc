#include "plumbline/solvers/drive_seeding.h"

#include <algorithm>
#include <utility>

#include "plumbline/core/map_state.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"

namespace plumbline {
namespace {

// A calibration would move the frame of the robot. The host names poses that may not be there yet,
// and expects its callback from Finish.
MapLogOptions OptionsWhileDriving(const MapLogOptions& options, const SeedingProgress& progress) {
  MapLogOptions driving = options;
  driving.calibration = CalibrationOptions();
  FactorOptions& factors = driving.solver.factors;
  factors.downweighted_steps.clear();
  factors.ignored_relative_poses.clear();
  driving.solver.callback = [progress](const IterationSummary&) {
    return progress(SeedingPhase::kClosingLoops, 0, 0);
  };
  return driving;
}

// Conflicting returns beyond the usual share of those compared, as the posterior of the seeding
// weighs scans (posterior.h).
double ScanEnergy(const MapConsistency& map, double usual_share) {
  const FreeSpaceConflict all = map.AllConflicts();
  return all.num_conflicting - usual_share * all.num_compared;
}

bool IsBetter(const LogMapping& mapping, const std::vector<Pose2>& poses_at_hand,
              ThreadPool* pool) {
  if (mapping.report.alarms.empty()) return true;
  const MapConsistency& map = mapping.report.consistency;
  const MapConsistency at_hand = MeasureMapConsistency(mapping.graph, poses_at_hand, pool);
  const double usual_share = std::min(map.UsualShare(), at_hand.UsualShare());
  return ScanEnergy(map, usual_share) <= ScanEnergy(at_hand, usual_share);
}

}  // namespace

Status SeedDriveSoFar(const MapLogOptions& given, const SeedingProgress& progress,
                      DriveSeeding* seeding) {
  const MapLogOptions options = OptionsWhileDriving(given, progress);
  ThreadPool pool(options.solver.num_threads);
  LogMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, std::move(seeding->log), &pool, &mapping));
  PLUMBLINE_RETURN_IF_ERROR(SeedDrive(options.seeding, options.solver.factors.motion,
                                      mapping.surface, progress, &pool, mapping.graph,
                                      &seeding->drive, &seeding->report));
  PLUMBLINE_RETURN_IF_ERROR(StartFromSeed(options, PoseArray(seeding->drive.world_from_robot),
                                          seeding->report, &mapping));
  PLUMBLINE_RETURN_IF_ERROR(RefineLog(options, &pool, &mapping));
  seeding->drive.world_from_robot = PosesOf(mapping.state.poses);
  seeding->is_better = IsBetter(mapping, seeding->poses_at_hand, &pool);
  seeding->alarms = std::move(mapping.report.alarms);
  return Status::Ok();
}

OdometryFaults FaultsOf(const SeedingReport& report) {
  OdometryFaults faults;
  faults.sign_lost = report.sequential.odometry_sign.sign_lost;
  const OdometryNoiseReport& noise = report.odometry_noise;
  const bool is_given_pose = noise.given_poses.position_m > 0.0;
  faults.translation_scale = is_given_pose ? 0.0 : noise.gross_translation_scale;
  return faults;
}

}  // namespace plumbline
