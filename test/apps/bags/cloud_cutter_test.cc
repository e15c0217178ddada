#include "plumbline/apps/bags/cloud_cutter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector3d PointAt(double range_m, double bearing_rad, double height_m) {
  return {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), height_m};
}

// The cloud of a planar laser, with beams of 0.25 deg over 270 deg; every seventh has no return.
RosCloud PlanarCloud(double height_m) {
  RosCloud cloud;
  cloud.stamp_s = 12.5;
  cloud.frame = "lidar";
  for (int i = 0; i < 1081; ++i) {
    const double bearing_rad = DegToRad(-135.0 + 0.25 * i);
    if (i % 7 != 0) cloud.points.push_back(PointAt(2.0 + 0.001 * i, bearing_rad, height_m));
  }
  return cloud;
}

TEST(CloudCutterTest, AllPointsOfAPlanarLaserAreKeptAsTheyAre) {
  const RosCloud cloud = PlanarCloud(0.4);
  CloudCutter cutter(std::nullopt);
  RosScan scan;
  std::string fault;
  ASSERT_TRUE(cutter.Cut(cloud, &scan, &fault)) << fault;
  EXPECT_EQ(scan.stamp_s, 12.5);
  EXPECT_EQ(scan.frame, "lidar");
  ASSERT_EQ(scan.ranges.size(), cloud.points.size());
  ASSERT_EQ(scan.bearings_rad.size(), cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_NEAR(scan.ranges[i] * std::cos(scan.bearings_rad[i]), cloud.points[i].x(), 1e-12);
    EXPECT_NEAR(scan.ranges[i] * std::sin(scan.bearings_rad[i]), cloud.points[i].y(), 1e-12);
  }
  // Beams all around, with the spacing of the laser.
  EXPECT_NEAR(RadToDeg(scan.angle_increment_rad), 0.25, 1e-9);
  const double beam = (DegToRad(-134.75) - scan.angle_min_rad) / scan.angle_increment_rad;
  EXPECT_NEAR(beam, std::round(beam), 1e-6);
}

TEST(CloudCutterTest, TheFirstCloudTellsTheBeams) {
  CloudCutter cutter(std::nullopt);
  RosScan scan, other;
  std::string fault;
  RosCloud few = PlanarCloud(0.0);
  few.points.resize(5);
  ASSERT_TRUE(cutter.Cut(few, &scan, &fault));
  ASSERT_TRUE(cutter.Cut(PlanarCloud(0.0), &scan, &fault));
  ASSERT_TRUE(cutter.Cut(few, &other, &fault));
  EXPECT_EQ(other.angle_increment_rad, scan.angle_increment_rad);
  EXPECT_EQ(other.angle_min_rad, scan.angle_min_rad);
}

TEST(CloudCutterTest, AnOddNumberOfBeamsFitsToo) {
  RosCloud cloud;
  for (int i = 0; i < 721; ++i) cloud.points.push_back(PointAt(3.0, 2.0 * kPi * i / 721 - 3.0, 0));
  CloudCutter cutter(std::nullopt);
  RosScan scan;
  std::string fault;
  ASSERT_TRUE(cutter.Cut(cloud, &scan, &fault));
  EXPECT_NEAR(2.0 * kPi / scan.angle_increment_rad, 721.0, 1e-6);
  const double beam = (-3.0 - scan.angle_min_rad) / scan.angle_increment_rad;
  EXPECT_NEAR(beam, std::round(beam), 1e-6);
}

TEST(CloudCutterTest, WithoutABandACloudOfSeveralHeightsIsRefused) {
  RosCloud cloud = PlanarCloud(0.4);
  cloud.points.push_back(PointAt(3.0, 0.0, -0.75));
  CloudCutter cutter(std::nullopt);
  RosScan scan;
  std::string fault;
  EXPECT_FALSE(cutter.Cut(cloud, &scan, &fault));
  EXPECT_EQ(
      fault,
      "it has points at heights from -0.75 to 0.4 m in 'lidar', as a 3D laser gives: choose a "
      "band of them by --slice_height_m=LOW,HIGH");
}

TEST(CloudCutterTest, InABandTheNearestPointOfADirectionCounts) {
  RosCloud cloud;
  cloud.points = {PointAt(5.0, 0.5, 0.0),   PointAt(4.0, 0.5, 0.3),  PointAt(3.0, 0.5, 0.31),
                  PointAt(2.0, 0.5, -0.31), PointAt(6.0, -1.0, 0.1), {0.0, 0.0, 0.0},
                  {kNan, 1.0, 0.0},         PointAt(7.0, kPi, -0.3)};
  CloudCutter cutter(HeightBand{-0.3, 0.3});
  RosScan scan;
  std::string fault;
  ASSERT_TRUE(cutter.Cut(cloud, &scan, &fault)) << fault;
  EXPECT_THAT(scan.ranges, ElementsAre(testing::DoubleEq(6.0), 4.0, 7.0));
  EXPECT_THAT(scan.bearings_rad, ElementsAre(testing::DoubleEq(-1.0), 0.5, kPi));
}

TEST(CloudCutterTest, ACloudWithoutPointsIsAScanWithoutReturns) {
  for (const std::optional<HeightBand> band : {std::optional<HeightBand>(), {{5.0, 6.0}}}) {
    CloudCutter cutter(band);
    RosScan scan;
    std::string fault;
    ASSERT_TRUE(cutter.Cut(band ? PlanarCloud(0.0) : RosCloud(), &scan, &fault)) << fault;
    EXPECT_THAT(scan.ranges, ElementsAre(std::numeric_limits<double>::infinity()));
    EXPECT_EQ(scan.bearings_rad.size(), 1u);
  }
}

TEST(HeightBandTest, IsFiniteAndNotEmpty) {
  EXPECT_TRUE((HeightBand{-0.5, 0.5}.Check(nullptr)));
  std::string error;
  for (const HeightBand& band : {HeightBand{0.5, 0.5}, HeightBand{0.5, -0.5}, HeightBand{kNan, 1.0},
                                 HeightBand{0.0, kNan}}) {
    EXPECT_FALSE(band.Check(&error));
    EXPECT_THAT(error, HasSubstr("slice_height_m"));
  }
}

}  // namespace
}  // namespace plumbline
