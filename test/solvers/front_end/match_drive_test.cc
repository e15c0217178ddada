#include "plumbline/solvers/front_end/match_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

const SimulatedLog& Log() {
  static const SimulatedLog log = [] {
    SimulationOptions options;
    options.scan_period_s = 0.5;
    options.laser.num_beams = 90;
    options.laser.bearing_step_rad = DegToRad(2.0);
    SimulatedLog simulated;
    EXPECT_TRUE(
        Simulate(World(GenerateBuilding(BuildingKind::kRandom, 43)), options, &simulated).ok());
    return simulated;
  }();
  return log;
}

struct Matched {
  SequentialTrajectory trajectory;
  OdometryNoiseReport noise;
  double worst_step_m = 0.0;  // error of a step, against the truth
  int num_wrong_steps = 0;    // by more than 0.05 m
};

Matched Match(const SlamGraph& graph, const SimulatedLog& log) {
  ScanSurfaces surfaces(graph, Packed(SurfacesOf(graph)));
  ThreadPool pool(2);
  Matched matched;
  SeedingReport report;
  EXPECT_TRUE(MatchDrive(SeedingOptions(), MotionOptions(), nullptr, &pool, &surfaces,
                         &matched.trajectory, &report)
                  .ok());
  matched.noise = report.odometry_noise;
  const std::vector<Pose2>& poses = matched.trajectory.world_from_robot;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose2 step = Between(poses[i - 1], poses[i]);
    const Pose2 truth = Between(log.scans[i - 1].world_from_robot, log.scans[i].world_from_robot);
    const double error_m = Between(truth, step).translation().norm();
    matched.worst_step_m = std::max(matched.worst_step_m, error_m);
    if (error_m > 0.05) ++matched.num_wrong_steps;
  }
  return matched;
}

Matched Match(const SimulatedLog& log) {
  SlamGraph graph;
  EXPECT_TRUE(MakeGraph(log, &graph).ok());
  return Match(graph, log);
}

// The drive with all positions of its odometry multiplied by a factor.
Matched MatchWithScale(double factor) {
  SimulatedLog log = Log();
  for (SimulatedScan& scan : log.scans) {
    scan.odom_from_robot.x *= factor;
    scan.odom_from_robot.y *= factor;
  }
  return Match(log);
}

TEST(MatchDriveTest, OdometryInOrderIsTakenAsItIs) {
  for (const double factor : {1.0, 0.9, 1.1}) {
    const Matched matched = MatchWithScale(factor);
    EXPECT_EQ(matched.noise.gross_translation_scale, 1.0) << factor;
    EXPECT_NEAR(matched.noise.translation_scale.value, factor - 1.0, 0.03) << factor;
  }
}

// A wrong unit or gear, and wheels that count backwards.
TEST(MatchDriveTest, AFactorOfTheOdometryIsTakenOut) {
  for (const double factor : {0.25, 0.3, 3.0, -1.0}) {
    const Matched matched = MatchWithScale(factor);
    EXPECT_NEAR(matched.noise.gross_translation_scale, factor, 0.05 * std::abs(factor)) << factor;
    EXPECT_FALSE(matched.noise.is_prediction) << factor;
    EXPECT_LT(std::abs(matched.noise.translation_scale.value), 0.05) << factor;
    EXPECT_LT(matched.worst_step_m, 0.05) << factor;
  }
}

TEST(MatchDriveTest, OdometryThatReportsNoTranslationIsNotUsed) {
  const Matched matched = MatchWithScale(0.0);
  EXPECT_EQ(matched.noise.gross_translation_scale, 0.0);
  EXPECT_TRUE(matched.noise.is_prediction);
  EXPECT_LT(matched.worst_step_m, 0.05);
}

TEST(MatchDriveTest, WheelsThatStandStillForAPartAreNotBelieved) {
  SimulatedLog log = Log();
  const std::size_t first = log.scans.size() / 3, last = log.scans.size() / 2;
  const std::vector<SimulatedScan> given = log.scans;
  for (std::size_t i = first; i < log.scans.size(); ++i) {
    Pose2 step = Between(given[i - 1].odom_from_robot, given[i].odom_from_robot);
    if (i < last) step.x = step.y = 0.0;
    log.scans[i].odom_from_robot = log.scans[i - 1].odom_from_robot * step;
  }
  const Matched matched = Match(log);
  EXPECT_EQ(matched.noise.gross_translation_scale, 1.0);
  EXPECT_FALSE(matched.noise.is_prediction);
  EXPECT_NEAR(matched.noise.num_still_steps, static_cast<double>(last - first), 15.0);
  EXPECT_LT(matched.worst_step_m, 0.05);
}

// Poses of another system: no odometry, but each is where the scan was, within half a metre.
// Placeholders of no length, as for scans before the first message of the odometry.
TEST(MatchDriveTest, StepsThatWereNotMeasuredArePredicted) {
  SlamGraph given, graph;
  ASSERT_TRUE(MakeGraph(Log(), &given).ok());
  for (int pose = 0; pose < given.num_poses(); ++pose) {
    graph.AddPose(given.InitialPose(pose), given.timestamp_s(pose));
    graph.AddScanOf(given, pose, pose);
  }
  const int num_unmeasured = given.num_poses() / 3;
  for (OdometryConstraint step : given.odometry()) {
    if (step.to <= num_unmeasured) step = {step.from, step.to, Pose2(), false};
    graph.AddOdometry(step);
  }
  const Matched matched = Match(graph, Log());
  EXPECT_EQ(matched.noise.num_still_steps, num_unmeasured);
  EXPECT_FALSE(matched.noise.is_prediction);
  EXPECT_LT(matched.worst_step_m, 0.05);
}

TEST(MatchDriveTest, PosesWithLargeIndependentErrorsAreSearchedAround) {
  SimulatedLog log = Log();
  std::mt19937 random(1);
  std::normal_distribution<double> position_m(0.0, 0.5), yaw_rad(0.0, 0.05);
  for (SimulatedScan& scan : log.scans) {
    const Pose2& truth = scan.world_from_robot;
    scan.odom_from_robot = Pose2(truth.x + position_m(random), truth.y + position_m(random),
                                 truth.yaw + yaw_rad(random));
  }
  const Matched matched = Match(log);
  EXPECT_NEAR(matched.noise.given_poses.position_m, 0.5, 0.05);
  EXPECT_NEAR(matched.noise.given_poses.yaw_rad, 0.05, 0.01);
  EXPECT_TRUE(matched.noise.is_prediction);
  EXPECT_EQ(matched.trajectory.given_poses.size(), log.scans.size());
  // A few scans fit elsewhere as well as long as only those before them are known.
  EXPECT_LE(matched.num_wrong_steps, 0.02 * static_cast<double>(log.scans.size()));
}

}  // namespace
}  // namespace plumbline
