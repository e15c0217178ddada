#include "plumbline/solvers/front_end/scan_matcher.h"

#include <gtest/gtest.h>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

TEST(ScanMatcher, FindsThePoseInARoomFromAfar) {
  SyntheticScene scene = Room();
  const Pose2 truth(0.3, -0.2, 0.1);
  scene.poses = {Pose2(), truth};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  LocalMap map(0.03);
  map.Rebuild({&surfaces[0]}, {Pose2()});
  const ScanMatch match = MatchScan(map, surfaces[1], PosePrediction(), ScanMatchOptions());
  EXPECT_LT(DistanceM(match.world_from_robot, truth), 2e-3);
  EXPECT_NEAR(match.world_from_robot.yaw, truth.yaw, 1e-3);
  EXPECT_GT(match.inlier_ratio, 0.9);
}

TEST(ScanMatcher, DescribesTheFitThroughTheFineGateWhereverItStops) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.05, 0.0, 0.0)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  LocalMap map(0.03);
  map.Rebuild({&surfaces[0]}, {Pose2()});
  // The scan once more, 0.3 m off its surfaces: only the coarse gate lets that in.
  SurfacePoints scan = surfaces[1];
  const std::size_t num_sound = scan.size();
  for (std::size_t i = 0; i < num_sound; ++i) {
    SurfacePoint point = scan[i];
    point.position += 0.3 * point.normal;
    scan.push_back(point);
  }
  ScanMatchOptions hasty;
  hasty.max_iterations = 1;
  for (const ScanMatchOptions& options : {ScanMatchOptions(), hasty}) {
    const ScanMatch match = MatchScan(map, scan, PosePrediction(), options);
    EXPECT_GT(match.inlier_ratio, 0.4);
    EXPECT_LT(match.inlier_ratio, 0.6);
  }
}

TEST(ScanMatcher, HasNoInformationAlongACorridor) {
  SyntheticScene scene;
  scene.faces = {{{-200.0, 1.0}, {200.0, 1.0}}, {{-200.0, -1.0}, {200.0, -1.0}}};
  scene.poses = {Pose2(), Pose2(0.5, 0.1, 0.05)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  LocalMap map(0.03);
  map.Rebuild({&surfaces[0]}, {Pose2()});
  PosePrediction prediction;
  prediction.world_from_robot = {0.4, 0.0, 0.0};
  prediction.information = Eigen::Vector3d(100.0, 100.0, 100.0).asDiagonal();
  const ScanMatch match = MatchScan(map, surfaces[1], prediction, ScanMatchOptions());
  EXPECT_LT(match.information(0, 0), 1e-3 * match.information(1, 1));
  // Across: the walls decide. Along: the prediction stands.
  EXPECT_NEAR(match.world_from_robot.y, 0.1, 2e-3);
  EXPECT_NEAR(match.world_from_robot.yaw, 0.05, 1e-3);
  EXPECT_NEAR(match.world_from_robot.x, 0.4, 0.02);
}

TEST(ScanMatcher, ReturnsThePredictionWithoutAMap) {
  const SurfacePoints scan{{{1.0, 0.0}, {-1.0, 0.0}}};
  PosePrediction prediction;
  prediction.world_from_robot = {1.0, 2.0, 3.0};
  const ScanMatch match = MatchScan(LocalMap(0.03), scan, prediction, ScanMatchOptions());
  EXPECT_EQ(match.world_from_robot.x, 1.0);
  EXPECT_EQ(match.world_from_robot.yaw, 3.0);
  EXPECT_EQ(match.inlier_ratio, 0.0);
  EXPECT_TRUE(match.information.isZero());
}

TEST(ScanMatcher, Chi2ComparesPredictions) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.2, 0.0, 0.0)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  LocalMap map(0.03);
  map.Rebuild({&surfaces[0]}, {Pose2()});
  PosePrediction forward, backward;
  forward.world_from_robot.x = 0.2;
  backward.world_from_robot.x = -0.2;
  forward.information = backward.information = 100.0 * Eigen::Matrix3d::Identity();
  const ScanMatch right = MatchScan(map, surfaces[1], forward, ScanMatchOptions());
  const ScanMatch wrong = MatchScan(map, surfaces[1], backward, ScanMatchOptions());
  // Both find the true pose; the wrong prediction is 0.4 m = 4 standard deviations off.
  EXPECT_NEAR(wrong.chi2 - right.chi2, 16.0, 1.0);
}

TEST(ScanMatcher, MeasuresAFitAsItFindsIt) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.05, 0.0, 0.0)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  LocalMap map(0.03);
  map.Rebuild({&surfaces[0]}, {Pose2()});
  const ScanMatch match = MatchScan(map, surfaces[1], PosePrediction(), ScanMatchOptions());
  EXPECT_TRUE(match.converged);
  const ScanMatch fit = MeasureFit(map, surfaces[1], match.world_from_robot, ScanMatchOptions());
  EXPECT_EQ(fit.world_from_robot.x, match.world_from_robot.x);
  EXPECT_NEAR(fit.inlier_ratio, match.inlier_ratio, 0.01);
  EXPECT_NEAR(fit.chi2, match.chi2, 0.05 * match.chi2);
  EXPECT_TRUE(fit.information.isApprox(match.information, 0.02));
  ScanMatchOptions hasty;
  hasty.max_iterations = 1;
  EXPECT_FALSE(MatchScan(map, surfaces[1], PosePrediction(), hasty).converged);
  EXPECT_EQ(MeasureFit(LocalMap(0.03), surfaces[1], Pose2(), hasty).inlier_ratio, 0.0);
}

}  // namespace
}  // namespace plumbline
