#include "plumbline/solvers/front_end/surface_points.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

// Five beams straight ahead (to within 0.4 mm per metre), 1 m to 1.4 m long.
SlamGraph RowOfReturns() {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = 5;
  laser.bearing_step_rad = 1e-4;
  graph.AddLaser(laser);
  graph.AddPose(Pose2(5.0, 6.0, 1.0), 0.0);
  graph.AddScan(0, 0, {1.0, 1.1, 1.2, 1.3, 1.4});
  return graph;
}

TEST(SurfacePoints, AreThinnedToTheSpacingInTheFrameOfTheRobot) {
  const MeasuredSurface surface{std::vector<ReturnNormal>(5, ReturnNormal({-1.0, 0.0}))};
  const SurfacePoints points = ThinnedSurfaceOf(RowOfReturns(), 0, surface, 0.15);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[0].position.x(), 1.0, 1e-6);
  EXPECT_NEAR(points[1].position.x(), 1.2, 1e-6);
  EXPECT_NEAR(points[2].position.x(), 1.4, 1e-6);
  EXPECT_NEAR(points[2].normal.x(), -1.0, 1e-9);
}

TEST(SurfacePoints, LeaveOutReturnsWithoutSurface) {
  MeasuredSurface surface{std::vector<ReturnNormal>(5)};
  surface.normals[3] = ReturnNormal({-1.0, 0.0});
  const SurfacePoints points = ThinnedSurfaceOf(RowOfReturns(), 0, surface, 0.01);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].position.x(), 1.3, 1e-6);
}

TEST(SurfacePoints, MoveWithAFrame) {
  const SurfacePoint in_b{{1.0, 0.0}, {1.0, 0.0}};
  const SurfacePoint in_a = Pose2(2.0, 3.0, kPi / 2.0) * in_b;
  EXPECT_NEAR((in_a.position - Eigen::Vector2d(2.0, 4.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((in_a.normal - Eigen::Vector2d(0.0, 1.0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace plumbline
