#include "plumbline/solvers/map_log.h"

#include <ceres/autodiff_cost_function.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/evaluation/truth.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_faults.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/partition.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/doorway_drive.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// A drive through an office that comes back to where it was, with few scans, and with wheels that
// read 3 % too much.
SimulationOptions OfficeSimulation() {
  SimulationOptions options;
  options.scan_period_s = 2.0;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  options.odometry_noise.scale_error = 0.03;
  return options;
}

SimulatedLog Drive(const SimulationOptions& options) {
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
  return log;
}

// The laser is really turned by mounting_error_rad.
SimulatedLog OfficeDrive(double mounting_error_rad = 0.0) {
  SimulationOptions options = OfficeSimulation();
  options.mounting_error.yaw = mounting_error_rad;
  return Drive(options);
}

SlamGraph GraphOf(const SimulatedLog& log) {
  SlamGraph graph;
  EXPECT_TRUE(MakeGraph(log, &graph).ok());
  return graph;
}

const SlamGraph& Office() {
  static const SlamGraph graph = GraphOf(OfficeDrive());
  return graph;
}

const LogMapping& MappedOffice() {
  static const LogMapping* mapping = [] {
    auto* result = new LogMapping;
    const Status status = MapLog(MapLogOptions(), Office(), {}, result);
    EXPECT_TRUE(status.ok()) << status.message();
    return result;
  }();
  return *mapping;
}

LogMapping Prepared(const MapLogOptions& options, SlamGraph graph) {
  ThreadPool pool(options.solver.num_threads);
  LogMapping mapping;
  EXPECT_TRUE(PrepareLog(options, std::move(graph), &pool, &mapping).ok());
  return mapping;
}

LogMapping Seeded(const MapLogOptions& options, SlamGraph graph) {
  ThreadPool pool(options.solver.num_threads);
  LogMapping mapping = Prepared(options, std::move(graph));
  const Status status = SeedLog(options, {}, &pool, &mapping);
  EXPECT_TRUE(status.ok()) << status.message();
  return mapping;
}

// The office, from the seed that was found when it was mapped.
LogMapping StartedFromKeptSeed(const MapLogOptions& options) {
  LogMapping mapping = Prepared(options, Office());
  const Status status =
      StartFromSeed(options, MappedOffice().start_poses, MappedOffice().report.seeding, &mapping);
  EXPECT_TRUE(status.ok()) << status.message();
  return mapping;
}

void Refine(const MapLogOptions& options, LogMapping* mapping) {
  ThreadPool pool(options.solver.num_threads);
  const Status status = RefineLog(options, &pool, mapping);
  EXPECT_TRUE(status.ok()) << status.message();
}

void ExpectSameMap(const LogMapping& a, const LogMapping& b) {
  EXPECT_TRUE(a.state == b.state);
  EXPECT_TRUE(a.start_poses == b.start_poses);
  ASSERT_EQ(a.graph.odometry().size(), b.graph.odometry().size());
  for (std::size_t i = 0; i < a.graph.odometry().size(); ++i) {
    EXPECT_EQ(a.graph.odometry()[i].from_from_to.x, b.graph.odometry()[i].from_from_to.x) << i;
  }
  const MappingReport &of_a = a.report, &of_b = b.report;
  EXPECT_EQ(of_a.solver.message, of_b.solver.message);
  EXPECT_EQ(of_a.solver.final_marginal_energy, of_b.solver.final_marginal_energy);
  EXPECT_EQ(of_a.seeding.loops.num_closures, of_b.seeding.loops.num_closures);
  EXPECT_EQ(of_a.consistency.num_pairs_between, of_b.consistency.num_pairs_between);
  EXPECT_EQ(of_a.consistency.between_passes.Share(), of_b.consistency.between_passes.Share());
  EXPECT_EQ(of_a.alarms.size(), of_b.alarms.size());
}

TEST(MapLogTest, IsItsStepsInTurnOnAnyNumberOfThreads) {
  MapLogOptions options;
  options.solver.num_threads = 1;
  LogMapping steps = Seeded(options, Office());
  Refine(options, &steps);
  ExpectSameMap(steps, MappedOffice());
  EXPECT_THAT(steps.surface.normals, IsEmpty());
}

TEST(MapLogTest, GivesAMapAsAValue) {
  const LogMap map = MapLog(Office());
  ASSERT_TRUE(map.status.ok()) << map.status.message();
  EXPECT_TRUE(map.State() == MappedOffice().state);
  EXPECT_EQ(map.graph.num_poses(), Office().num_poses());
  EXPECT_EQ(map.report.seeding.loops.num_closures,
            MappedOffice().report.seeding.loops.num_closures);
  EXPECT_EQ(map.point(7).y(), map.points[15]);
  const LogMap none = MapLog(SlamGraph());
  EXPECT_EQ(none.status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(none.poses, IsEmpty());
}

TEST(MapLogTest, ComesNearerToTheTruthThanItsSeed) {
  const SimulatedLog log = OfficeDrive();
  const MapEstimate exact = TruthOf(log, Office());
  Truth truth;
  truth.points = exact.points;
  for (const Pose2& pose : exact.poses) truth.trajectory.push_back({0.0, pose});

  const LogMapping& mapping = MappedOffice();
  const MapState seed{mapping.start_poses, mapping.graph.MeasuredMap(mapping.start_poses)};
  const TruthError odometry = CompareWithTruth(Office(), Office().InitialState(), truth);
  const TruthError before = CompareWithTruth(mapping.graph, seed, truth);
  const TruthError after = CompareWithTruth(mapping.graph, mapping.state, truth);
  EXPECT_LT(before.mean_pose_error_m, 0.5 * odometry.mean_pose_error_m);
  EXPECT_LT(after.mean_pose_error_m, 0.5 * before.mean_pose_error_m);
  EXPECT_LT(after.mean_point_error_m, 0.7 * before.mean_point_error_m);

  EXPECT_EQ(mapping.report.solver.termination, TerminationType::kConverged);
  EXPECT_GT(mapping.report.seeding.loops.num_closures, 0);
  EXPECT_GT(mapping.report.consistency.num_pairs_between, 0);
  EXPECT_FALSE(mapping.report.consistency.IsContradictory());
  EXPECT_THAT(mapping.report.alarms, IsEmpty());
  EXPECT_THAT(mapping.report.frozen_laser, IsEmpty());
  EXPECT_THAT(mapping.report.calibration.parameters, IsEmpty());
}

TEST(MapLogTest, GoesByTheOdometryThatTheSeedCorrected) {
  const LogMapping& mapping = MappedOffice();
  const SeedingReport& seeding = mapping.report.seeding;
  ASSERT_TRUE(seeding.odometry_noise.translation_scale.IsSignificant());
  ASSERT_EQ(mapping.graph.odometry().size(), Office().odometry().size());
  double given_m = 0.0, corrected_m = 0.0;
  for (std::size_t i = 0; i < mapping.graph.odometry().size(); ++i) {
    const Pose2& step = mapping.graph.odometry()[i].from_from_to;
    EXPECT_EQ(step.x, seeding.corrections.odometry[i].x) << i;
    EXPECT_EQ(step.yaw, seeding.corrections.odometry[i].yaw) << i;
    corrected_m += step.translation().norm();
    given_m += Office().odometry()[i].from_from_to.translation().norm();
  }
  EXPECT_NEAR(given_m / corrected_m, 1.0 + seeding.odometry_noise.translation_scale.value, 1e-6);
  // The solver is given these motions, with the noise that goes with them.
  const MapLogOptions options;
  MapState state{mapping.start_poses, mapping.graph.MeasuredMap(mapping.start_poses)};
  RefineState(RefinementOptions(options, mapping), mapping.graph, &state);
  EXPECT_TRUE(state == mapping.state);
}

TEST(MapLogTest, LeavesOutWhatAFrozenLaserRepeats) {
  SimulatedLog log = OfficeDrive();
  const int first = static_cast<int>(FreezeLaser(101.0, 12.0, &log));
  const SlamGraph given = GraphOf(log);
  LogMapping mapping;
  ASSERT_TRUE(MapLog(MapLogOptions(), given, {}, &mapping).ok());
  ASSERT_THAT(mapping.report.frozen_laser, SizeIs(1));
  const FrozenStretch& frozen = mapping.report.frozen_laser[0];
  EXPECT_EQ(frozen.first_scan, first - 1);
  EXPECT_EQ(frozen.num_repeated, 6);
  ASSERT_EQ(mapping.graph.num_scans(), given.num_scans());
  for (int scan = 0; scan < given.num_scans(); ++scan) {
    const bool repeats = scan >= first && scan < first + 6;
    EXPECT_EQ(mapping.graph.scan(scan).num_returns, repeats ? 0u : given.scan(scan).num_returns);
  }
  EXPECT_EQ(mapping.state.points.size(), 2 * mapping.graph.num_returns());
  ASSERT_FALSE(mapping.report.alarms.empty());
  const Alarm& alarm = mapping.report.alarms.back();
  EXPECT_THAT(alarm.reason, HasSubstr("the laser gave the same scan 6 times more"));
  EXPECT_EQ(alarm.place.scan, first - 1);
  EXPECT_EQ(alarm.place.world_position, mapping.state.WorldFromRobot(first - 1).translation());
}

// A measured position of the robot, as of GPS.
struct Position {
  double x_m, y_m;

  template <typename T>
  bool operator()(const T* pose, T* residuals) const {
    constexpr double kSigmaM = 0.3;
    residuals[0] = (pose[0] - x_m) / kSigmaM;
    residuals[1] = (pose[1] - y_m) / kSigmaM;
    return true;
  }
};

TEST(MapLogTest, PositionsPutTheMapIntoTheWorld) {
  SimulatedLog log = OfficeDrive();
  FreezeLaser(101.0, 12.0, &log);  // the graph is made anew without what it repeats
  SlamGraph graph = GraphOf(log);
  const MapEstimate truth = TruthOf(log, graph);
  const Pose2 world_from_map(4000.0, -300.0, 2.5);
  std::vector<Pose2> in_world;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    in_world.push_back(world_from_map * truth.poses[pose]);
    if (pose % 5 != 0) continue;
    graph.AddFactor("position",
                    std::make_shared<ceres::AutoDiffCostFunction<Position, 2, 3>>(
                        new Position{in_world[pose].x, in_world[pose].y}),
                    {pose});
  }
  LogMapping mapping;
  ASSERT_TRUE(MapLog(MapLogOptions(), graph, {}, &mapping).ok());
  EXPECT_EQ(mapping.graph.factors().size(), graph.factors().size());
  double sum_m = 0.0, sum_of_start_m = 0.0;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    const Pose2 start(&mapping.start_poses[3 * pose]);
    sum_m += Between(in_world[pose], mapping.state.WorldFromRobot(pose)).translation().norm();
    sum_of_start_m += Between(in_world[pose], start).translation().norm();
  }
  EXPECT_LT(sum_m / graph.num_poses(), 0.05);
  EXPECT_LT(sum_of_start_m / graph.num_poses(), 0.3);
}

TEST(MapLogTest, APoseGraphSolverClosesTheLoopsItself) {
  MapLogOptions options;
  options.solver.type = SolverType::kPoseGraph;
  LogMapping mapping = Seeded(options, Office());
  const SeedingReport& seeding = mapping.report.seeding;
  EXPECT_EQ(mapping.state.poses, PoseArray(seeding.sequential_poses));
  EXPECT_EQ(mapping.start_poses, mapping.state.poses);
  EXPECT_THAT(mapping.state.points, IsEmpty());
  EXPECT_EQ(mapping.graph.relative_poses().size(), seeding.pose_graph.size());
  EXPECT_GT(seeding.pose_graph.size(), mapping.graph.odometry().size());
  Refine(options, &mapping);
  EXPECT_EQ(mapping.report.solver.solver, "pose_graph");
  // Where it ends is what other solvers start from, and they need no pose graph.
  EXPECT_THAT(MappedOffice().graph.relative_poses(), IsEmpty());
  for (int i = 0; i < mapping.state.num_poses(); ++i) {
    const Pose2 off =
        Between(Pose2(&MappedOffice().start_poses[3 * i]), mapping.state.WorldFromRobot(i));
    EXPECT_LT(off.translation().norm(), 1e-3) << i;
  }
}

TEST(MapLogTest, CalibrationCorrectsTheGraphAndTheSeedsLasersStay) {
  const double error_rad = DegToRad(2.0);
  MapLogOptions options;
  options.calibration.laser_mounting = options.calibration.range_bias = true;
  const LogMapping seeded = Seeded(options, GraphOf(OfficeDrive(error_rad)));
  LogMapping mapping = seeded;
  Refine(options, &mapping);

  const Calibration& calibration = mapping.report.calibration;
  ASSERT_THAT(calibration.parameters, SizeIs(4));
  const Pose2 mounting = mapping.graph.laser(0).robot_from_laser;
  EXPECT_EQ(mounting.x, calibration.parameters[0].value);
  EXPECT_EQ(mounting.yaw, calibration.parameters[2].value);
  EXPECT_LT(std::abs(mounting.yaw - error_rad), 0.5 * error_rad);
  const std::vector<float>& ranges_m = mapping.graph.returns().range_m;
  for (std::size_t r = 0; r < ranges_m.size(); ++r) {
    ASSERT_NEAR(ranges_m[r], seeded.graph.returns().range_m[r] + calibration.parameters[3].value,
                1e-6);
  }

  for (int scan = 0; scan < mapping.graph.num_scans(); ++scan) {
    const Pose2 before = seeded.graph.WorldFromLaser(scan, seeded.start_poses);
    const Pose2 after = mapping.graph.WorldFromLaser(scan, mapping.start_poses);
    const Pose2 moved = Between(before, after);
    EXPECT_LT(moved.translation().norm(), 1e-9) << scan;
    EXPECT_LT(std::abs(moved.yaw), 1e-9) << scan;
    const Pose2 robot =
        Between(Pose2(&seeded.start_poses[3 * scan]), Pose2(&mapping.start_poses[3 * scan]));
    EXPECT_NEAR(robot.yaw, mapping.before_from_after.yaw, 1e-9) << scan;
  }
  EXPECT_NEAR(mapping.before_from_after.yaw, -mounting.yaw, 1e-12);
}

TEST(MapLogTest, OptionsThatAreBadOrDoNotGoTogetherAreNamed) {
  const auto refusal = [](const MapLogOptions& options) {
    EXPECT_FALSE(options.Check(nullptr));
    LogMapping mapping;
    mapping.start_poses = {1.0};
    const Status status = MapLog(options, SlamGraph(), {}, &mapping);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(mapping.start_poses, SizeIs(1));
    return status.message();
  };
  MapLogOptions options;
  options.calibration.range_bias = true;
  options.solver.type = SolverType::kSgd;
  EXPECT_THAT(refusal(options), HasSubstr("calibration does not go with the solver sgd"));
  options.calibration.range_bias = false;
  EXPECT_TRUE(options.Check(nullptr));
  options.solver.num_threads = 0;
  EXPECT_THAT(refusal(options), HasSubstr("solver.num_threads = 0"));
  options.seeding.keyframe_distance_m = 0.0;
  EXPECT_THAT(refusal(options), HasSubstr("seeding.keyframe_distance_m = 0"));
}

TEST(MapLogTest, StopsWhenTheProgressCallbackSaysSo) {
  LogMapping mapping;
  const auto stop = [](SeedingPhase, int, int) { return false; };
  EXPECT_EQ(MapLog(MapLogOptions(), Office(), stop, &mapping).code(), StatusCode::kUnavailable);
  EXPECT_EQ(mapping.graph.num_scans(), Office().num_scans());
  EXPECT_EQ(mapping.state.poses, Office().initial_poses());
  EXPECT_THAT(mapping.start_poses, IsEmpty());
}

// A drive with more scans, of which the graph has neither odometry nor guesses of the poses.
SimulatedLog OfficeDriveOfManyScans() {
  SimulationOptions options;
  options.scan_period_s = 0.4;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
  return log;
}

SlamGraph WithoutOdometry(const SlamGraph& graph, bool has_clock) {
  SlamGraph scans_alone;
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    const double time_s = has_clock ? graph.timestamp_s(graph.scan(scan).pose) : 0.0;
    const int pose = scans_alone.AddPose(Pose2(), time_s);
    scans_alone.AddScanOf(graph, scan, pose);
  }
  return scans_alone;
}

TEST(MapLogWithoutOdometryTest, TheMapIsRightWithAndWithoutAClock) {
  const SimulatedLog log = OfficeDriveOfManyScans();
  const SlamGraph graph = GraphOf(log);
  const std::vector<Pose2> truth = TruthOf(log, graph).poses;
  for (const bool has_clock : {true, false}) {
    LogMapping mapping;
    const Status status = MapLog(MapLogOptions(), WithoutOdometry(graph, has_clock), {}, &mapping);
    ASSERT_TRUE(status.ok()) << status.message();
    double worst_m = 0.0;
    for (int pose = 0; pose < graph.num_poses(); ++pose) {
      const Pose2 off = Between(truth[pose], mapping.state.WorldFromRobot(pose));
      worst_m = std::max(worst_m, off.translation().norm());
    }
    EXPECT_LT(worst_m, 0.06) << has_clock;
    EXPECT_THAT(mapping.report.alarms, IsEmpty());
    EXPECT_TRUE(mapping.report.seeding.odometry_noise.is_prediction);
    EXPECT_THAT(mapping.graph.odometry(), SizeIs(graph.num_poses() - 1));
    EXPECT_THAT(mapping.report.seeding.corrections.odometry, IsEmpty());
  }
}

TEST(MapLogWithoutOdometryTest, WhatNeedsOdometryIsRefused) {
  const SlamGraph graph = WithoutOdometry(Office(), true);
  MapLogOptions options;
  options.start = StartType::kOdometry;
  LogMapping mapping;
  EXPECT_THAT(MapLog(options, graph, {}, &mapping).message(), HasSubstr("but the log has none"));
  options = MapLogOptions();
  options.calibration.laser_mounting = true;
  EXPECT_THAT(MapLog(options, graph, {}, &mapping).message(), HasSubstr("needs odometry"));
}

TEST(MapLogWithoutOdometryTest, AChainOfMatchesIsAStartToo) {
  MapLogOptions options;
  options.start = StartType::kIcpPointToLine;
  const LogMapping mapping = Seeded(options, WithoutOdometry(Office(), true));
  EXPECT_THAT(mapping.graph.odometry(), SizeIs(Office().num_poses() - 1));
  EXPECT_TRUE(RefinementOptions(options, mapping).factors.motion.translation_floor_m >
              options.solver.factors.motion.translation_floor_m);
}

TEST(StartFromSeedTest, AKeptSeedGivesTheSameMap) {
  const MapLogOptions options;
  LogMapping mapping = StartedFromKeptSeed(options);
  EXPECT_EQ(mapping.state.poses, MappedOffice().start_poses);
  Refine(options, &mapping);
  ExpectSameMap(mapping, MappedOffice());
}

TEST(StartFromSeedTest, RefusesTheSeedOfAnotherLog) {
  const MapLogOptions options;
  LogMapping mapping = Prepared(options, Office());
  const auto refusal = [&](const std::vector<double>& poses, const SeedingReport& seeding) {
    const Status status = StartFromSeed(options, poses, seeding, &mapping);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(mapping.state.poses, Office().initial_poses());
    EXPECT_THAT(mapping.start_poses, IsEmpty());
    return status.message();
  };
  std::vector<double> poses = Office().initial_poses();
  SeedingReport seeding;
  const std::string num_steps = std::to_string(Office().odometry().size());
  EXPECT_THAT(refusal(poses, seeding),
              HasSubstr("0 odometry constraints, but the log needs " + num_steps));
  seeding.corrections.odometry.resize(Office().odometry().size());
  const std::string expected = std::to_string(poses.size());
  poses.resize(poses.size() - 3);
  EXPECT_THAT(refusal(poses, seeding),
              HasSubstr(std::to_string(poses.size()) + " coordinates of poses, but the log needs " +
                        expected));
}

TEST(RefinementOptionsTest, TakesTheNoiseOfForwardMotionFromTheReport) {
  MapLogOptions options;
  const MotionOptions& given = options.solver.factors.motion;
  LogMapping mapping;
  SeedingReport& seeding = mapping.report.seeding;
  seeding.odometry_noise.translation.estimated = true;
  MotionOptions& found = seeding.odometry_noise.motion;
  found.translation_per_translation = 0.5 * given.translation_per_translation;
  found.rotation_per_rotation = 0.5 * given.rotation_per_rotation;
  const auto refined = [&] { return RefinementOptions(options, mapping).factors.motion; };
  EXPECT_EQ(refined().translation_per_translation, found.translation_per_translation);
  EXPECT_LT(refined().translation_floor_m, given.translation_floor_m);
  EXPECT_EQ(refined().rotation_per_rotation, given.rotation_per_rotation);

  found.translation_per_translation = 2.0 * given.translation_per_translation;
  EXPECT_EQ(refined().translation_per_translation, given.translation_per_translation);

  found.translation_per_translation = 0.5 * given.translation_per_translation;
  options.calibration.odometry_scale = true;
  EXPECT_EQ(refined().translation_per_translation, given.translation_per_translation);
  EXPECT_EQ(refined().translation_floor_m, given.translation_floor_m);
}

TEST(BeamNoiseTest, IsTheScansWhereTheyShowMoreThanTwiceAsMuch) {
  MapLogOptions options;
  const RangeBeamOptions& given = options.solver.factors.beam;
  MappingReport report;
  const auto taken_m = [&] { return BeamNoise(options, report).sigma_range_m; };
  EXPECT_EQ(taken_m(), given.sigma_range_m);  // nothing is known
  report.range_noise_m = 2.0 * given.sigma_range_m;
  EXPECT_EQ(taken_m(), given.sigma_range_m);
  report.range_noise_m = 3.0 * given.sigma_range_m;
  EXPECT_EQ(taken_m(), report.range_noise_m);
  EXPECT_EQ(BeamNoise(options, report).sigma_bearing_rad, given.sigma_bearing_rad);
  report.range_noise_m = 0.3;
  EXPECT_EQ(taken_m(), 0.06);
  options.solver.factors.beam.sigma_range_m = 0.1;
  EXPECT_EQ(taken_m(), 0.1);
}

TEST(BeamNoiseTest, ANoisyLaserIsMappedAsIfItsNoiseHadBeenTold) {
  constexpr double kNoiseM = 0.04;
  SimulationOptions simulation = OfficeSimulation();
  simulation.laser_noise.sigma_range_m = kNoiseM;
  const SlamGraph graph = GraphOf(Drive(simulation));
  LogMapping found, told;
  ASSERT_TRUE(MapLog(MapLogOptions(), graph, {}, &found).ok());
  EXPECT_NEAR(found.report.range_noise_m, kNoiseM, 0.1 * kNoiseM);
  MapLogOptions options;
  options.solver.factors.beam.sigma_range_m = found.report.range_noise_m;
  ASSERT_TRUE(MapLog(options, graph, {}, &told).ok());
  EXPECT_EQ(found.start_poses, told.start_poses);
  EXPECT_EQ(found.state.poses, told.state.poses);
  EXPECT_EQ(found.state.points, told.state.points);
}

TEST(RefineLogTest, AStopOfTheSolverLeavesAMap) {
  MapLogOptions options;
  int num_calls = 0;
  options.solver.callback = [&](const IterationSummary&) {
    ++num_calls;
    return false;
  };
  LogMapping mapping = StartedFromKeptSeed(options);
  Refine(options, &mapping);
  EXPECT_EQ(num_calls, 1);
  EXPECT_EQ(mapping.report.solver.termination, TerminationType::kUserStopped);
  EXPECT_TRUE(mapping.report.solver.IsSolutionUsable());
  EXPECT_EQ(mapping.state.poses.size(), Office().initial_poses().size());
  EXPECT_EQ(mapping.state.points.size(), 2 * Office().num_returns());
  EXPECT_FALSE(mapping.state == MappedOffice().state);
  EXPECT_GT(mapping.report.consistency.num_pairs_between, 0);
  EXPECT_FALSE(mapping.report.consistency.IsContradictory());
}

TEST(RefineLogTest, RefusesALogWithoutReturns) {
  for (const bool calibrate : {false, true}) {
    MapLogOptions options;
    options.calibration.laser_mounting = calibrate;
    LogMapping mapping = Prepared(options, SlamGraph());
    ThreadPool pool(1);
    const Status status = RefineLog(options, &pool, &mapping);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("no laser returns"));
  }
}

// A robot was carried forward by 0.3 m, unknown to the odometry, and the start shares that out
// among the ten steps before: they are a little long, one by one within the noise.
LogMapping StartedBeforeACarriedRobot(const MapLogOptions& options) {
  DoorwayDrive drive = DriveAlongDoors();
  drive.odometry[35].x -= 0.3;
  SeedingReport seeding;
  for (int p = 1; p < DoorwayDrive::kNumPoses; ++p) {
    drive.graph.AddOdometry({p - 1, p, drive.odometry[p]});
    seeding.corrections.odometry.push_back(drive.odometry[p]);
  }
  for (int p = 25; p < 35; ++p) drive.Misplace(p, 34, 0.03);
  LogMapping mapping = Prepared(options, drive.graph);
  EXPECT_TRUE(StartFromSeed(options, PoseArray(drive.poses), seeding, &mapping).ok());
  return mapping;
}

TEST(RefineLogTest, BeginsAgainWhereScansLieBesideWhereTheyFit) {
  MapLogOptions options;
  options.solver.factors.motion.translation_per_translation = 0.03;  // good wheels
  LogMapping mapping = StartedBeforeACarriedRobot(options);
  MapState once = mapping.state;
  ASSERT_TRUE(
      RefineState(RefinementOptions(options, mapping), mapping.surface, mapping.graph, &once)
          .IsSolutionUsable());
  Refine(options, &mapping);
  const std::vector<int>& misplaced = mapping.report.misplaced_poses;
  EXPECT_GE(misplaced.size(), 3u);
  for (const int pose : misplaced) {
    const Pose2 right = mapping.graph.InitialPose(pose);
    EXPECT_GT(DistanceM(Pose2(&once.poses[3 * pose]), right), 0.1) << pose;
    EXPECT_LT(DistanceM(Pose2(&mapping.state.poses[3 * pose]), right), 0.03) << pose;
  }
  EXPECT_THAT(mapping.report.alarms, IsEmpty());
}

TEST(MapLogTest, ProcessesEndUpWithThePlacesThatTheSeedGivesThem) {
  constexpr int kNumProcesses = 2;
  const LogMapping expected = Seeded(MapLogOptions(), Office());
  RunOnPeers(kNumProcesses, [&](const Peers& peers) {
    ThreadPool pool(1);
    LogMapping mapping;
    ASSERT_TRUE(TakeLog(MapLogOptions(), Office(), &pool, &mapping).ok());
    ASSERT_TRUE(
        ShareGraph(&peers, PartitionByTime(Office().num_poses(), kNumProcesses), &mapping.graph)
            .ok());
    ASSERT_TRUE(SeedLog(MapLogOptions(), {}, &pool, &mapping).ok());
    EXPECT_EQ(mapping.start_poses, expected.start_poses);
    EXPECT_EQ(
        mapping.graph.rank_of_pose(),
        PartitionByPlace(expected.start_poses, ReturnsPerPose(expected.graph), kNumProcesses));
    EXPECT_EQ(mapping.surface.normals.size(), mapping.graph.num_returns());
  });
}

}  // namespace
}  // namespace plumbline
