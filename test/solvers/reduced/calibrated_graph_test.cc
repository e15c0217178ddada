#include "plumbline/solvers/reduced/calibrated_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

CalibrationVector SomeTheta() {
  CalibrationVector theta;
  theta << 0.04, -0.03, 0.05, 0.02, 0.01, -0.03;
  return theta;
}

TEST(CalibratedGraphTest, CorrectsWhatTheSensorsSay) {
  const NoisyRoom room = MakeNoisyRoom();
  const SlamGraph& given = room.graph;
  CalibratedGraph calibrated(given, room.state.poses);
  const SlamGraph& corrected = calibrated.graph();
  calibrated.Set(SomeTheta(), room.state.poses);
  const Pose2 mounting = corrected.laser(0).robot_from_laser;
  EXPECT_DOUBLE_EQ(mounting.x, given.laser(0).robot_from_laser.x + 0.04);
  EXPECT_DOUBLE_EQ(mounting.y, given.laser(0).robot_from_laser.y - 0.03);
  EXPECT_DOUBLE_EQ(mounting.yaw, given.laser(0).robot_from_laser.yaw + 0.05);
  EXPECT_FLOAT_EQ(corrected.returns().range_m[9],
                  std::exp(0.01) * (given.returns().range_m[9] + 0.02));
  EXPECT_DOUBLE_EQ(corrected.odometry()[3].from_from_to.y,
                   std::exp(-0.03) * given.odometry()[3].from_from_to.y);
  EXPECT_EQ(corrected.odometry()[3].from_from_to.yaw, given.odometry()[3].from_from_to.yaw);

  // Back, without a trace.
  calibrated.Set(CalibrationVector::Zero(), room.state.poses);
  EXPECT_EQ(corrected.returns().range_m, given.returns().range_m);
  EXPECT_TRUE(corrected.laser(0) == given.laser(0));
  for (std::size_t i = 0; i < given.odometry().size(); ++i) {
    EXPECT_EQ(corrected.odometry()[i].from_from_to.x, given.odometry()[i].from_from_to.x);
  }
}

TEST(CalibratedGraphTest, CarriesTheMapAlong) {
  NoisyRoom room = MakeNoisyRoom();
  room.graph.FixPose(4);
  CalibratedGraph calibrated(room.graph, room.state.poses);
  CalibrationVector theta = SomeTheta();
  theta[kRangeBias] = 0.0;
  calibrated.Set(theta, calibrated.Carried(theta, room.state.poses));
  const MapState carried{calibrated.poses(), calibrated.graph().MeasuredMap(calibrated.poses())};
  const Pose2 anchor = carried.WorldFromRobot(4), before = room.state.WorldFromRobot(4);
  EXPECT_NEAR(anchor.x, before.x, 1e-12);
  EXPECT_NEAR(anchor.y, before.y, 1e-12);
  EXPECT_NEAR(anchor.yaw, before.yaw, 1e-12);
  // All distances between points, of whatever scans, have grown by the same factor.
  for (std::size_t r = 1; r < room.graph.num_returns(); r += 37) {
    const double was = (MapPoint(room.state, r) - MapPoint(room.state, 0)).norm();
    EXPECT_NEAR((MapPoint(carried, r) - MapPoint(carried, 0)).norm(), std::exp(0.01) * was, 1e-6);
  }
}

TEST(CalibratedGraphTest, DerivativeOfBeingCarried) {
  const NoisyRoom room = MakeNoisyRoom();
  const std::vector<double>& poses = room.state.poses;
  CalibratedGraph calibrated(room.graph, poses);
  calibrated.Set(SomeTheta(), poses);
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
  const NoisyRoom room = MakeNoisyRoom();
  const FactorOptions factors;
  const CalibratedGraph calibrated(room.graph, room.state.poses);
  CalibratedGraph calibrated_doubled(room.graph, room.state.poses);
  std::vector<double> poses = room.state.poses;
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    poses[i] = 2.0 * poses[i];
    poses[i + 1] = 2.0 * poses[i + 1];
  }
  CalibrationVector theta = CalibrationVector::Zero();
  theta[kLogRangeScale] = theta[kLogOdometryScale] = std::log(2.0);
  calibrated_doubled.Set(theta, poses);
  const auto motion_cost = [&](const CalibratedGraph& graph) {
    PoseTerms terms = graph.Terms(factors);
    terms.terms.resize(1);
    EXPECT_EQ(terms.terms.front()->name(), "motion");
    return terms.Cost(graph.poses());
  };
  EXPECT_NEAR(motion_cost(calibrated_doubled), motion_cost(calibrated),
              1e-9 * motion_cost(calibrated));
  EXPECT_DOUBLE_EQ(calibrated_doubled.Noise(factors).StandardDeviation(),
                   2.0 * calibrated.Noise(factors).StandardDeviation());
}

}  // namespace
}  // namespace plumbline
