#include "plumbline/apps/io/pose_timeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

void ExpectPose(const std::optional<Pose2>& pose, double x, double y, double yaw) {
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(pose->x, x, 1e-12);
  EXPECT_NEAR(pose->y, y, 1e-12);
  EXPECT_NEAR(NormalizeAngle(pose->yaw - yaw), 0.0, 1e-12);
}

TEST(PoseTimelineTest, FindsTheNearestPose) {
  const PoseTimeline timeline({{2.0, {2.0, 0.0, 0.0}}, {1.0, {1.0, 0.0, 0.0}}});
  EXPECT_EQ(timeline.Nearest(1.2, 0.3)->timestamp_s, 1.0);
  EXPECT_EQ(timeline.Nearest(1.5, 1.0)->timestamp_s, 1.0);
  EXPECT_EQ(timeline.Nearest(9.0, 7.0)->timestamp_s, 2.0);
  EXPECT_EQ(timeline.Nearest(1.5, 0.4), nullptr);
  EXPECT_EQ(PoseTimeline({}).Nearest(1.0, 9.0), nullptr);
}

TEST(PoseTimelineTest, InterpolatesStraightDrives) {
  const PoseTimeline timeline({{10.0, {1.0, 1.0, DegToRad(90.0)}},
                               {12.0, {1.0, 3.0, DegToRad(90.0)}},
                               {13.0, {2.0, 3.0, DegToRad(90.0)}}});
  ExpectPose(timeline.Interpolate(10.0, 0.1), 1.0, 1.0, DegToRad(90.0));
  ExpectPose(timeline.Interpolate(10.5, 2.0), 1.0, 1.5, DegToRad(90.0));
  ExpectPose(timeline.Interpolate(12.25, 2.0), 1.25, 3.0, DegToRad(90.0));  // sideways
  ExpectPose(timeline.Interpolate(13.0, 2.0), 2.0, 3.0, DegToRad(90.0));
}

// On a circle of 2 m, across the cut at 180 deg: a robot that looks along the tangent.
TEST(PoseTimelineTest, InterpolatesAlongArcs) {
  const auto on_circle = [](double angle) {
    return Pose2(2.0 * std::cos(angle), 2.0 * std::sin(angle), NormalizeAngle(angle + 0.5 * kPi));
  };
  const PoseTimeline timeline({{0.0, on_circle(1.0)}, {1.0, on_circle(2.5)}});
  for (const double share : {0.1, 0.5, 0.9}) {
    const Pose2 expected = on_circle(1.0 + 1.5 * share);
    ExpectPose(timeline.Interpolate(share, 1.0), expected.x, expected.y, expected.yaw);
  }
  const PoseTimeline on_the_spot({{0.0, {1.0, 2.0, 3.0}}, {1.0, {1.0, 2.0, -3.0}}});
  ExpectPose(on_the_spot.Interpolate(0.5, 1.0), 1.0, 2.0, kPi);
}

TEST(PoseTimelineTest, DoesNotGuessBeyondTheEndsAndAcrossGaps) {
  const PoseTimeline timeline({{1.0, {}}, {2.0, {1.0, 0.0, 0.0}}, {9.0, {2.0, 0.0, 0.0}}});
  EXPECT_FALSE(timeline.Interpolate(0.999, 1.0));
  EXPECT_FALSE(timeline.Interpolate(9.001, 1.0));
  EXPECT_FALSE(timeline.Interpolate(2.1, 1.0));
  EXPECT_TRUE(timeline.Interpolate(2.1, 7.0));
  EXPECT_TRUE(timeline.Interpolate(1.5, 1.0));
  EXPECT_FALSE(PoseTimeline({}).Interpolate(1.0, 1.0));
}

// The same stamp twice, as some drivers send it.
TEST(PoseTimelineTest, BearsPosesOfOneTime) {
  const PoseTimeline timeline({{1.0, {}}, {1.0, {}}, {2.0, {1.0, 0.0, 0.0}}});
  ExpectPose(timeline.Interpolate(1.0, 1.0), 0.0, 0.0, 0.0);
  ExpectPose(timeline.Interpolate(1.5, 1.0), 0.5, 0.0, 0.0);
}

}  // namespace
}  // namespace plumbline
