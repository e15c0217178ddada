#include "plumbline/apps/benchmark/map_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace plumbline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(MapErrors, PutsTheFirstPosesOnEachOther) {
  const MapEstimate truth{{{0, 0, 0}, {2, 0, 0}}, {1, 1, kNaN, kNaN, 3, 0}};
  // The same map from elsewhere, but the second pose is 0.3 m and 0.1 rad off, the last point 0.5
  // m.
  const Pose2 moved(5.0, -2.0, 2.0);
  MapEstimate estimate;
  estimate.poses = {moved, moved * Pose2(2.0, 0.3, -0.1)};
  for (const Eigen::Vector2d& point :
       {Eigen::Vector2d(1, 1), Eigen::Vector2d(7, 7), Eigen::Vector2d(3.3, 0.4)}) {
    const Eigen::Vector2d elsewhere = moved * point;
    estimate.points.insert(estimate.points.end(), {elsewhere.x(), elsewhere.y()});
  }
  const MapErrors errors = MeasureMapErrors(estimate, truth);
  ASSERT_EQ(errors.pose_m.size(), 2u);
  EXPECT_NEAR(errors.pose_m[0], 0.0, 1e-12);
  EXPECT_NEAR(errors.pose_m[1], 0.3, 1e-12);
  EXPECT_NEAR(errors.heading_rad[1], 0.1, 1e-12);
  ASSERT_EQ(errors.point_m.size(), 3u);
  EXPECT_NEAR(errors.point_m[0], 0.0, 1e-12);
  EXPECT_TRUE(std::isnan(errors.point_m[1]));
  EXPECT_NEAR(errors.point_m[2], 0.5, 1e-12);
  EXPECT_NEAR(MeanAndVarianceOf(errors.point_m).mean, 0.25, 1e-12);
}

TEST(MapErrors, MeanAndVarianceLeaveOutWhatIsUnknown) {
  const MeanAndVariance figures = MeanAndVarianceOf({1.0, kNaN, 3.0, 8.0});
  EXPECT_DOUBLE_EQ(figures.mean, 4.0);
  EXPECT_DOUBLE_EQ(figures.variance, 26.0 / 3.0);
  EXPECT_TRUE(std::isnan(MeanAndVarianceOf({kNaN}).mean));
}

TEST(MapErrors, QuartilesLieBetweenNeighbours) {
  const Quartiles odd = QuartilesOf({5.0, 1.0, 4.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(odd.low, 2.0);
  EXPECT_DOUBLE_EQ(odd.median, 3.0);
  EXPECT_DOUBLE_EQ(odd.high, 4.0);
  const Quartiles even = QuartilesOf({4.0, 1.0, 3.0, 2.0});
  EXPECT_DOUBLE_EQ(even.low, 1.75);
  EXPECT_DOUBLE_EQ(even.median, 2.5);
  EXPECT_DOUBLE_EQ(even.high, 3.25);
  EXPECT_DOUBLE_EQ(QuartilesOf({7.0}).high, 7.0);
  EXPECT_TRUE(std::isnan(QuartilesOf({}).median));
  EXPECT_DOUBLE_EQ(QuartilesOf({kNaN, 4.0, 1.0, kNaN, 3.0, 2.0}).median, 2.5);
  EXPECT_TRUE(std::isnan(QuartilesOf({kNaN}).median));
}

}  // namespace
}  // namespace plumbline
