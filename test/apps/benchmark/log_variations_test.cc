#include "plumbline/apps/benchmark/log_variations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/test/apps/benchmark/known_drive.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr int kNumScans = 60, kNumBeams = 46;

const KnownLog& Drive() {
  static const KnownLog drive = MakeKnownDrive(kNumScans, kNumBeams);
  return drive;
}

VariedLog Vary(const std::string& name, const KnownLog& known, std::uint64_t seed = 1) {
  VariedLog varied;
  const LogVariation* variation = FindLogVariation(name);
  EXPECT_NE(variation, nullptr) << name;
  const Status status = VaryLog(*variation, seed, known, &varied);
  EXPECT_TRUE(status.ok()) << status.message();
  return varied;
}

std::vector<CarmenScan> ScansOf(const std::string& name, std::uint64_t seed = 1) {
  return Vary(name, Drive(), seed).known.log.scans;
}

void ExpectNear(const Pose2& a, const Pose2& b) {
  EXPECT_NEAR(a.x, b.x, 1e-9);
  EXPECT_NEAR(a.y, b.y, 1e-9);
  EXPECT_NEAR(NormalizeAngle(a.yaw - b.yaw), 0.0, 1e-9);
}

void ExpectNear(const KnownLog& a, const KnownLog& b) {
  ASSERT_EQ(a.log.scans.size(), b.log.scans.size());
  for (std::size_t i = 0; i < a.log.scans.size(); ++i) {
    const CarmenScan &one = a.log.scans[i], &other = b.log.scans[i];
    EXPECT_NEAR(one.timestamp_s, other.timestamp_s, 1e-9);
    EXPECT_NEAR(one.first_bearing_rad, other.first_bearing_rad, 1e-12);
    ExpectNear(one.odom_from_robot, other.odom_from_robot);
    ExpectNear(one.odom_from_laser, other.odom_from_laser);
    EXPECT_EQ(one.ranges, other.ranges);
  }
  ASSERT_EQ(a.relations.size(), b.relations.size());
  for (std::size_t i = 0; i < a.relations.size(); ++i) {
    EXPECT_NEAR(a.relations[i].from_s, b.relations[i].from_s, 1e-9);
    EXPECT_NEAR(a.relations[i].to_s, b.relations[i].to_s, 1e-9);
    ExpectNear(a.relations[i].from_from_to, b.relations[i].from_from_to);
  }
}

bool AreSame(const KnownLog& a, const KnownLog& b) {
  return std::equal(a.log.scans.begin(), a.log.scans.end(), b.log.scans.begin(), b.log.scans.end(),
                    [](const CarmenScan& one, const CarmenScan& other) {
                      return one.timestamp_s == other.timestamp_s && one.ranges == other.ranges &&
                             one.odom_from_robot.x == other.odom_from_robot.x &&
                             one.odom_from_robot.yaw == other.odom_from_robot.yaw &&
                             one.odom_from_laser.yaw == other.odom_from_laser.yaw;
                    });
}

// End of a beam in the frame of the odometry.
Eigen::Vector2d EndOf(const CarmenScan& scan, std::size_t beam) {
  const double bearing = scan.first_bearing_rad + static_cast<double>(beam) * scan.bearing_step_rad;
  return scan.odom_from_laser * BeamEnd(scan.ranges[beam], bearing);
}

Pose2 StepTo(std::size_t scan, const std::vector<CarmenScan>& scans) {
  return Between(scans[scan - 1].odom_from_robot, scans[scan].odom_from_robot);
}

const std::set<std::string> kOfOdometry = {"odo2",     "odoscale",    "shift",      "scale03",
                                           "reversed", "xy_constant", "no_odometry"};

// With the truth as odometry, the odometry of a varied log is the truth of the varied drive.
TEST(LogVariationsTest, RelationsStayTrue) {
  KnownLog exact = Drive();
  for (std::size_t i = 0; i < exact.relations.size(); ++i) {
    exact.log.scans[i + 10].odom_from_robot =
        exact.log.scans[i].odom_from_robot * exact.relations[i].from_from_to;
  }
  for (const LogVariation& variation : LogVariations()) {
    SCOPED_TRACE(variation.name);
    const VariedLog varied = Vary(variation.name, exact);
    ASSERT_EQ(varied.known.relations.size(), varied.unvaried_relations.size());
    if (kOfOdometry.count(variation.name) > 0) {
      EXPECT_EQ(varied.known.relations.size(), exact.relations.size());
      continue;
    }
    std::vector<TimedPose> truth, unvaried;
    for (const CarmenScan& scan : varied.known.log.scans) {
      truth.push_back({scan.timestamp_s, scan.odom_from_robot});
    }
    for (const CarmenScan& scan : exact.log.scans) {
      unvaried.push_back({scan.timestamp_s, scan.odom_from_robot});
    }
    for (const RelationsMetric& errors :
         {MeasureRelations(varied.known.relations, truth, RelationsOptions()),
          MeasureRelations(varied.unvaried_relations, unvaried, RelationsOptions())}) {
      EXPECT_EQ(errors.all.num_unmatched, 0u);
      EXPECT_EQ(errors.all.num_matched, varied.known.relations.size());
      EXPECT_LT(errors.all.translation_m.max, 1e-9);
      EXPECT_LT(errors.all.rotation_deg.max, 1e-9);
    }
  }
}

TEST(LogVariationsTest, KeepsRelationsWhoseScansAreKept) {
  for (const char* name : {"late", "early", "gaps", "thin5", "backwards"}) {
    SCOPED_TRACE(name);
    const VariedLog varied = Vary(name, Drive());
    std::set<long> kept_ms;
    for (const CarmenScan& scan : varied.known.log.scans) {
      kept_ms.insert(std::lround(1e3 * scan.timestamp_s));
    }
    std::size_t num_kept = 0;
    for (const Relation& relation : Drive().relations) {
      num_kept += kept_ms.count(std::lround(1e3 * relation.from_s)) *
                  kept_ms.count(std::lround(1e3 * relation.to_s));
    }
    EXPECT_EQ(varied.known.relations.size(), num_kept);
  }
}

TEST(LogVariationsTest, TwoReversalsAreTheIdentity) {
  for (const char* name : {"backwards", "mirror", "reversed"}) {
    SCOPED_TRACE(name);
    const KnownLog once = Vary(name, Drive()).known;
    EXPECT_FALSE(AreSame(once, Drive()));
    ExpectNear(Vary(name, once).known, Drive());
  }
  EXPECT_TRUE(AreSame(Vary("same", Drive()).known, Drive()));
}

TEST(LogVariationsTest, TheMirroredBuildingIsTheMirrorImage) {
  const std::vector<CarmenScan> scans = ScansOf("mirror");
  for (const std::size_t scan : {0, 30}) {
    for (const std::size_t beam : {0, 5, kNumBeams - 1}) {
      const Eigen::Vector2d end = EndOf(scans[scan], kNumBeams - 1 - beam);
      const Eigen::Vector2d given = EndOf(Drive().log.scans[scan], beam);
      EXPECT_NEAR((end - Eigen::Vector2d(given.x(), -given.y())).norm(), 0.0, 1e-9);
    }
  }
  EXPECT_GT(scans.front().bearing_step_rad, 0.0);
}

TEST(LogVariationsTest, ATurnedLaserSeesTheSamePoints) {
  const std::vector<CarmenScan> scans = ScansOf("turned");
  for (const std::size_t scan : {0, 30}) {
    for (const std::size_t beam : {0, 5, kNumBeams - 1}) {
      EXPECT_NEAR((EndOf(scans[scan], beam) - EndOf(Drive().log.scans[scan], beam)).norm(), 0.0,
                  1e-9);
    }
  }
  EXPECT_GT(std::abs(scans[0].first_bearing_rad - Drive().log.scans[0].first_bearing_rad), 0.01);
}

TEST(LogVariationsTest, ScansAreMissing) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::vector<CarmenScan> late = ScansOf("late", seed), early = ScansOf("early", seed);
    for (const std::vector<CarmenScan>& cut : {late, early}) {
      EXPECT_GE(cut.size(), 0.6 * kNumScans);
      EXPECT_LE(cut.size(), 0.9 * kNumScans + 1.0);
    }
    EXPECT_EQ(late.back().timestamp_s, Drive().log.scans.back().timestamp_s);
    EXPECT_EQ(early.front().timestamp_s, Drive().log.scans.front().timestamp_s);
    EXPECT_GE(ScansOf("gaps", seed).size(), kNumScans - 5u * 6u);
    EXPECT_LE(ScansOf("gaps", seed).size(), kNumScans - 5u);
  }
  EXPECT_EQ(ScansOf("thin2").size(), 30u);
  EXPECT_EQ(ScansOf("thin5").size(), 12u);
}

TEST(LogVariationsTest, ReadingsAreLost) {
  const std::vector<CarmenScan>& given = Drive().log.scans;
  const std::vector<CarmenScan> narrow = ScansOf("fov120"), close = ScansOf("range8"),
                                half = ScansOf("beams2"), quarter = ScansOf("beams4");
  for (std::size_t i = 0; i < given.size(); ++i) {
    for (std::size_t beam = 0; beam < kNumBeams; ++beam) {
      const double range = given[i].ranges[beam], none = given[i].max_range_m;
      EXPECT_EQ(narrow[i].ranges[beam], beam < 7 || beam >= 39 ? none : range);
      EXPECT_EQ(close[i].ranges[beam], range < 8.0 ? range : none);
      EXPECT_EQ(half[i].ranges[beam], beam % 2 == 0 ? range : none);
      EXPECT_EQ(quarter[i].ranges[beam], beam % 4 == 0 ? range : none);
    }
  }
}

TEST(LogVariationsTest, RangesAreNoisier) {
  const std::vector<CarmenScan>& given = Drive().log.scans;
  const std::vector<CarmenScan> noisy = ScansOf("noise2cm");
  double sum = 0.0, num_returns = 0.0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    for (std::size_t beam = 0; beam < kNumBeams; ++beam) {
      const double error = noisy[i].ranges[beam] - given[i].ranges[beam];
      if (given[i].ranges[beam] == given[i].max_range_m) {
        EXPECT_EQ(error, 0.0);
        continue;
      }
      sum += error * error;
      num_returns += 1.0;
    }
  }
  EXPECT_GT(num_returns, 1000.0);
  EXPECT_NEAR(std::sqrt(sum / num_returns), 0.02, 0.002);
}

TEST(LogVariationsTest, OdometryIsWrong) {
  const std::vector<CarmenScan>& given = Drive().log.scans;
  const std::vector<CarmenScan> scaled = ScansOf("scale03"), reversed = ScansOf("reversed"),
                                turning = ScansOf("xy_constant"), misscaled = ScansOf("odoscale");
  for (std::size_t i = 1; i < given.size(); ++i) {
    const Pose2 step = StepTo(i, given);
    ExpectNear(StepTo(i, scaled), Pose2(0.3 * step.x, 0.3 * step.y, step.yaw));
    ExpectNear(StepTo(i, reversed), Pose2(-step.x, -step.y, step.yaw));
    ExpectNear(turning[i].odom_from_robot,
               Pose2(given[0].odom_from_robot.x, given[0].odom_from_robot.y,
                     given[i].odom_from_robot.yaw));
    EXPECT_NEAR(std::abs(StepTo(i, misscaled).x - step.x), 0.05 * std::abs(step.x), 1e-9);
    EXPECT_NEAR(std::abs(StepTo(i, misscaled).yaw - step.yaw), 0.07 * std::abs(step.yaw), 1e-9);
  }
}

TEST(LogVariationsTest, TheClockOfTheOdometryIsOff) {
  const std::vector<CarmenScan>& given = Drive().log.scans;
  const std::vector<CarmenScan> shifted = ScansOf("shift");
  double moved_m = 0.0;
  for (std::size_t i = 1; i + 1 < given.size(); ++i) {
    const double length_m =
        std::max(StepTo(i, given).translation().norm(), StepTo(i + 1, given).translation().norm());
    const double error_m =
        Between(given[i].odom_from_robot, shifted[i].odom_from_robot).translation().norm();
    EXPECT_LE(error_m, 0.1 / 0.6 * length_m + 1e-9);
    moved_m += error_m;
  }
  EXPECT_GT(moved_m, 0.01);
}

TEST(LogVariationsTest, TheLaserStaysOnTheRobot) {
  const Pose2 mounting = EstimateLaserMounting(Drive().log).robot_from_laser;
  for (const LogVariation& variation : LogVariations()) {
    const std::string name = variation.name;
    if (name == "turned" || name == "mirror") continue;
    SCOPED_TRACE(name);
    const LaserMounting varied = EstimateLaserMounting(Vary(name, Drive()).known.log);
    ExpectNear(varied.robot_from_laser, mounting);
    EXPECT_LT(varied.max_deviation_m, 1e-9);
  }
}

TEST(LogVariationsTest, WithoutOdometryTheMountingIsThatOfTheLog) {
  KnownLog known = Drive();
  known.log.params["robot_frontlaser_offset"] = "0.3";
  for (CarmenScan& scan : known.log.scans) scan.odom_from_laser = scan.odom_from_robot;
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(Vary("no_odometry", known).known.log, 0, &graph).ok());
  EXPECT_TRUE(graph.odometry().empty());
  ExpectNear(graph.laser(0).robot_from_laser, Pose2());
}

TEST(LogVariationsTest, TheSeedDeterminesTheResult) {
  for (const LogVariation& variation : LogVariations()) {
    SCOPED_TRACE(variation.name);
    const KnownLog first = Vary(variation.name, Drive(), 1).known;
    EXPECT_TRUE(AreSame(first, Vary(variation.name, Drive(), 1).known));
    bool depends_on_seed = false;
    for (std::uint64_t seed = 2; seed <= 9; ++seed) {
      depends_on_seed |= !AreSame(first, Vary(variation.name, Drive(), seed).known);
    }
    EXPECT_EQ(depends_on_seed, variation.is_random);
  }
}

TEST(LogVariationsTest, TooLittleIsLeft) {
  EXPECT_EQ(FindLogVariation("sideways"), nullptr);
  KnownLog known = Drive();
  VariedLog varied;
  known.log.scans.resize(4);
  const Status few = VaryLog(*FindLogVariation("thin5"), 1, known, &varied);
  EXPECT_THAT(few.message(), HasSubstr("drive, variation thin5: fewer than two scans are left"));
  const Status none = VaryLog(*FindLogVariation("same"), 1, known, &varied);
  EXPECT_THAT(none.message(), HasSubstr("variation same: no relation has a scan at both"));
  known.log.scans.resize(1);
  EXPECT_FALSE(VaryLog(*FindLogVariation("shift"), 1, known, &varied).ok());
  EXPECT_TRUE(varied.known.log.scans.empty());
}

}  // namespace
}  // namespace plumbline
