#include "plumbline/apps/benchmark/synthetic_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

SyntheticDrive DriveOf(std::uint64_t seed, const SyntheticNoise& noise) {
  SyntheticDrive drive;
  EXPECT_TRUE(MakeSyntheticDrive(seed, noise, &drive).ok());
  return drive;
}

TEST(SyntheticDrive, HasSixteenScansOnceAroundABlock) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SyntheticDrive drive = DriveOf(seed, {"", 0.03, 0.002, 1.0});
    ASSERT_EQ(drive.graph.num_scans(), 16);
    EXPECT_EQ(drive.log.laser.num_beams, 720);
    EXPECT_NEAR(drive.log.path_length_m, 36.0, 5.0);
    // All at right angles.
    for (const Face& face : drive.building.faces) {
      const Eigen::Vector2d along = (face.b - face.a).cwiseAbs();
      EXPECT_LT(along.minCoeff(), 1e-9);
    }
    // It comes back to where it has been.
    double nearest_m = 1e9;
    for (int i = 0; i < 4; ++i) {
      const Pose2 apart = Between(drive.truth.poses[i], drive.truth.poses.back());
      nearest_m = std::min(nearest_m, apart.translation().norm());
    }
    EXPECT_LT(nearest_m, 2.5);
  }
}

TEST(SyntheticDrive, TheTruthIsWhereTheBeamsEnd) {
  const SyntheticDrive drive = DriveOf(3, {"", 0.0, 0.0, 1.0});
  const std::vector<double> placed = PlacedReturns(drive.graph, drive.truth.poses);
  ASSERT_EQ(placed.size(), drive.truth.points.size());
  std::size_t num_known = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (std::isnan(drive.truth.points[i])) continue;
    ++num_known;
    ASSERT_NEAR(placed[i], drive.truth.points[i], 6e-4);  // ranges are in mm
  }
  EXPECT_GT(num_known, 0.99 * static_cast<double>(placed.size()));
}

TEST(SyntheticDrive, NoiseLeavesBuildingAndPathAlone) {
  const SyntheticDrive a = DriveOf(2, {"", 0.02, 0.002, 1.0});
  const SyntheticDrive b = DriveOf(2, {"", 0.05, 0.002, 0.0});
  EXPECT_EQ(a.truth.poses[7].x, b.truth.poses[7].x);
  EXPECT_NE(a.graph.returns().range_m[5], b.graph.returns().range_m[5]);
  EXPECT_NEAR(b.graph.InitialPose(15).y, b.truth.poses[15].y, 1e-9);
  EXPECT_GT(std::abs(a.graph.InitialPose(15).y - a.truth.poses[15].y), 0.1);
  EXPECT_NE(DriveOf(4, {"", 0.02, 0.002, 1.0}).truth.poses[7].x, a.truth.poses[7].x);
}

TEST(SyntheticDrive, RefusesImpossibleNoise) {
  SyntheticDrive drive;
  const Status status = MakeSyntheticDrive(1, {"", -0.1, 0.002, 1.0}, &drive);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), testing::HasSubstr("sigma_range_m"));
}

}  // namespace
}  // namespace plumbline
