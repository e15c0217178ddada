#include "plumbline/solvers/front_end/odometry_sign.h"

#include <gtest/gtest.h>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

// Ten steps of 0.1 m forward, and `num_back` backward.
OdometrySignReport CheckedSign(int num_back, bool keep_sign) {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  double x = -0.5;
  scene.poses.emplace_back(x, 0.1, 0.0);
  for (int i = 0; i < 10; ++i) scene.poses.emplace_back(x += 0.1, 0.1, 0.0);
  for (int i = 0; i < num_back; ++i) scene.poses.emplace_back(x -= 0.1, 0.1, 0.0);
  SlamGraph graph = MakeGraph(scene);
  AddOdometry([&](const Pose2& step) { return keep_sign ? step : Pose2(std::abs(step.x), 0, 0); },
              &graph);
  ThreadPool pool(2);
  return CheckOdometrySign(ScanSurfaces(graph, Packed(SurfacesOf(graph))), &pool);
}

TEST(OdometrySign, RecognisesALostSign) {
  const OdometrySignReport report = CheckedSign(8, false);
  EXPECT_TRUE(report.sign_lost);
  EXPECT_EQ(report.num_backward_steps, 0);
  EXPECT_EQ(report.num_decided, 18);
  EXPECT_EQ(report.num_contradicting, 6);  // each of eight that two more follow
}

TEST(OdometrySign, TrustsAnOdometryThatGoesBackward) {
  const OdometrySignReport report = CheckedSign(8, true);
  EXPECT_FALSE(report.sign_lost);
  EXPECT_EQ(report.num_backward_steps, 8);
}

TEST(OdometrySign, TrustsARobotThatNeverBacksUp) {
  const OdometrySignReport report = CheckedSign(0, false);
  EXPECT_FALSE(report.sign_lost);
  EXPECT_EQ(report.num_decided, 10);
  EXPECT_EQ(report.num_contradicting, 0);
}

}  // namespace
}  // namespace plumbline
