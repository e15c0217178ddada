#include "plumbline/solvers/map_log.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/sweep_motion.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/acceptance/contradicted_steps.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/front_end/frozen_laser.h"
#include "plumbline/solvers/front_end/global_icp.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/odometry_noise.h"
#include "plumbline/solvers/front_end/pairwise_icp.h"
#include "plumbline/solvers/front_end/range_noise.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"
#include "plumbline/solvers/loop_closure/misplaced_scans.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/seeding/seed_drive.h"
#include "plumbline/solvers/sweep_order.h"
#include "plumbline/solvers/terms/align_to_factors.h"

namespace plumbline {
namespace {

// Places every return of a sweep by the pose at its own time.
void FollowSweeps(const std::vector<double>& poses, LogMapping* mapping) {
  mapping->graph =
      std::move(mapping->graph)
          .Corrected(TakeOutSweepMotion(*mapping->as_swept, *mapping->report.sweep_order, poses));
}

// The poses of the calibrated robot that leave its lasers where they were.
std::vector<double> Carried(const std::vector<double>& poses, const Pose2& before_from_after) {
  std::vector<Pose2> carried = PosesOf(poses);
  for (Pose2& pose : carried) pose = pose * before_from_after;
  return PoseArray(carried);
}

void MeasureMissingSurface(const MapLogOptions& options, ThreadPool* pool, LogMapping* mapping) {
  if (mapping->surface.normals.size() == mapping->graph.num_returns()) return;
  MeasureSurfaceOf(options, pool, mapping);
}

void Calibrate(const MapLogOptions& options, const SolverOptions& solver, LogMapping* mapping) {
  Calibration& calibration = mapping->report.calibration;
  mapping->surface = MeasuredSurface();  // of the sensors as they were given
  mapping->report.solver = SolveWithCalibration(solver, options.calibration, mapping->graph,
                                                &mapping->state, &calibration);
  if (!mapping->report.solver.IsSolutionUsable()) return;
  const Pose2 mounting = mapping->graph.laser(0).robot_from_laser;
  mapping->graph = std::move(mapping->graph).Corrected(calibration.corrections);
  calibration.corrections = MeasurementCorrections();  // the graph has them, and they are large
  mapping->before_from_after = mounting * mapping->graph.laser(0).robot_from_laser.Inverse();
  mapping->start_poses = Carried(mapping->start_poses, mapping->before_from_after);
}

std::vector<MisplacedScan> FindMisplaced(const MotionOptions& motion, ThreadPool* pool,
                                         const LogMapping& mapping,
                                         const std::vector<double>& state_poses) {
  const std::vector<Pose2> poses = PosesOf(state_poses);
  std::vector<Pose2> odometry(poses.size());
  // Between sessions there is none: nothing is odd there.
  for (std::size_t p = 1; p < poses.size(); ++p) odometry[p] = Between(poses[p - 1], poses[p]);
  for (const OdometryConstraint& step : mapping.graph.odometry()) {
    if (step.to == step.from + 1) odometry[step.to] = step.from_from_to;
  }
  return FindMisplacedScans(ScanSurfaces(mapping.graph, mapping.surface), odometry, motion, poses,
                            pool);
}

// Begins the estimation again where scans lie beside where they fit, and keeps what it finds if
// fewer do then. Gives the poses that still do.
std::vector<int> PutScansWhereTheyFit(const SolverOptions& solver, ThreadPool* pool,
                                      LogMapping* mapping) {
  const auto find = [&](const std::vector<double>& poses) {
    return FindMisplaced(solver.factors.motion, pool, *mapping, poses);
  };
  const auto poses_of = [](const std::vector<MisplacedScan>& scans) {
    std::vector<int> poses(scans.size());
    std::transform(scans.begin(), scans.end(), poses.begin(),
                   [](const MisplacedScan& scan) { return scan.pose; });
    return poses;
  };
  const std::vector<MisplacedScan> before = find(mapping->state.poses);
  if (before.empty()) return {};
  std::vector<Pose2> poses = PosesOf(mapping->state.poses);
  for (const MisplacedScan& scan : before) poses[scan.pose] = scan.world_from_robot;
  MapState state{PoseArray(poses), {}};
  SolverSummary summary = RefineState(solver, mapping->surface, mapping->graph, &state);
  if (!summary.IsSolutionUsable()) return poses_of(before);
  const std::vector<MisplacedScan> after = find(state.poses);
  if (after.size() >= before.size()) return poses_of(before);
  const SolverSummary& first = mapping->report.solver;
  summary.association_time_s += first.association_time_s;
  summary.setup_time_s += first.setup_time_s;
  summary.solve_time_s += first.solve_time_s;
  summary.total_time_s += first.total_time_s;
  mapping->state = std::move(state);
  mapping->report.solver = std::move(summary);
  mapping->report.misplaced_poses = poses_of(before);
  return poses_of(after);
}

// Share of the returns with a normal; 1 if no normals were measured. Collective if processes share
// the graph.
double SurfaceShare(const SlamGraph& graph, const MeasuredSurface& surface) {
  std::vector<double> counts = {static_cast<double>(std::count_if(
                                    surface.normals.begin(), surface.normals.end(),
                                    [](const ReturnNormal& normal) { return !normal.IsNone(); })),
                                static_cast<double>(surface.normals.size())};
  SumOverPeers(graph.peers(), &counts);
  return counts[1] > 0.0 ? counts[0] / counts[1] : 1.0;
}

// The poses of the odometry, of a chain of scan matches, or of one ICP over all scans.
Status FindPlainStart(const MapLogOptions& options, const SeedingProgress& progress,
                      ThreadPool* pool, const LogMapping& mapping, std::vector<double>* poses) {
  const auto goes_on = [&] { return !progress || progress(SeedingPhase::kMatchingScans, 0, 0); };
  if (!goes_on()) return Status::Unavailable("seeding was stopped by its caller");
  const bool lacks_odometry = LacksOdometry(mapping.graph);
  if (options.start == StartType::kOdometry) {
    if (lacks_odometry) {
      return Status::InvalidArgument("the start is that of the odometry, but the log has none");
    }
    *poses = mapping.graph.initial_poses();
    return Status::Ok();
  }
  const IcpMetric metric =
      options.start == StartType::kIcp ? IcpMetric::kPointToPoint : IcpMetric::kPointToLine;
  SlamGraph with_steps;
  if (lacks_odometry) {
    with_steps = mapping.graph;
    PLUMBLINE_RETURN_IF_ERROR(AddPredictedSteps(PosesOf(with_steps.initial_poses()), &with_steps));
  }
  const SlamGraph& graph = lacks_odometry ? with_steps : mapping.graph;
  MapState chain;
  PLUMBLINE_RETURN_IF_ERROR(ChainPairs(IcpOptionsFor(BeamNoise(options, mapping.report), metric),
                                       mapping.surface, pool, graph, &chain));
  if (options.start == StartType::kIcpGlobal) {
    if (!goes_on()) return Status::Unavailable("seeding was stopped by its caller");
    const RangeBeamOptions beam = BeamNoise(options, mapping.report);
    PLUMBLINE_RETURN_IF_ERROR(AlignScansGlobally(GlobalIcpOptionsFor(beam, metric),
                                                 options.solver.factors.motion, mapping.surface,
                                                 pool, graph, &chain));
  }
  *poses = std::move(chain.poses);
  return goes_on() ? Status::Ok() : Status::Unavailable("seeding was stopped by its caller");
}

SeedingReport ReportOfPlainStart(const MotionOptions& motion, const SlamGraph& graph,
                                 const std::vector<double>& poses, ThreadPool* pool) {
  SeedingReport report;
  report.sequential_poses = PosesOf(poses);
  report.consistency = MeasureMapConsistency(graph, report.sequential_poses, pool);
  for (const OdometryConstraint& step : graph.odometry()) {
    report.corrections.odometry.push_back(step.from_from_to);
  }
  if (LacksOdometry(graph)) {
    report.odometry_noise = MeasurePredictionNoise(graph, report.sequential_poses, motion);
  }
  return report;
}

Status CheckSize(const char* name, std::size_t size, std::size_t expected) {
  if (size == expected) return Status::Ok();
  return Status::InvalidArgument("the seed has " + std::to_string(size) + " " + name +
                                 ", but the log needs " + std::to_string(expected));
}

Status SeedLogTogether(const MapLogOptions& options, const SeedingProgress& progress,
                       ThreadPool* pool, LogMapping* mapping) {
  if (!CanSeedTogether(options, *mapping)) {
    return Status::InvalidArgument("processes cannot seed such a log together");
  }
  MeasureMissingSurface(options, pool, mapping);
  SeedingReport seeding;
  std::vector<double> start_poses;
  {
    SeededDrive drive;
    PLUMBLINE_RETURN_IF_ERROR(SeedSharedDrive(options.seeding, options.solver.factors.motion,
                                              progress, pool, &mapping->graph, &mapping->surface,
                                              &drive, &seeding));
    start_poses = PoseArray(drive.world_from_robot);
  }
  ShareAnewByPlace(start_poses, &mapping->graph, &mapping->surface);
  return StartFromSeed(options, std::move(start_poses), std::move(seeding), mapping);
}

// The seed is in a frame of its own.
void AlignStart(LogMapping* mapping) {
  MapState start{std::move(mapping->start_poses), {}};
  AlignToFactors(mapping->graph, &start);
  mapping->start_poses = std::move(start.poses);
  AlignToFactors(mapping->graph, &mapping->state);
}

}  // namespace

bool MapLogOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(seeding);
  PLUMBLINE_CHECK_NESTED_OPTIONS(solver);
  if (!calibration.IsOn() || !solver.MovesPosesOnly()) return true;
  if (error != nullptr) {
    *error = "calibration does not go with the solver " + std::string(SolverOf(solver).name()) +
             ", which looks at no returns";
  }
  return false;
}

Status TakeLog(const MapLogOptions& options, SlamGraph graph, ThreadPool* pool,
               LogMapping* mapping) {
  return CatchExceptions([&] {
    std::string error;
    if (!options.Check(&error)) return Status::InvalidArgument(error);
    PLUMBLINE_RETURN_IF_ERROR(graph.status());
    if (LacksOdometry(graph) &&
        (options.calibration.laser_mounting || options.calibration.odometry_scale)) {
      return Status::InvalidArgument(
          "a calibration of the mounting or of the odometry needs odometry, but the log has none");
    }
    LogMapping prepared;
    prepared.graph = std::move(graph);
    DropRepeatedScans(&prepared.graph, &prepared.report.frozen_laser);
    prepared.report.range_noise_m = MeasureRangeNoise(prepared.graph);
    if (HasSweeps(prepared.graph)) {
      prepared.as_swept = prepared.graph;
      SolverOptions solver = options.solver;
      solver.factors.beam = BeamNoise(options, prepared.report);
      prepared.report.sweep_order = FindSweepOrder(options.seeding, solver, prepared.graph, pool);
      FollowSweeps(prepared.graph.initial_poses(), &prepared);
    }
    prepared.state.poses = prepared.graph.initial_poses();
    *mapping = std::move(prepared);
    return Status::Ok();
  });
}

Status PrepareLog(const MapLogOptions& options, SlamGraph graph, ThreadPool* pool,
                  LogMapping* mapping) {
  return CatchExceptions([&] {
    LogMapping prepared;
    PLUMBLINE_RETURN_IF_ERROR(TakeLog(options, std::move(graph), pool, &prepared));
    MeasureMissingSurface(options, pool, &prepared);
    *mapping = std::move(prepared);
    return Status::Ok();
  });
}

bool CanSeedTogether(const MapLogOptions& options, const LogMapping& mapping) {
  return options.start == StartType::kSeed && !options.solver.MovesPosesOnly() &&
         !mapping.as_swept && !LacksOdometry(mapping.graph);
}

Status SeedLog(const MapLogOptions& options, const SeedingProgress& progress, ThreadPool* pool,
               LogMapping* mapping) {
  return CatchExceptions([&] {
    const DefaultFloatEnvironment float_environment;
    if (mapping->graph.peers() != nullptr) {
      return SeedLogTogether(options, progress, pool, mapping);
    }
    SeedingReport seeding;
    std::vector<double> start_poses;
    const bool needs_pose_graph = options.solver.MovesPosesOnly();
    MeasureMissingSurface(options, pool, mapping);
    if (options.start == StartType::kSeed || needs_pose_graph) {
      SeededDrive drive;
      PLUMBLINE_RETURN_IF_ERROR(SeedDrive(options.seeding, options.solver.factors.motion,
                                          mapping->surface, progress, pool, mapping->graph, &drive,
                                          &seeding));
      // A solver of pose graphs has the work still to do that the seeding did by its own.
      start_poses = PoseArray(needs_pose_graph ? seeding.sequential_poses : drive.world_from_robot);
    }
    if (options.start != StartType::kSeed) {
      PLUMBLINE_RETURN_IF_ERROR(FindPlainStart(options, progress, pool, *mapping, &start_poses));
      if (!needs_pose_graph) {
        seeding =
            ReportOfPlainStart(options.solver.factors.motion, mapping->graph, start_poses, pool);
      }
      seeding.start = options.start;
    }
    return StartFromSeed(options, std::move(start_poses), std::move(seeding), mapping);
  });
}

Status StartFromSeed(const MapLogOptions& options, std::vector<double> start_poses,
                     SeedingReport seeding, LogMapping* mapping) {
  return CatchExceptions([&] {
    PLUMBLINE_RETURN_IF_ERROR(CheckSize("coordinates of poses", start_poses.size(),
                                        mapping->graph.initial_poses().size()));
    PLUMBLINE_RETURN_IF_ERROR(CheckSize("odometry constraints", seeding.corrections.odometry.size(),
                                        mapping->graph.odometry().size()));
    if (options.solver.MovesPosesOnly()) {
      SlamGraph with_edges = mapping->graph;
      for (const RelativePoseConstraint& edge : seeding.pose_graph) {
        with_edges.AddRelativePose(edge);
      }
      PLUMBLINE_RETURN_IF_ERROR(with_edges.status());
      mapping->graph = std::move(with_edges);
    }
    mapping->graph = std::move(mapping->graph).Corrected(seeding.corrections);
    if (!seeding.corrections.moving_returns.empty()) {
      DropMovingNormals(mapping->graph, &mapping->surface.normals);
    }
    if (LacksOdometry(mapping->graph)) {
      PLUMBLINE_RETURN_IF_ERROR(AddPredictedSteps(seeding.sequential_poses, &mapping->graph));
    }
    if (mapping->as_swept) {
      ThreadPool pool(options.solver.num_threads);
      FollowSweeps(start_poses, mapping);
      MeasureSurfaceOf(options, &pool, mapping);
    }
    mapping->state = {start_poses, {}};
    mapping->start_poses = std::move(start_poses);
    mapping->report.seeding = std::move(seeding);
    return Status::Ok();
  });
}

RangeBeamOptions BeamNoise(const MapLogOptions& options, const MappingReport& report) {
  // A noise that is wrong by a factor of two made the maps of fr079 and intel no worse, and the
  // right one that of mit-killian, 1.8 times the default, no better.
  constexpr double kTooMuch = 2.0, kMostM = 0.06;
  RangeBeamOptions beam = options.solver.factors.beam;
  if (report.range_noise_m > kTooMuch * beam.sigma_range_m) {
    beam.sigma_range_m = std::max(beam.sigma_range_m, std::min(kMostM, report.range_noise_m));
  }
  return beam;
}

void MeasureSurfaceOf(const MapLogOptions& options, ThreadPool* pool, LogMapping* mapping) {
  mapping->surface =
      MeasureSurface(mapping->graph, NormalOptionsFor(BeamNoise(options, mapping->report)), pool);
}

SolverOptions RefinementOptions(const MapLogOptions& options, const LogMapping& mapping) {
  const SeedingReport& seeding = mapping.report.seeding;
  SolverOptions solver = options.solver;
  solver.factors.beam = BeamNoise(options, mapping.report);
  if (seeding.odometry_noise.is_prediction) {
    solver.factors.motion = seeding.odometry_noise.motion;
  } else if (!options.calibration.IsOn()) {
    solver.factors.motion = RefinementMotion(seeding.odometry_noise, solver.factors.motion);
  }
  std::vector<int> after_broken;
  for (const SuspectStep& step : seeding.loops.suspect_steps) {
    if (step.broken) after_broken.push_back(step.first_pose_after);
  }
  std::vector<DownweightedStep>& downweighted = solver.factors.downweighted_steps;
  const std::vector<DownweightedStep> broken =
      FindBrokenSteps(mapping.graph, solver.factors, mapping.start_poses, after_broken);
  downweighted.insert(downweighted.end(), broken.begin(), broken.end());
  return solver;
}

Status RefineLog(const MapLogOptions& options, ThreadPool* pool, LogMapping* mapping) {
  return CatchExceptions([&] {
    AlignStart(mapping);
    const SolverOptions solver = RefinementOptions(options, *mapping);
    std::vector<int> misplaced;
    if (options.calibration.IsOn()) {
      Calibrate(options, solver, mapping);
    } else {
      MeasureMissingSurface(options, pool, mapping);
      SolverSummary& summary = mapping->report.solver;
      summary = RefineState(solver, mapping->surface, mapping->graph, &mapping->state);
      if (summary.IsSolutionUsable() && summary.termination != TerminationType::kUserStopped &&
          !options.solver.MovesPosesOnly()) {
        misplaced = PutScansWhereTheyFit(solver, pool, mapping);
      }
    }
    const double surface_share = SurfaceShare(mapping->graph, mapping->surface);
    mapping->surface = MeasuredSurface();  // as large as what comes next
    if (!mapping->report.solver.IsSolutionUsable()) {
      if (mapping->state.points.empty()) {
        mapping->state.points = mapping->graph.MeasuredMap(mapping->state.poses);
      }
      return Status::InvalidArgument(mapping->report.solver.message);
    }
    mapping->report.consistency =
        MeasureMapConsistency(mapping->graph, PosesOf(mapping->state.poses), pool);
    mapping->report.alarms = RunAlarms(mapping->report.seeding, mapping->report.consistency,
                                       mapping->graph, mapping->state.poses);
    const double unmatched_share =
        mapping->report.seeding.sequential.num_unmatched /
        std::max(1.0, static_cast<double>(mapping->graph.all_scans().size()));
    for (Alarm& alarm :
         UncheckedMapAlarms(surface_share, unmatched_share, mapping->graph, mapping->state.poses)) {
      mapping->report.alarms.push_back(std::move(alarm));
    }
    if (options.solver.type == SolverType::kPublished && options.solver.own_solver == nullptr) {
      for (Alarm& alarm : WorseThanStartAlarms(mapping->report.solver.acceptance, mapping->graph,
                                               mapping->state.poses)) {
        mapping->report.alarms.push_back(std::move(alarm));
      }
    }
    for (Alarm& alarm : MisplacedScanAlarms(misplaced, mapping->graph, mapping->state.poses)) {
      mapping->report.alarms.push_back(std::move(alarm));
    }
    for (Alarm& alarm :
         BentStretchAlarms(mapping->report.bent_stretches, mapping->graph, mapping->state.poses)) {
      mapping->report.alarms.push_back(std::move(alarm));
    }
    for (Alarm& alarm :
         FrozenLaserAlarms(mapping->report.frozen_laser, mapping->graph, mapping->state.poses)) {
      mapping->report.alarms.push_back(std::move(alarm));
    }
    return Status::Ok();
  });
}

Status MapLog(const MapLogOptions& options, SlamGraph graph, const SeedingProgress& progress,
              LogMapping* mapping) {
  return CatchExceptions([&] {
    std::string error;
    if (!options.Check(&error)) return Status::InvalidArgument(error);
    ThreadPool pool(options.solver.num_threads);
    PLUMBLINE_RETURN_IF_ERROR(PrepareLog(options, std::move(graph), &pool, mapping));
    PLUMBLINE_RETURN_IF_ERROR(SeedLog(options, progress, &pool, mapping));
    return RefineLog(options, &pool, mapping);
  });
}

LogMap MapLog(SlamGraph graph, const MapLogOptions& options, const SeedingProgress& progress) {
  LogMap map;
  map.status = CatchExceptions([&] {
    LogMapping mapping;
    Status status = MapLog(options, std::move(graph), progress, &mapping);
    map.graph = std::move(mapping.graph);
    map.poses = PosesOf(mapping.state.poses);
    map.points = std::move(mapping.state.points);
    map.report = std::move(mapping.report);
    return status;
  });
  return map;
}

}  // namespace plumbline
