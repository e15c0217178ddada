#include "plumbline/core/laser_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace plumbline {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

LaserModel HalfCircleLaser() {
  LaserModel laser;
  laser.num_beams = 181;
  laser.first_bearing_rad = -0.5 * kPi;
  laser.bearing_step_rad = DegToRad(1.0);
  laser.min_range_m = 0.1;
  laser.max_range_m = 50.0;
  return laser;
}

TEST(LaserModel, BearingsCountUpFromTheFirst) {
  const LaserModel laser = HalfCircleLaser();
  EXPECT_DOUBLE_EQ(laser.Bearing(0), -0.5 * kPi);
  EXPECT_NEAR(laser.Bearing(90), 0.0, 1e-15);
  EXPECT_NEAR(laser.Bearing(180), 0.5 * kPi, 1e-15);
}

TEST(LaserModel, AReturnLiesInTheHalfOpenRange) {
  const LaserModel laser = HalfCircleLaser();
  EXPECT_TRUE(laser.IsReturn(0.1));
  EXPECT_TRUE(laser.IsReturn(std::nextafter(50.0, 0.0)));
  EXPECT_FALSE(laser.IsReturn(std::nextafter(0.1, 0.0)));
  EXPECT_FALSE(laser.IsReturn(50.0));
  for (const double bad : {0.0, -1.0, std::nan(""), kInfinity, -kInfinity}) {
    EXPECT_FALSE(laser.IsReturn(bad)) << bad;
  }
}

TEST(LaserModel, BeamEndsOnItsBearing) {
  EXPECT_TRUE(BeamEnd(2.0, 0.5 * kPi).isApprox(Eigen::Vector2d(0.0, 2.0)));
  EXPECT_TRUE(BeamEnd(2.0, kPi / 6.0).isApprox(Eigen::Vector2d(std::sqrt(3.0), 1.0)));
}

TEST(LaserModel, CheckNamesTheCulprit) {
  EXPECT_TRUE(HalfCircleLaser().Check(nullptr));
  const auto expect_error = [](const std::string& name,
                               const std::function<void(LaserModel&)>& damage) {
    LaserModel laser = HalfCircleLaser();
    damage(laser);
    std::string error;
    EXPECT_FALSE(laser.Check(&error)) << name;
    EXPECT_THAT(error, testing::HasSubstr(name));
    EXPECT_FALSE(laser.Check(nullptr)) << name;
  };
  expect_error("num_beams = 0", [](LaserModel& l) { l.num_beams = 0; });
  expect_error("first_bearing_rad = nan", [](LaserModel& l) { l.first_bearing_rad = NAN; });
  expect_error("first_bearing_rad = 90", [](LaserModel& l) { l.first_bearing_rad = 90.0; });
  expect_error("first_bearing_rad = -90", [](LaserModel& l) { l.first_bearing_rad = -90.0; });
  expect_error("bearing_step_rad", [](LaserModel& l) { l.bearing_step_rad = 0.0; });
  expect_error("bearing_step_rad", [](LaserModel& l) { l.bearing_step_rad = -4.0; });
  expect_error("bearing_step_rad", [](LaserModel& l) { l.bearing_step_rad = NAN; });
  expect_error("min_range_m = 0", [](LaserModel& l) { l.min_range_m = 0.0; });
  expect_error("max_range_m = 0.1", [](LaserModel& l) { l.max_range_m = 0.1; });
  expect_error("max_range_m = inf", [](LaserModel& l) { l.max_range_m = kInfinity; });
  expect_error("robot_from_laser", [](LaserModel& l) { l.robot_from_laser.yaw = NAN; });
}

TEST(LaserModel, ClockwiseAndSingleBeamLasersAreFine) {
  LaserModel laser = HalfCircleLaser();
  laser.bearing_step_rad = -laser.bearing_step_rad;
  EXPECT_TRUE(laser.Check(nullptr));
  laser.num_beams = 1;
  laser.bearing_step_rad = 0.0;
  EXPECT_TRUE(laser.Check(nullptr));
  laser.bearing_step_rad = NAN;  // a bearing all the same
  EXPECT_FALSE(laser.Check(nullptr));
}

TEST(LaserModel, EqualityComparesEveryField) {
  EXPECT_TRUE(HalfCircleLaser() == HalfCircleLaser());
  const std::function<void(LaserModel&)> changes[] = {
      [](LaserModel& l) { ++l.num_beams; },
      [](LaserModel& l) { l.first_bearing_rad += 0.1; },
      [](LaserModel& l) { l.bearing_step_rad += 0.1; },
      [](LaserModel& l) { l.min_range_m += 0.1; },
      [](LaserModel& l) { l.max_range_m += 0.1; },
      [](LaserModel& l) { l.robot_from_laser.x += 0.1; },
      [](LaserModel& l) { l.robot_from_laser.y += 0.1; },
      [](LaserModel& l) { l.robot_from_laser.yaw += 0.1; },
  };
  for (const auto& change : changes) {
    LaserModel other = HalfCircleLaser();
    change(other);
    EXPECT_FALSE(other == HalfCircleLaser());
  }
}

}  // namespace
}  // namespace plumbline
