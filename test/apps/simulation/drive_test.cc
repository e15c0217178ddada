#include "plumbline/apps/simulation/drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace plumbline {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

Building OpenSpace(const std::vector<Vector2d>& path) {
  Building building;
  building.name = "open.world";
  std::size_t line = 0;
  for (const Vector2d& position : path) building.path.push_back({position, ++line});
  return building;
}

Drive PlanIn(const Building& building, const DriveOptions& options) {
  Drive drive;
  const Status status = Drive::Plan(World(building), options, &drive);
  EXPECT_TRUE(status.ok()) << status.message();
  return drive;
}

void ExpectPose(const Pose2& pose, double x, double y, double yaw) {
  EXPECT_NEAR(pose.x, x, 1e-12);
  EXPECT_NEAR(pose.y, y, 1e-12);
  EXPECT_NEAR(pose.yaw, yaw, 1e-12);
}

TEST(DriveTest, StraightThenLeftThenStraight) {
  DriveOptions options;
  options.speed_m_s = 0.5;
  options.turn_rate_rad_s = 2.0;
  options.corner_radius_m = 1.0;
  const Drive drive = PlanIn(OpenSpace({{0, 0}, {3, 0}, {3, 4}}), options);
  // 2 m to the arc, a quarter of a circle of radius 1 m at 0.5 rad/s, 3 m.
  EXPECT_NEAR(drive.length_m(), 5.0 + kPi / 2, 1e-12);
  EXPECT_NEAR(drive.duration_s(), 10.0 + kPi, 1e-12);
  ExpectPose(drive.WorldFromRobot(0.0), 0.0, 0.0, 0.0);
  ExpectPose(drive.WorldFromRobot(2.0), 1.0, 0.0, 0.0);
  ExpectPose(drive.WorldFromRobot(4.0 + kPi / 2), 2.0 + std::sqrt(0.5), 1.0 - std::sqrt(0.5),
             kPi / 4);
  ExpectPose(drive.WorldFromRobot(4.0 + kPi), 3.0, 1.0, kPi / 2);
  ExpectPose(drive.WorldFromRobot(drive.duration_s()), 3.0, 4.0, kPi / 2);
  EXPECT_EQ(drive.TimeAt(0.0), 0.0);
  EXPECT_NEAR(drive.TimeAt(2.0 + kPi / 4), 4.0 + kPi / 2, 1e-12);
  EXPECT_NEAR(drive.TimeAt(3.0 + kPi / 2), 6.0 + kPi, 1e-12);
  EXPECT_EQ(drive.TimeAt(100.0), drive.duration_s());
}

TEST(DriveTest, SlowsDownWhereTheTurnRateLimitsIt) {
  DriveOptions options;
  options.speed_m_s = 1.0;
  options.turn_rate_rad_s = 0.5;
  options.corner_radius_m = 1.0;
  const Drive drive = PlanIn(OpenSpace({{0, 0}, {3, 0}, {3, -4}}), options);
  EXPECT_NEAR(drive.duration_s(), 5.0 + kPi, 1e-12);
  ExpectPose(drive.WorldFromRobot(drive.duration_s()), 3.0, -4.0, -kPi / 2);
}

TEST(DriveTest, TurnsOnTheSpotWhereThePathGoesBack) {
  DriveOptions options;
  options.speed_m_s = 1.0;
  options.turn_rate_rad_s = 0.5;
  const Drive drive = PlanIn(OpenSpace({{0, 0}, {2, 0}, {0, 0}}), options);
  EXPECT_NEAR(drive.duration_s(), 4.0 + 2.0 * kPi, 1e-12);
  EXPECT_NEAR(drive.length_m(), 4.0, 1e-12);
  ExpectPose(drive.WorldFromRobot(2.0 + kPi), 2.0, 0.0, kPi / 2);
  EXPECT_NEAR(drive.TimeAt(2.0), 2.0, 1e-12);
  EXPECT_NEAR(drive.TimeAt(3.0), 3.0 + 2.0 * kPi, 1e-12);
}

TEST(DriveTest, ArcsShrinkToFitShortLegs) {
  DriveOptions options;
  options.corner_radius_m = 5.0;
  const Drive drive = PlanIn(OpenSpace({{0, 0}, {2, 0}, {2, 2}, {4, 2}}), options);
  // Each corner takes half of the middle leg: 1 m straight, two quarters of radius 1 m, 1 m.
  EXPECT_NEAR(drive.length_m(), 2.0 + kPi, 1e-12);
  ExpectPose(drive.WorldFromRobot(drive.duration_s()), 4.0, 2.0, 0.0);
}

TEST(DriveTest, PathThatCrossesAWallNamesTheLineOfItsWaypoint) {
  Building building = OpenSpace({{0, 0}, {3, 0}, {6, 0}});
  building.faces = {{{4, -1}, {4, 1}}};
  Drive drive;
  const Status status = Drive::Plan(World(building), DriveOptions(), &drive);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("open.world:3: path: "));
  EXPECT_EQ(drive.length_m(), 0.0);
}

TEST(DriveTest, RobotNeedsItsRadius) {
  Building building = OpenSpace({{0, 0}, {4, 0}});
  building.discs = {{{2.0, 1.0}, 0.5}};
  DriveOptions options;
  Drive drive;
  options.robot_radius_m = 0.49;
  EXPECT_TRUE(Drive::Plan(World(building), options, &drive).ok());
  options.robot_radius_m = 0.51;
  const Status status = Drive::Plan(World(building), options, &drive);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("open.world:2: path: "));
  EXPECT_THAT(status.message(), HasSubstr("radius 0.510 m"));
}

TEST(DriveTest, RefusesAMissingPathAndBadOptions) {
  Drive drive;
  EXPECT_THAT(Drive::Plan(World(OpenSpace({})), DriveOptions(), &drive).message(),
              HasSubstr("open.world: path"));
  DriveOptions options;
  options.speed_m_s = 0.0;
  EXPECT_THAT(Drive::Plan(World(OpenSpace({{0, 0}, {1, 0}})), options, &drive).message(),
              HasSubstr("speed_m_s = 0"));
  options = DriveOptions();
  options.turn_rate_rad_s = std::numeric_limits<double>::quiet_NaN();
  std::string error;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_THAT(error, HasSubstr("turn_rate_rad_s"));
}

}  // namespace
}  // namespace plumbline
