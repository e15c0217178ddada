#include "plumbline/apps/benchmark/plain_icp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plumbline/apps/benchmark/synthetic_drive.h"

namespace plumbline {
namespace {

class PlainIcpTest : public testing::Test {
 protected:
  PlainIcpTest() { EXPECT_TRUE(MakeSyntheticDrive(2, {"", 0.0, 0.0, 1.0}, &drive_).ok()); }

  // Mean position error [m] of matches of consecutive scans that start at the truth.
  double MeanErrorFromTruth(double gate_m) const {
    const PlainIcp icp(drive_.graph);
    double sum_m = 0.0;
    for (int from = 0; from + 1 < drive_.graph.num_scans(); ++from) {
      const Pose2 exact = Between(drive_.truth.poses[from], drive_.truth.poses[from + 1]);
      const PlainMatch match = icp.Match(from, from + 1, exact, {gate_m});
      sum_m += (match.from_from_to.translation() - exact.translation()).norm();
    }
    return sum_m / (drive_.graph.num_scans() - 1);
  }

  SyntheticDrive drive_;
};

TEST_F(PlainIcpTest, RecoversTheMotionBetweenTwoCopiesOfAScan) {
  const Pose2 motion(0.3, -0.2, 0.1);
  SlamGraph graph;
  const int laser = graph.AddLaser(drive_.graph.LaserOfScan(0));
  std::vector<Eigen::Vector2d> points, moved;
  for (std::size_t i = 0; i < drive_.graph.scan(0).num_returns; i += 2) {
    points.push_back(drive_.graph.PointInRobot(i));
    moved.push_back(motion.Inverse() * points.back());
  }
  const int from = graph.AddPose(Pose2(), 0.0);
  const int to = graph.AddPose(Pose2(), 1.0);
  graph.AddPoints(from, laser, points);
  graph.AddPoints(to, laser, moved);
  const PlainMatch match = PlainIcp(graph).Match(0, 1, Pose2(), PlainIcpOptions());
  EXPECT_TRUE(match.converged);
  EXPECT_EQ(match.matched_ratio, 1.0);
  EXPECT_NEAR(match.from_from_to.x, motion.x, 1e-3);
  EXPECT_NEAR(match.from_from_to.y, motion.y, 1e-3);
  EXPECT_NEAR(match.from_from_to.yaw, motion.yaw, 1e-3);
  EXPECT_LT(match.covariance.trace(), 1e-6);
  EXPECT_GT(match.covariance.determinant(), 0.0);
}

TEST_F(PlainIcpTest, AWideGatePullsScansThatOverlapInPart) {
  const double narrow_m = MeanErrorFromTruth(0.1), wide_m = MeanErrorFromTruth(1.8);
  EXPECT_LT(narrow_m, 0.05);
  EXPECT_GT(wide_m, 3.0 * narrow_m);
}

TEST_F(PlainIcpTest, ANarrowGateDoesNotCorrectALargeErrorOfTheGuess) {
  const PlainIcp icp(drive_.graph);
  const Pose2 guess(0.6, 0.0, 0.0);  // of a scan in itself
  const auto error_m = [&](double gate_m) {
    return icp.Match(0, 0, guess, {gate_m}).from_from_to.translation().norm();
  };
  EXPECT_LT(error_m(1.8), 0.01);
  EXPECT_GT(error_m(0.1), 0.3);
}

TEST_F(PlainIcpTest, WithoutCorrespondencesTheGuessStands) {
  const PlainIcp icp(drive_.graph);
  const PlainMatch match = icp.Match(0, 1, Pose2(100.0, 2.0, 0.3), PlainIcpOptions());
  EXPECT_FALSE(match.converged);
  EXPECT_EQ(match.matched_ratio, 0.0);
  EXPECT_EQ(match.from_from_to.x, 100.0);
  EXPECT_EQ(match.from_from_to.yaw, 0.3);
  EXPECT_TRUE(match.covariance.isIdentity());
  // Over a drive, that is the odometry.
  const std::vector<Pose2> poses = ChainEdges(drive_.graph, icp.MatchConsecutive({1e-9}));
  ASSERT_EQ(poses.size(), 16u);
  for (int i = 0; i < 16; ++i) {
    EXPECT_NEAR(poses[i].x, drive_.graph.InitialPose(i).x, 1e-9);
    EXPECT_NEAR(poses[i].y, drive_.graph.InitialPose(i).y, 1e-9);
  }
}

}  // namespace
}  // namespace plumbline
