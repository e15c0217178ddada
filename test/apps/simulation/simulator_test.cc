#include "plumbline/apps/simulation/simulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace plumbline {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

// A hall from corner to corner, and a straight drive through it.
World Hall(const Vector2d& low, const Vector2d& high, const Vector2d& start, const Vector2d& end) {
  const Vector2d b(high.x(), low.y()), d(low.x(), high.y());
  Building building;
  building.faces = {{low, b}, {b, high}, {high, d}, {d, low}};
  building.path = {{start, 1}, {end, 2}};
  return World(building);
}

World SmallHall() { return Hall({0, 0}, {10, 6}, {2, 3}, {8, 3}); }

// Neither noise nor drift.
SimulationOptions Exact() {
  SimulationOptions options;
  options.laser_noise = {0.0, 0.0, 0.0, 0.0};
  options.odometry_noise = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  return options;
}

SimulatedLog SimulatedIn(const World& world, const SimulationOptions& options) {
  SimulatedLog log;
  const Status status = Simulate(world, options, &log);
  EXPECT_TRUE(status.ok()) << status.message();
  return log;
}

struct Moments {
  int count = 0;
  double sum = 0.0, sum_squares = 0.0;

  void Add(double x) {
    ++count;
    sum += x;
    sum_squares += x * x;
  }
  double mean() const { return sum / count; }
  double sigma() const { return std::sqrt(sum_squares / count - mean() * mean()); }
};

// Within four standard errors.
void ExpectGaussian(const Moments& moments, double mean, double sigma) {
  EXPECT_NEAR(moments.mean(), mean, 4.0 * sigma / std::sqrt(moments.count));
  EXPECT_NEAR(moments.sigma(), sigma, 4.0 * sigma / std::sqrt(2.0 * moments.count));
}

TEST(SimulatorTest, RangesOfAKnownRoom) {
  SimulationOptions options = Exact();
  options.laser.robot_from_laser = Pose2(0.1, -0.2, kPi / 2);
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 1.0;
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  ASSERT_EQ(log.scans.size(), 13u);
  EXPECT_NEAR(log.path_length_m, 6.0, 1e-12);
  // At 2.5 m, 3 m the laser is at (2.6, 2.8) and looks along y; beams run from x to -x.
  const SimulatedScan& scan = log.scans[1];
  EXPECT_EQ(scan.scan.timestamp_s, 1.0);
  EXPECT_NEAR(scan.world_from_robot.x, 2.5, 1e-12);
  EXPECT_NEAR(scan.odom_from_robot.x, 2.5, 1e-12);
  ASSERT_EQ(scan.scan.ranges.size(), 360u);
  EXPECT_EQ(scan.scan.ranges[0], 7.4);
  EXPECT_EQ(scan.scan.ranges[180], 3.2);
  EXPECT_EQ(scan.scan.ranges[270], 3.677);  // 2.6 m sqrt(2), rounded to mm
  EXPECT_NEAR((scan.hits[0] - Vector2d(10.0, 2.8)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((scan.hits[270] - Vector2d(0.0, 5.4)).norm(), 0.0, 1e-12);
}

TEST(SimulatorTest, ASweepMeasuresEachBeamWhereTheRobotIsByThen) {
  SimulationOptions options = Exact();
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 1.0;
  options.laser.beam_period_s = 0.8 / 360;
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  // From 2.5 m on it sees the wall at x = 10 m half a sweep later, 0.2 m on.
  EXPECT_NEAR(log.scans[1].world_from_robot.x, 2.5, 1e-12);
  EXPECT_EQ(log.scans[1].scan.ranges[180], 7.3);
  EXPECT_NEAR(log.scans[1].hits[90].x(), 5.6, 0.01);  // at 45 deg, 3 m to the right of 2.6 m
  // It rests at the end of its path.
  EXPECT_EQ(log.scans.back().scan.ranges[180], 2.0);
}

TEST(SimulatorTest, LaserNoiseHasTheStatedMeanAndSigma) {
  SimulationOptions options = Exact();
  options.laser_noise.sigma_range_m = 0.02;
  options.laser_noise.sigma_bearing_rad = 0.004;
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  Moments range, bearing;
  for (const SimulatedScan& scan : log.scans) {
    const Pose2 laser_from_world =
        (scan.world_from_robot * options.laser.robot_from_laser).Inverse();
    for (int beam = 0; beam < options.laser.num_beams; ++beam) {
      const Vector2d hit = laser_from_world * scan.hits[beam];
      range.Add(scan.scan.ranges[beam] - hit.norm());
      bearing.Add(NormalizeAngle(std::atan2(hit.y(), hit.x()) - options.laser.Bearing(beam)));
    }
  }
  ASSERT_GT(range.count, 15000);
  ExpectGaussian(range, 0.0, 0.02);
  ExpectGaussian(bearing, 0.0, 0.004);
}

TEST(SimulatorTest, LostAndObstructedBeamsAreAsFrequentAsStated) {
  SimulationOptions options = Exact();
  options.laser_noise.no_return_probability = 0.10;
  options.laser_noise.short_reading_probability = 0.05;
  options.laser.min_range_m = 1e-3;
  const World world = SmallHall();
  const SimulatedLog log = SimulatedIn(world, options);
  int lost = 0, obstructed = 0, total = 0;
  for (const SimulatedScan& scan : log.scans) {
    for (int beam = 0; beam < options.laser.num_beams; ++beam, ++total) {
      const double range = scan.scan.ranges[beam];
      if (scan.hits[beam].allFinite()) {
        ASSERT_TRUE(options.laser.IsReturn(range));
      } else if (range == options.laser.max_range_m) {
        ++lost;
      } else {
        ++obstructed;
        const double bearing = scan.world_from_robot.yaw + options.laser.Bearing(beam);
        ASSERT_LE(range, world.CastRay(scan.world_from_robot.translation(), bearing) + 5e-4);
      }
    }
  }
  EXPECT_NEAR(lost, 0.10 * total, 4.0 * std::sqrt(0.10 * 0.90 * total));
  EXPECT_NEAR(obstructed, 0.05 * total, 4.0 * std::sqrt(0.05 * 0.95 * total));
}

TEST(SimulatorTest, BeamsBeyondTheMaximumRangeReadIt) {
  SimulationOptions options = Exact();
  options.laser.max_range_m = 4.0;
  const SimulatedScan scan = SimulatedIn(SmallHall(), options).scans[0];
  EXPECT_EQ(scan.scan.ranges[180], 4.0);  // the far wall is 8 m away
  EXPECT_FALSE(scan.hits[180].allFinite());
  EXPECT_EQ(scan.scan.ranges[0], 3.0);
}

TEST(SimulatorTest, SystematicOdometryErrorsBendAndStretchThePath) {
  SimulationOptions options = Exact();
  options.odometry_noise.heading_drift_rad_m = 0.01;
  options.odometry_noise.scale_error = 0.05;
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 0.1;
  const SimulatedLog log = SimulatedIn(Hall({0, 0}, {104, 10}, {2, 5}, {102, 5}), options);
  // 100 m appear as 105 m on an arc that turns 1 rad; the last scan is at its end but for one step.
  const SimulatedScan& last = log.scans.back();
  EXPECT_NEAR(last.odom_from_robot.yaw, 1.0, 1e-3);
  EXPECT_NEAR(last.odom_from_robot.x - 2.0, 105.0 * std::sin(1.0), 0.1);
  EXPECT_NEAR(last.odom_from_robot.y - 5.0, 105.0 * (1.0 - std::cos(1.0)), 0.1);
}

TEST(SimulatorTest, OdometryNoiseFollowsTheMotionModel) {
  SimulationOptions options = Exact();
  options.odometry_noise.rotation_per_translation_rad_m = 0.2;
  options.odometry_noise.translation_per_translation = 0.1;
  options.laser.num_beams = 1;
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 0.1;
  const SimulatedLog log = SimulatedIn(Hall({0, 0}, {504, 10}, {2, 5}, {502, 5}), options);
  Moments forward, yaw;
  for (std::size_t i = 1; i < log.scans.size(); ++i) {
    const Pose2 step = Between(log.scans[i - 1].odom_from_robot, log.scans[i].odom_from_robot);
    forward.Add(std::hypot(step.x, step.y));
    yaw.Add(step.yaw);
  }
  ASSERT_GT(forward.count, 9000);
  // Steps of 0.05 m: sigma_trans = 0.1 * 0.05, and rot1 and rot2 each vary by 0.2 * 0.05.
  ExpectGaussian(forward, 0.05, 0.005);
  ExpectGaussian(yaw, 0.0, 0.01 * std::sqrt(2.0));
}

TEST(SimulatorTest, TurningOnTheSpotHasItsOwnNoise) {
  SimulationOptions options = Exact();
  options.odometry_noise.rotation_per_rotation = 0.1;
  options.odometry_noise.translation_per_rotation_m_rad = 0.05;
  options.laser.num_beams = 1;
  options.drive.turn_rate_rad_s = 0.1;
  options.scan_period_s = 0.1;
  // Back and forth, so that nearly all of the time goes into turns by 180 deg.
  Building building;
  building.faces = {{{5, 0}, {5, 1}}};
  for (int i = 0; i < 21; ++i) building.path.push_back({{0.01 * (i % 2), 0.0}, 0});
  const SimulatedLog log = SimulatedIn(World(building), options);
  Moments distance, yaw_error;
  for (std::size_t i = 1; i < log.scans.size(); ++i) {
    const Pose2 truth = Between(log.scans[i - 1].world_from_robot, log.scans[i].world_from_robot);
    if (std::hypot(truth.x, truth.y) > 1e-6) continue;
    const Pose2 step = Between(log.scans[i - 1].odom_from_robot, log.scans[i].odom_from_robot);
    distance.Add(step.x);
    yaw_error.Add(NormalizeAngle(step.yaw - truth.yaw));
  }
  ASSERT_GT(distance.count, 5000);
  // Steps of 0.01 rad.
  ExpectGaussian(distance, 0.0, 0.05 * 0.01);
  ExpectGaussian(yaw_error, 0.0, 0.1 * 0.01);
}

TEST(SimulatorTest, OdometryDoesNotDependOnTheLaser) {
  SimulationOptions options;
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  options.laser.num_beams = 10;
  const SimulatedLog other = SimulatedIn(SmallHall(), options);
  EXPECT_EQ(log.scans.back().odom_from_robot.x, other.scans.back().odom_from_robot.x);
}

TEST(SimulatorTest, CarriedRobotLeapsAndItsOdometryDoesNot) {
  SimulationOptions options = Exact();
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 1.0;
  options.carry = {2.25, 1.5};
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  // From x = 2 to 8 m; at x = 4.25 m, between the scans at 4 s and 5 s, on to 5.75 m.
  ASSERT_EQ(log.scans.size(), 10u);
  EXPECT_NEAR(log.path_length_m, 4.5, 1e-12);
  EXPECT_NEAR(log.scans[4].world_from_robot.x, 4.0, 1e-12);
  EXPECT_NEAR(log.scans[5].world_from_robot.x, 6.0, 1e-12);
  EXPECT_NEAR(log.scans[4].odom_from_robot.x, 4.0, 1e-12);
  EXPECT_NEAR(log.scans[5].odom_from_robot.x, 4.5, 1e-12);
  EXPECT_NEAR(log.scans[9].world_from_robot.x, 8.0, 1e-12);
  EXPECT_NEAR(log.scans[9].odom_from_robot.x, 6.5, 1e-12);
}

TEST(SimulatorTest, CarriedAroundACornerTheWheelsHaveGoneStraight) {
  SimulationOptions options = Exact();
  options.drive.speed_m_s = 0.5;
  options.drive.corner_radius_m = 0.0;
  options.drive.turn_rate_rad_s = kPi / 2;
  options.scan_period_s = 1.0;
  options.carry = {2.75, 0.5};  // from 0.25 m before the corner to 0.25 m behind it
  Building building = SmallHall().building();
  building.path = {{{2, 2}, 1}, {{5, 2}, 2}, {{5, 5}, 3}};
  const SimulatedLog log = SimulatedIn(World(building), options);
  EXPECT_NEAR(log.scans[5].world_from_robot.x, 4.5, 1e-12);
  EXPECT_NEAR(log.scans[6].world_from_robot.x, 5.0, 1e-12);
  EXPECT_NEAR(log.scans[6].world_from_robot.y, 2.5, 1e-12);
  EXPECT_NEAR(log.scans[6].world_from_robot.yaw, kPi / 2, 1e-12);
  EXPECT_NEAR(log.scans[6].odom_from_robot.x, 5.0, 1e-12);
  EXPECT_NEAR(log.scans[6].odom_from_robot.y, 2.0, 1e-12);
  EXPECT_NEAR(log.scans[6].odom_from_robot.yaw, 0.0, 1e-12);
}

TEST(SimulatorTest, CarriedBeyondTheEndOfThePathTheDriveIsOver) {
  SimulationOptions options = Exact();
  options.carry = {5.0, 10.0};
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  EXPECT_NEAR(log.path_length_m, 5.0, 1e-12);
  EXPECT_LE(log.scans.back().world_from_robot.x, 7.0);
}

TEST(SimulatorTest, OdometryLeapsAndTheRobotDoesNot) {
  SimulationOptions options = Exact();
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 1.0;
  options.odometry_leap = {2.25, 1.0};
  options.odometry_leap_direction_rad = kPi / 2;
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  ASSERT_EQ(log.scans.size(), 13u);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    EXPECT_NEAR(log.scans[i].world_from_robot.x, 2.0 + 0.5 * i, 1e-12);
    EXPECT_NEAR(log.scans[i].odom_from_robot.x, 2.0 + 0.5 * i, 1e-12);
    EXPECT_NEAR(log.scans[i].odom_from_robot.y, i < 5 ? 3.0 : 4.0, 1e-12);
  }
}

// The clock goes on; neither wheels nor laser tell of the time in which it is carried.
TEST(SimulatorTest, NothingIsRecordedWhileTheRobotIsCarried) {
  SimulationOptions options = Exact();
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 1.0;
  options.carry = {2.25, 1.5};  // from 4.5 s on
  options.carry_duration_s = 5.0;
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  // 9.5 s of driving less 0.5 s, which is no whole step: the robot sets out again at 9.5 s.
  ASSERT_EQ(log.scans.size(), 10u);
  EXPECT_EQ(log.scans[4].scan.timestamp_s, 4.0);
  EXPECT_EQ(log.scans[5].scan.timestamp_s, 10.0);
  EXPECT_EQ(log.scans[9].scan.timestamp_s, 14.0);
  EXPECT_NEAR(log.path_length_m, 4.5, 1e-12);
  EXPECT_NEAR(log.scans[4].world_from_robot.x, 4.0, 1e-12);
  EXPECT_NEAR(log.scans[5].world_from_robot.x, 6.0, 1e-12);
  EXPECT_NEAR(log.scans[5].odom_from_robot.x, 4.5, 1e-12);
  EXPECT_NEAR(log.scans[9].world_from_robot.x, 8.0, 1e-12);
  EXPECT_NEAR(log.scans[9].odom_from_robot.x, 6.5, 1e-12);
}

TEST(SimulatorTest, ASlipIsSpreadOverItsTime) {
  SimulationOptions options = Exact();
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 1.0;
  options.odometry_leap = {2.25, 1.0};  // from 4.5 s on
  options.odometry_leap_duration_s = 4.0;
  for (const double sign : {1.0, -1.0}) {
    options.odometry_leap_direction_rad = sign > 0.0 ? 0.0 : kPi;
    const SimulatedLog log = SimulatedIn(SmallHall(), options);
    ASSERT_EQ(log.scans.size(), 13u);
    for (std::size_t i = 0; i < log.scans.size(); ++i) {
      const double slipped_m = std::clamp((i - 4.5) / 4.0, 0.0, 1.0);
      EXPECT_NEAR(log.scans[i].world_from_robot.x, 2.0 + 0.5 * i, 1e-12);
      EXPECT_NEAR(log.scans[i].odom_from_robot.x, 2.0 + 0.5 * i + sign * slipped_m, 1e-12);
      EXPECT_NEAR(log.scans[i].odom_from_robot.y, 3.0, 1e-12);
    }
  }
}

TEST(SimulatorTest, OdometryOfAnotherTime) {
  SimulationOptions options = Exact();
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 1.0;
  for (const double delay_s : {0.4, -0.4}) {
    options.odometry_delay_s = delay_s;
    const SimulatedLog log = SimulatedIn(SmallHall(), options);
    ASSERT_EQ(log.scans.size(), 13u);
    for (std::size_t i = 0; i < log.scans.size(); ++i) {
      EXPECT_NEAR(log.scans[i].world_from_robot.x, 2.0 + 0.5 * i, 1e-12);
      EXPECT_NEAR(log.scans[i].odom_from_robot.x, 2.0 + 0.5 * std::clamp(i - delay_s, 0.0, 12.0),
                  1e-12);
    }
  }
}

// Beam 180 looks ahead by the log, and by 90 deg to the left in truth.
TEST(SimulatorTest, AMountingErrorTurnsTheLaserAndNotWhatTheLogSays) {
  SimulationOptions options = Exact();
  const SimulatedLog sound = SimulatedIn(SmallHall(), options);
  options.mounting_error = Pose2(0.0, 0.0, kPi / 2);
  const SimulatedLog log = SimulatedIn(SmallHall(), options);
  EXPECT_TRUE(log.laser == sound.laser);
  EXPECT_EQ(sound.scans[0].scan.ranges[180], 8.0);
  EXPECT_EQ(log.scans[0].scan.ranges[180], 3.0);
  EXPECT_EQ(log.scans[0].scan.ranges[0], sound.scans[0].scan.ranges[180]);
  EXPECT_EQ(log.scans.back().world_from_robot.yaw, sound.scans.back().world_from_robot.yaw);
  EXPECT_EQ(log.scans.back().odom_from_robot.x, sound.scans.back().odom_from_robot.x);
}

TEST(SimulatorTest, RefusesBadOptionsByName) {
  SimulatedLog log;
  SimulationOptions options;
  options.laser_noise.no_return_probability = 0.7;
  options.laser_noise.short_reading_probability = 0.4;
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(),
              HasSubstr("short_reading_probability = 0.4"));
  options = SimulationOptions();
  options.laser.num_beams = 0;
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(), HasSubstr("num_beams = 0"));
  options = SimulationOptions();
  options.scan_period_s = 0.0;
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(), HasSubstr("scan_period_s = 0"));
  options = SimulationOptions();
  options.odometry_noise.scale_error = -1.0;
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(), HasSubstr("scale_error = -1"));
  options = SimulationOptions();
  options.carry.distance_m = -1.0;
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(), HasSubstr("carry.distance_m = -1"));
  options = SimulationOptions();
  options.carry_duration_s = -1.0;
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(), HasSubstr("carry_duration_s = -1"));
  options = SimulationOptions();
  options.odometry_leap_duration_s = -1.0;
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(),
              HasSubstr("odometry_leap_duration_s = -1"));
  options = SimulationOptions();
  options.odometry_delay_s = std::nan("");
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(), HasSubstr("odometry_delay_s"));
  options = SimulationOptions();
  options.mounting_error.yaw = std::nan("");
  EXPECT_THAT(Simulate(SmallHall(), options, &log).message(), HasSubstr("mounting_error.yaw"));
  EXPECT_TRUE(log.scans.empty());
}

// A robot in front of a long wall of glass sees the piece of it that it looks at head-on.
TEST(SimulatorTest, GlassReturnsLightHeadOnOnly) {
  Building building;
  building.faces = {{{-20, 3}, {20, 3}, true}, {{-20, -3}, {20, -3}}};
  building.path = {{{0, 0}, 1}, {{1, 0}, 2}};
  SimulationOptions options;
  options.laser.num_beams = 720;
  options.laser.first_bearing_rad = -kPi;
  options.laser.max_range_m = 10.0;
  options.laser_noise = {0.0, 0.0, 0.0, 0.0};
  SimulatedLog log;
  ASSERT_TRUE(Simulate(World(building), options, &log).ok());
  const SimulatedScan& scan = log.scans.front();
  for (int beam = 0; beam < options.laser.num_beams; ++beam) {
    const double bearing = options.laser.Bearing(beam);
    const bool in_reach = std::abs(std::sin(bearing)) > 0.31;
    if (!in_reach) continue;
    const bool head_on = std::abs(bearing - 0.5 * kPi) < 0.25;
    const bool oblique = std::abs(bearing - 0.5 * kPi) > 0.27;
    const bool is_return = options.laser.IsReturn(scan.scan.ranges[beam]);
    if (bearing < 0.0 || head_on) {
      EXPECT_TRUE(is_return) << bearing;
    } else if (oblique) {
      EXPECT_FALSE(is_return) << bearing;
    }
    EXPECT_EQ(is_return, scan.hits[beam].allFinite());
  }
}

// What moves is measured, but is no part of the truth about the building; the odometry is the same.
TEST(SimulatorTest, PeopleHideTheBuilding) {
  Building building;
  building.faces = {{{-20, 2}, {20, 2}}, {{-20, -2}, {20, -2}}};
  building.path = {{{-10, 0}, 1}, {{10, 0}, 2}};
  SimulationOptions options;
  options.laser_noise = {0.0, 0.0, 0.0, 0.0};
  SimulatedLog empty, busy;
  ASSERT_TRUE(Simulate(World(building), options, &empty).ok());
  options.traffic.num_people = 8;
  ASSERT_TRUE(Simulate(World(building), options, &busy).ok());
  ASSERT_EQ(busy.scans.size(), empty.scans.size());
  int num_hidden = 0;
  for (std::size_t s = 0; s < busy.scans.size(); ++s) {
    EXPECT_EQ(busy.scans[s].odom_from_robot.x, empty.scans[s].odom_from_robot.x);
    for (int beam = 0; beam < options.laser.num_beams; ++beam) {
      const double range = busy.scans[s].scan.ranges[beam];
      EXPECT_LE(range, empty.scans[s].scan.ranges[beam]);
      if (range == empty.scans[s].scan.ranges[beam]) continue;
      EXPECT_FALSE(busy.scans[s].hits[beam].allFinite());
      ++num_hidden;
    }
  }
  EXPECT_GT(num_hidden, 1000);
}

}  // namespace
}  // namespace plumbline
