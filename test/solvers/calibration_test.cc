#include "plumbline/solvers/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/seed.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr double kOdometrySigma = 0.003;  // [m] and [rad] per step

// Poses on an ellipse in a room with a partition, or along a straight line.
SlamGraph MakeDrive(bool straight, int num_poses, unsigned seed) {
  SyntheticScene scene;
  scene.faces = {{{-3, -2}, {3, -2}}, {{3, -2}, {3, 2}},  {{3, 2}, {-3, 2}},
                 {{-3, 2}, {-3, -2}}, {{0, 0.9}, {0, 2}}, {{-1.5, -1.2}, {-0.7, -1.2}}};
  scene.laser = PanoramicLaser(180);
  scene.laser.robot_from_laser = {0.1, -0.05, 0.3};
  scene.range_sigma_m = 0.012;
  for (int i = 0; i < num_poses; ++i) {
    const double turn = 4.0 * kPi * i / num_poses;
    scene.poses.push_back(straight
                              ? Pose2(-2.0 + 4.0 * i / num_poses, 0.3, 0.0)
                              : Pose2(1.8 * std::cos(turn), 0.5 * std::sin(turn),
                                      std::atan2(0.5 * std::cos(turn), -1.8 * std::sin(turn))));
  }
  SlamGraph graph = MakeGraph(scene, seed);
  RandomStates random(seed);
  for (int i = 0; i + 1 < num_poses; ++i) {
    const Pose2 noise(random.Gaussian(kOdometrySigma), random.Gaussian(kOdometrySigma),
                      random.Gaussian(kOdometrySigma));
    const Pose2 step = Between(scene.poses[i], scene.poses[i + 1]);
    graph.AddOdometry({i, i + 1, Pose2(step.x + noise.x, step.y + noise.y, step.yaw + noise.yaw)});
  }
  return graph;
}

// What is wrong with the sensors of a graph as it is given to the solver.
struct Fault {
  Pose2 mounting;  // added
  double range_bias_m = 0.0, range_scale = 1.0, odometry_scale = 1.0;
};
const Fault kFault{{-0.05, 0.05, DegToRad(2.0)}, 0.03, 1.01, 1.03};

SlamGraph Faulty(const SlamGraph& graph, const Fault& fault) {
  MeasurementCorrections faults;
  const Pose2 mounting = graph.laser(0).robot_from_laser;
  faults.robot_from_laser = {{mounting.x + fault.mounting.x, mounting.y + fault.mounting.y,
                              mounting.yaw + fault.mounting.yaw}};
  for (const double range_m : graph.returns().range_m) {
    faults.range_m.push_back(range_m / fault.range_scale - fault.range_bias_m);
  }
  for (const OdometryConstraint& c : graph.odometry()) {
    const Pose2& step = c.from_from_to;
    faults.odometry.emplace_back(step.x / fault.odometry_scale, step.y / fault.odometry_scale,
                                 step.yaw);
  }
  return graph.Corrected(faults);
}

std::map<std::string, double> Truth(const Fault& fault) {
  return {{"mounting_x_m", 0.1},
          {"mounting_y_m", -0.05},
          {"mounting_yaw_rad", 0.3},
          {"range_bias_m", fault.range_bias_m},
          {"range_scale", fault.range_scale},
          {"odometry_scale", fault.odometry_scale}};
}

SolverOptions Options() {
  SolverOptions options;
  MotionOptions& motion = options.factors.motion;
  motion.rotation_per_rotation = motion.rotation_per_translation_rad_m = 0.0;
  motion.translation_per_translation = motion.translation_per_rotation_m_rad = 0.0;
  motion.translation_floor_m = motion.rotation_floor_rad = kOdometrySigma;
  return options;
}

// Sum of squares of the errors of the parameters, in their own standard deviations.
double Calibrate(const Fault& fault, const SolverOptions& options,
                 const CalibrationOptions& calibration_options, unsigned seed, int* count) {
  const SlamGraph graph = Faulty(MakeDrive(false, 80, seed), fault);
  MapState state = graph.InitialState();
  Calibration calibration;
  const SolverSummary summary =
      SolveWithCalibration(options, calibration_options, graph, &state, &calibration);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_TRUE(calibration.settled);
  double sum = 0.0;
  for (const CalibratedParameter& p : calibration.parameters) {
    const double error = (p.value - Truth(fault)[p.name]) / p.sigma;
    EXPECT_LT(std::abs(error), 4.0) << p.name << " " << p.value << " +- " << p.sigma;
    EXPECT_TRUE(p.IsDetermined()) << p.name << " +- " << p.sigma;
    EXPECT_GT(std::abs(p.given - Truth(fault)[p.name]), 3.0 * p.sigma) << p.name;
    sum += error * error;
    ++*count;
  }
  return sum;
}

TEST(CalibrationTest, FindsEveryFaultByItself) {
  CalibrationOptions options;
  int count = 0;
  options.laser_mounting = true;
  Calibrate({kFault.mounting}, Options(), options, 1, &count);
  options = CalibrationOptions();
  options.range_bias = true;
  Calibrate({{}, kFault.range_bias_m}, Options(), options, 1, &count);
  options = CalibrationOptions();
  options.range_scale = true;
  Calibrate({{}, 0.0, kFault.range_scale}, Options(), options, 1, &count);
  options = CalibrationOptions();
  options.odometry_scale = true;
  Calibrate({{}, 0.0, 1.0, kFault.odometry_scale}, Options(), options, 1, &count);
  EXPECT_EQ(count, 6);
}

// Both scales at once would be told apart by nothing. The sigmas hold for an odometry that the
// options think of as three times worse, too.
TEST(CalibrationTest, SigmasAreHonest) {
  CalibrationOptions calibration_options;
  calibration_options.laser_mounting = calibration_options.range_bias = true;
  calibration_options.odometry_scale = true;
  SolverOptions loose = Options();
  loose.factors.motion.translation_floor_m = loose.factors.motion.rotation_floor_rad =
      3.0 * kOdometrySigma;
  const Fault fault{kFault.mounting, kFault.range_bias_m, 1.0, kFault.odometry_scale};
  for (const SolverOptions& options : {Options(), loose}) {
    double sum = 0.0;
    int count = 0;
    for (unsigned seed = 1; seed <= 6; ++seed) {
      sum += Calibrate(fault, options, calibration_options, seed, &count);
    }
    ASSERT_EQ(count, 30);
    EXPECT_GT(std::sqrt(sum / count), 0.5);
    EXPECT_LT(std::sqrt(sum / count), 2.0);
  }
}

TEST(CalibrationTest, WhatTheDataDoNotDetermineStays) {
  const SlamGraph graph = Faulty(MakeDrive(true, 30, 3), {kFault.mounting});
  MapState state = graph.InitialState();
  CalibrationOptions options;
  options.laser_mounting = options.range_scale = options.odometry_scale = true;
  Calibration calibration;
  ASSERT_TRUE(
      SolveWithCalibration(Options(), options, graph, &state, &calibration).IsSolutionUsable());
  std::map<std::string, CalibratedParameter> found;
  for (const CalibratedParameter& p : calibration.parameters) found[p.name] = p;
  ASSERT_EQ(found.size(), 5u);
  // Without turns, nothing says where on the robot the laser sits.
  for (const char* name : {"mounting_x_m", "mounting_y_m", "range_scale"}) {
    EXPECT_FALSE(found[name].IsDetermined()) << name << " +- " << found[name].sigma;
    EXPECT_NEAR(found[name].value, found[name].given, found[name].sigma) << name;
  }
  EXPECT_TRUE(found["mounting_yaw_rad"].IsDetermined());
  EXPECT_NEAR(found["mounting_yaw_rad"].value, 0.3, 4.0 * found["mounting_yaw_rad"].sigma);
}

TEST(CalibrationTest, CorrectionsAndStateAreConsistent) {
  const SlamGraph graph = Faulty(MakeDrive(false, 40, 2), {kFault.mounting, kFault.range_bias_m});
  MapState state = graph.InitialState(), other = state;
  CalibrationOptions options;
  options.laser_mounting = options.range_bias = true;
  SolverOptions one_thread = Options();
  one_thread.num_threads = 1;
  Calibration calibration, again;
  ASSERT_TRUE(
      SolveWithCalibration(Options(), options, graph, &state, &calibration).IsSolutionUsable());
  const SlamGraph corrected = graph.Corrected(calibration.corrections);
  EXPECT_EQ(corrected.laser(0).robot_from_laser.x, calibration.parameters[0].value);
  EXPECT_NEAR(corrected.returns().range_m[5],
              graph.returns().range_m[5] + calibration.parameters[3].value, 1e-6);
  EXPECT_EQ(corrected.odometry()[2].from_from_to.x, graph.odometry()[2].from_from_to.x);
  // Points lie near the corrected ends of their beams.
  const MapState raw{state.poses, corrected.MeasuredMap(state.poses)};
  for (std::size_t r = 0; r < graph.num_returns(); ++r) {
    ASSERT_LT((MapPoint(state, r) - MapPoint(raw, r)).norm(), 0.1);
  }
  // Bitwise the same with another number of threads.
  ASSERT_TRUE(SolveWithCalibration(one_thread, options, graph, &other, &again).IsSolutionUsable());
  EXPECT_EQ(other, state);
  EXPECT_EQ(again.parameters[3].sigma, calibration.parameters[3].sigma);
}

TEST(CalibrationTest, OffIsSolve) {
  const SlamGraph graph = MakeDrive(false, 20, 1);
  MapState state = graph.InitialState(), solved = state;
  Calibration calibration;
  calibration.steps = 7;
  SolveWithCalibration(Options(), CalibrationOptions(), graph, &state, &calibration);
  RefineState(Options(), graph, &solved);
  EXPECT_EQ(state, solved);
  EXPECT_TRUE(calibration.parameters.empty());
  EXPECT_EQ(calibration.steps, 0);
}

TEST(CalibrationTest, FixedPosesStayWhereTheyWereFixed) {
  const SlamGraph given = Faulty(MakeDrive(false, 40, 2), {kFault.mounting, kFault.range_bias_m});
  CalibrationOptions options;
  options.range_bias = true;
  for (const bool mounting : {false, true}) {
    SlamGraph graph = given;
    graph.FixPose(7);
    options.laser_mounting = mounting;
    if (!mounting) {
      graph.FixPose(20);
    }
    // All of it beside where it is to be.
    const Pose2 motion(0.5, -1.0, 0.3);
    MapState state = graph.InitialState();
    for (int pose = 0; pose < graph.num_poses(); ++pose) {
      state.SetPose(pose, motion * state.WorldFromRobot(pose));
    }
    state.points = graph.MeasuredMap(state.poses);
    Calibration calibration;
    const SolverSummary summary =
        SolveWithCalibration(Options(), options, graph, &state, &calibration);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
    for (const FixedPose& fixed : graph.fixed_poses()) {
      EXPECT_EQ(ToBlock(state.WorldFromRobot(fixed.pose)), ToBlock(fixed.world_from_robot));
    }
  }
}

void ExpectSameParameters(const Calibration& calibration, const Calibration& expected) {
  EXPECT_EQ(calibration.steps, expected.steps);
  ASSERT_EQ(calibration.parameters.size(), expected.parameters.size());
  for (std::size_t i = 0; i < expected.parameters.size(); ++i) {
    const CalibratedParameter &here = calibration.parameters[i], &there = expected.parameters[i];
    EXPECT_EQ(here.name, there.name);
    EXPECT_NEAR(here.value, there.value, 1e-9) << here.name;
    EXPECT_NEAR(here.sigma, there.sigma, 1e-6 * there.sigma) << here.name;
  }
}

// Of which no scan sees more than a part.
SlamGraph MakeCorridor() {
  SyntheticScene scene;
  scene.faces = {{{-3, -1}, {27, -1}}, {{-3, 1}, {27, 1}}};
  for (double x = -2.0; x < 27.0; x += 1.5) scene.faces.push_back({{x, 0.7}, {x + 0.3, 1.0}});
  scene.laser = PanoramicLaser(180);
  scene.laser.max_range_m = 4.0;
  scene.range_sigma_m = 0.012;
  for (int i = 0; i < 60; ++i) scene.poses.emplace_back(0.4 * i, 0.2 * std::sin(0.5 * i), 0.1);
  SlamGraph graph = MakeGraph(scene, 1);
  for (int i = 0; i + 1 < graph.num_poses(); ++i) {
    graph.AddOdometry({i, i + 1, Between(scene.poses[i], scene.poses[i + 1])});
  }
  return graph;
}

void ExpectSameInProcesses(const SlamGraph& whole, const CalibrationOptions& options) {
  MapState expected_state = whole.InitialState();
  Calibration expected;
  ASSERT_TRUE(SolveWithCalibration(Options(), options, whole, &expected_state, &expected)
                  .IsSolutionUsable());
  for (const int num_processes : {2, 3}) {
    SCOPED_TRACE(num_processes);
    RunOnParts(whole, num_processes, [&](const SlamGraph& part) {
      MapState state{part.initial_poses(), {}};
      Calibration calibration;
      const SolverSummary summary =
          SolveWithCalibration(Options(), options, part, &state, &calibration);
      ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
      ExpectSameParameters(calibration, expected);
      const MapState own = PartOf(part, expected_state);
      for (std::size_t i = 0; i < own.poses.size(); ++i) {
        ASSERT_NEAR(state.poses[i], own.poses[i], 1e-6);
      }
      ASSERT_EQ(state.points.size(), own.points.size());
      for (std::size_t i = 0; i < own.points.size(); ++i) {
        ASSERT_NEAR(state.points[i], own.points[i], 1e-5);
      }
      // Of the ranges that this process has.
      EXPECT_EQ(calibration.corrections.range_m.size(), part.num_returns());
    });
  }
}

TEST(CalibrationTest, ProcessesFindTogetherWhatOneFinds) {
  CalibrationOptions options;
  options.range_bias = true;
  ExpectSameInProcesses(Faulty(MakeCorridor(), {{}, kFault.range_bias_m}), options);
  options.laser_mounting = options.range_scale = true;
  ExpectSameInProcesses(Faulty(MakeDrive(false, 60, 4), kFault), options);
}

TEST(CalibrationTest, ACallbackOfOneProcessStopsAll) {
  const SlamGraph whole = Faulty(MakeDrive(false, 20, 1), {kFault.mounting});
  CalibrationOptions calibration_options;
  calibration_options.laser_mounting = true;
  RunOnParts(whole, 2, [&](const SlamGraph& part) {
    SolverOptions options = Options();
    if (part.peers()->rank() == 1) options.callback = [](const IterationSummary&) { return false; };
    MapState state{part.initial_poses(), {}};
    Calibration calibration;
    const SolverSummary summary =
        SolveWithCalibration(options, calibration_options, part, &state, &calibration);
    EXPECT_EQ(summary.termination, TerminationType::kUserStopped) << summary.message;
    EXPECT_EQ(calibration.steps, 1);
  });
}

void ExpectRefused(const CalibrationOptions& options, const SlamGraph& graph, const char* reason) {
  MapState state = graph.InitialState();
  Calibration calibration;
  const SolverSummary summary =
      SolveWithCalibration(Options(), options, graph, &state, &calibration);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_THAT(summary.message, HasSubstr(reason));
  EXPECT_EQ(state, graph.InitialState());
  EXPECT_TRUE(calibration.corrections.range_m.empty());
  EXPECT_TRUE(calibration.parameters.empty());
}

TEST(CalibrationTest, RefusesAndLeavesTheStateAlone) {
  CalibrationOptions options;
  options.range_scale = true;
  ExpectRefused(options, SlamGraph(), "no laser returns");
  // Solvers of pose graphs alone take graphs without any laser.
  SlamGraph edges;
  for (int i = 0; i < 2; ++i) edges.AddPose(Pose2(i, 0, 0), i);
  edges.AddRelativePose({0, 1, Pose2(1, 0, 0), Eigen::Matrix3d::Identity()});
  SolverOptions sgd;
  sgd.type = SolverType::kSgd;
  options = CalibrationOptions();
  options.odometry_scale = true;
  MapState state = edges.InitialState();
  Calibration none;
  EXPECT_THAT(SolveWithCalibration(sgd, options, edges, &state, &none).message,
              HasSubstr("sgd does not look at the returns"));
  options = CalibrationOptions();
  options.range_scale = true;

  // A second laser elsewhere on the robot.
  SlamGraph graph = MakeDrive(false, 4, 1);
  LaserModel laser = graph.laser(0);
  laser.robot_from_laser.x += 0.3;
  graph.AddLaser(laser);
  ExpectRefused(options, graph, "laser 1 is mounted differently from laser 0");

  // The map is carried along with the sensors about one fixed pose.
  graph = MakeDrive(false, 4, 1);
  for (const int pose : {0, 2}) graph.FixPose(pose);
  ExpectRefused(options, graph,
                "laser_mounting and range_scale move the poses with the sensors: they cannot be "
                "calibrated with more than one fixed pose, and the graph has 2");
  options = CalibrationOptions();
  options.laser_mounting = true;
  ExpectRefused(options, graph, "more than one fixed pose, and the graph has 2");

  // A pose that sees nothing and that no odometry leads to.
  options = CalibrationOptions();
  options.odometry_scale = true;
  graph = MakeDrive(false, 4, 1);
  graph.AddPose({1.0, 1.0, 0.0}, 9.0);
  ExpectRefused(options, graph, "nothing ties pose 4 to a fixed pose");
}

// A reference tells where the robot's frame is: here the relative poses that Freiburg's benchmark
// gives of building 079, whose log has the laser 4 cm behind the robot's centre. Odometry is left
// out, for it turns about a point near the laser.
TEST(CalibrationTest, FindsTheMountingOfARealLogFromReferencePoses) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "PLUMBLINE_DATASETS is not set";
  CarmenLog log;
  ASSERT_TRUE(ReadCarmenLog(DatasetsFolder() + "/fr079.clf.gz", CarmenReadOptions(), &log).ok());
  std::vector<Relation> relations;
  ASSERT_TRUE(ReadRelations(DatasetsFolder() + "/fr079.relations", &relations).ok());
  EXPECT_NEAR(EstimateLaserMounting(log).robot_from_laser.x, -0.04, 1e-4);
  SlamGraph drive;
  ASSERT_TRUE(BuildGraph(log, 0, &drive).ok());
  drive = drive.Corrected({{}, {Pose2()}, {}, {}, {}});
  MapState seed;
  SeedingReport seeding;
  ASSERT_TRUE(SeedGraph(SeedingOptions(), SolverOptions(), drive, &seed, &seeding).ok());

  SlamGraph graph;
  std::vector<double> times_s;
  for (int pose = 0; pose < drive.num_poses(); ++pose) {
    times_s.push_back(drive.timestamp_s(pose));
    graph.AddPose(seed.WorldFromRobot(pose), times_s.back());
  }
  for (int scan = 0; scan < drive.num_scans(); ++scan) {
    graph.AddScanOf(drive, scan, drive.scan(scan).pose);
  }
  // As well as scans can be laid over each other by hand.
  const Eigen::Vector3d sigmas(0.03, 0.03, DegToRad(0.5));
  const Eigen::Matrix3d covariance = sigmas.cwiseAbs2().asDiagonal();
  const auto pose_at = [&](double time_s) {
    const auto after = std::lower_bound(times_s.begin(), times_s.end(), time_s - 0.005);
    return static_cast<int>(after - times_s.begin());
  };
  for (const Relation& r : relations) {
    const int from = pose_at(r.from_s), to = pose_at(r.to_s);
    ASSERT_NEAR(times_s.at(from), r.from_s, 0.005);
    ASSERT_NEAR(times_s.at(to), r.to_s, 0.005);
    graph.AddRelativePose({from, to, r.from_from_to, covariance});
  }
  CalibrationOptions options;
  options.laser_mounting = true;
  MapState state = graph.InitialState();
  Calibration calibration;
  const SolverSummary summary =
      SolveWithCalibration(SolverOptions(), options, graph, &state, &calibration);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  ASSERT_EQ(calibration.parameters.size(), 3u);
  for (const CalibratedParameter& p : calibration.parameters) EXPECT_TRUE(p.IsDetermined());
  EXPECT_NEAR(calibration.parameters[0].value, -0.04, 0.01);
  EXPECT_NEAR(calibration.parameters[1].value, 0.0, 0.01);
  EXPECT_NEAR(calibration.parameters[2].value, 0.0, DegToRad(1.0));
}

}  // namespace
}  // namespace plumbline
