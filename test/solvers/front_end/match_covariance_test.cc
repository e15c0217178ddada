#include <gtest/gtest.h>

#include "plumbline/core/rotate_axes.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/test/factors/factor_testing.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

// Of the last of three scans, 0.3 m apart, matched to the others. World axes.
Eigen::Matrix3d CovarianceIn(SyntheticScene scene, double yaw) {
  scene.range_sigma_m = 0.02;
  for (int i = 0; i < 3; ++i) {
    scene.poses.push_back(Pose2(0.0, 0.0, yaw) * Pose2(0.3 * i, 0.0, 0.0));
  }
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  LocalMap map(0.03);
  map.Rebuild(std::vector<const SurfacePoints*>{&surfaces[0], &surfaces[1]},
              {scene.poses[0], scene.poses[1]});
  PosePrediction prediction;
  prediction.world_from_robot = scene.poses[2];
  return MatchCovariance(MatchScan(map, surfaces[2], prediction, ScanMatchOptions()).information);
}

// Two walls 2 m apart, at an angle to the world's axes. Their ends are out of sight.
SyntheticScene Corridor(double yaw) {
  const Pose2 world_from_corridor(0.0, 0.0, yaw);
  const auto at = [&](double x, double y) { return world_from_corridor * Eigen::Vector2d(x, y); };
  SyntheticScene scene;
  scene.faces = {{at(-50.0, 1.0), at(50.0, 1.0)}, {at(-50.0, -1.0), at(50.0, -1.0)}};
  scene.laser.max_range_m = 8.0;
  return scene;
}

TEST(MatchCovariance, TenPointsCountAsOneAboveAFloor) {
  const Eigen::Matrix3d points = Eigen::Vector3d(0.0, 1e5, 1e6).asDiagonal();
  const Eigen::Matrix3d alone = MatchCovariance(points);
  EXPECT_NEAR(alone(1, 1), 1e-4 + 0.003 * 0.003, 1e-8);
  EXPECT_NEAR(alone(2, 2), 1e-5 + 0.001 * 0.001, 1e-9);
  EXPECT_GT(alone(0, 0), 1.0);
  const Eigen::Matrix3d odometry = Eigen::Vector3d(1e4, 1e4, 0.0).asDiagonal();
  const Eigen::Matrix3d both = MatchCovariance(points, odometry);
  EXPECT_NEAR(both(0, 0), 1e-4 + 0.003 * 0.003, 1e-8);
  EXPECT_NEAR(both(1, 1), 0.5e-4 + 0.003 * 0.003, 1e-8);
  EXPECT_NEAR(both(2, 2), alone(2, 2), 1e-12);
}

TEST(MatchCovariance, KnowsNothingAlongACorridor) {
  for (const double yaw : {0.0, 0.6}) {
    const Eigen::Matrix3d covariance = RotateAxes(CovarianceIn(Corridor(yaw), yaw), -yaw);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance.topLeftCorner<2, 2>());
    EXPECT_LT(axes.eigenvalues()(0), 0.01 * 0.01) << yaw;
    EXPECT_GT(axes.eigenvalues()(1), 1.0) << yaw;
    // Noise turns the axis a little.
    EXPECT_NEAR(std::abs(axes.eigenvectors()(0, 1)), 1.0, 1e-3) << yaw;
    EXPECT_LT(covariance(2, 2), 0.01 * 0.01) << yaw;
  }
}

TEST(MatchCovariance, KnowsAllOfARoom) {
  const Eigen::Matrix3d covariance = CovarianceIn(Room(), 0.6);
  for (int i = 0; i < 3; ++i) EXPECT_LT(covariance(i, i), 0.01 * 0.01) << i;
}

TEST(MatchCovariance, IsSymmetricPositiveDefinite) {
  RandomStates random(3);
  for (int i = 0; i < 50; ++i) {
    // Two directions of very different weight, and a third that is not known at all.
    Eigen::Matrix3d points = Eigen::Matrix3d::Zero();
    for (const double weight : {1e6, random.Uniform(0.0, 1e5)}) {
      const Eigen::Vector2d normal = random.Direction();
      const Eigen::Vector3d row(normal.x(), normal.y(), random.Uniform(-5.0, 5.0));
      points += weight * row * row.transpose();
    }
    const Eigen::Matrix3d covariance = MatchCovariance(points);
    EXPECT_EQ(covariance, covariance.transpose());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()(0), 0.0);
  }
}

}  // namespace
}  // namespace plumbline
