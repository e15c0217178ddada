#include "plumbline/solvers/reduced/calibrated_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/test/noisy_room.h"

namespace plumbline {
namespace {

CalibrationVector SomeTheta() {
  CalibrationVector theta;
  theta << 0.04, -0.03, 0.05, 0.02, 0.01, -0.03;
  return theta;
}

TEST(CalibratedGraphTest, CorrectsWhatTheSensorsSay) {
  NoisyRoom room = MakeNoisyRoom();
  const SlamGraph given = room.graph;
  CalibratedGraph calibrated(&room.graph);
  calibrated.Set(SomeTheta(), given.poses());
  const Pose2 mounting = room.graph.laser(0).robot_from_laser;
  EXPECT_DOUBLE_EQ(mounting.x, given.laser(0).robot_from_laser.x + 0.04);
  EXPECT_DOUBLE_EQ(mounting.y, given.laser(0).robot_from_laser.y - 0.03);
  EXPECT_DOUBLE_EQ(mounting.yaw, given.laser(0).robot_from_laser.yaw + 0.05);
  EXPECT_DOUBLE_EQ(room.graph.returns().range_m[9],
                   std::exp(0.01) * (given.returns().range_m[9] + 0.02));
  EXPECT_DOUBLE_EQ(room.graph.odometry()[3].from_from_to.y,
                   std::exp(-0.03) * given.odometry()[3].from_from_to.y);
  EXPECT_EQ(room.graph.odometry()[3].from_from_to.yaw, given.odometry()[3].from_from_to.yaw);

  // Back, without a trace.
  calibrated.Set(CalibrationVector::Zero(), given.poses());
  EXPECT_EQ(room.graph.returns().range_m, given.returns().range_m);
  EXPECT_TRUE(room.graph.laser(0) == given.laser(0));
  for (std::size_t i = 0; i < given.odometry().size(); ++i) {
    EXPECT_EQ(room.graph.odometry()[i].from_from_to.x, given.odometry()[i].from_from_to.x);
  }
}

TEST(CalibratedGraphTest, CarriesTheMapAlong) {
  NoisyRoom room = MakeNoisyRoom();
  ASSERT_TRUE(room.graph.FixPose(4).ok());
  CalibratedGraph calibrated(&room.graph);
  const SlamGraph given = room.graph;
  CalibrationVector theta = SomeTheta();
  theta[kRangeBias] = 0.0;
  calibrated.Set(theta, calibrated.Carried(theta, given.poses()));
  room.graph.ResetPointsFromPoses();
  const Pose2 anchor = room.graph.WorldFromRobot(4), before = given.WorldFromRobot(4);
  EXPECT_NEAR(anchor.x, before.x, 1e-12);
  EXPECT_NEAR(anchor.y, before.y, 1e-12);
  EXPECT_NEAR(anchor.yaw, before.yaw, 1e-12);
  // All distances between points, of whatever scans, have grown by the same factor.
  SlamGraph raw = given;
  raw.ResetPointsFromPoses();
  for (std::size_t r = 1; r < raw.num_returns(); r += 37) {
    const double was = (MapPoint(raw, r) - MapPoint(raw, 0)).norm();
    EXPECT_NEAR((MapPoint(room.graph, r) - MapPoint(room.graph, 0)).norm(), std::exp(0.01) * was,
                1e-9);
  }
}

TEST(CalibratedGraphTest, DerivativeOfBeingCarried) {
  NoisyRoom room = MakeNoisyRoom();
  CalibratedGraph calibrated(&room.graph);
  calibrated.Set(SomeTheta(), room.graph.poses());
  const std::vector<double> poses = room.graph.poses();
  for (int p = 0; p < kNumCalibrationParameters; ++p) {
    constexpr double kStep = 1e-6;
    const CalibrationVector step = kStep * CalibrationVector::Unit(p);
    const std::vector<double> more = calibrated.Carried(SomeTheta() + step, poses);
    const std::vector<double> less = calibrated.Carried(SomeTheta() - step, poses);
    for (int pose = 0; pose < room.graph.num_poses(); ++pose) {
      for (int i = 0; i < 3; ++i) {
        const double numeric = (more[3 * pose + i] - less[3 * pose + i]) / (2.0 * kStep);
        EXPECT_NEAR(calibrated.CarriedBy(pose)(i, p), numeric, 1e-7) << pose << " by " << p;
      }
    }
  }
}

// Errors count in units of what the sensors read, so that nothing is gained by shrinking.
TEST(CalibratedGraphTest, ScalesDoNotChangeWhatErrorsCost) {
  NoisyRoom room = MakeNoisyRoom();
  const FactorOptions factors;
  CalibratedGraph calibrated(&room.graph);
  SlamGraph doubled = room.graph;
  CalibratedGraph calibrated_doubled(&doubled);
  std::vector<double> poses = doubled.poses();
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    poses[i] = 2.0 * poses[i];
    poses[i + 1] = 2.0 * poses[i + 1];
  }
  CalibrationVector theta = CalibrationVector::Zero();
  theta[kLogRangeScale] = theta[kLogOdometryScale] = std::log(2.0);
  calibrated_doubled.Set(theta, poses);
  const auto motion_cost = [&](const CalibratedGraph& graph) {
    PoseTerms terms = graph.Terms(factors);
    terms.priors.clear();
    terms.relative_poses.clear();
    return terms.Cost(graph.graph().poses());
  };
  EXPECT_NEAR(motion_cost(calibrated_doubled), motion_cost(calibrated),
              1e-9 * motion_cost(calibrated));
  EXPECT_DOUBLE_EQ(calibrated_doubled.Noise(factors).StandardDeviation(),
                   2.0 * calibrated.Noise(factors).StandardDeviation());
}

}  // namespace
}  // namespace plumbline
