// Bags with the faults that users' bags have, mapped from end to end: the map is that of the bag
// without them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/simulation/building_reader.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/sqlite_writer.h"
#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr TestEncoding kEncoding = TestEncoding::kCdr;
constexpr int kNumScans = 60;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TestMessage Transform(const std::string& parent, const std::string& child, const Pose2& pose) {
  return {"/tf", "tf2_msgs/msg/TFMessage", "cdr", kStart_ns,
          TransformBytes(kEncoding, kStart_ns, parent, child, pose)};
}

// The fields of a scan that drivers get wrong.
struct ScanFields {
  std::int64_t stamp_ns = 0;
  std::string frame = "laser";
  double angle_min_rad = 0.0, angle_max_rad = 0.0, angle_increment_rad = 0.0, range_max_m = 20.0;
  std::vector<double> ranges;

  TestMessage Message(std::int64_t time_ns) const {
    MessageWriter writer(kEncoding);
    writer.Header(stamp_ns, frame);
    for (const double value :
         {angle_min_rad, angle_max_rad, angle_increment_rad, 0.0, 0.0, 0.05, range_max_m}) {
      writer.Single(value);
    }
    writer.Unsigned(static_cast<std::uint32_t>(ranges.size()));
    for (const double range : ranges) writer.Single(range);
    writer.Unsigned(0);
    return {"/scan", "sensor_msgs/msg/LaserScan", "cdr", time_ns, writer.bytes()};
  }
};

// A drive through the small building.
class OddBagsTest : public ProgramTest {
 protected:
  OddBagsTest() {
    Building building;
    EXPECT_TRUE(ReadBuilding(PLUMBLINE_WORLD, &building).ok());
    SimulationOptions options;
    options.laser.max_range_m = 20.0;
    EXPECT_TRUE(Simulate(World(building), options, &log_).ok());
    log_.scans.resize(kNumScans);
    for (const SimulatedScan& scan : log_.scans) {
      const LaserModel& laser = log_.laser;
      ScanFields fields;
      fields.stamp_ns = kStart_ns + std::llround(1e9 * scan.scan.timestamp_s);
      fields.angle_min_rad = laser.first_bearing_rad;
      fields.angle_max_rad = laser.Bearing(laser.num_beams - 1);
      fields.angle_increment_rad = laser.bearing_step_rad;
      fields.ranges = scan.scan.ranges;
      scans_.push_back(fields);
    }
  }

  TestBag Bag(bool with_odometry_messages = true) const {
    TestBag bag = {Transform("base_link", "laser", Pose2())};
    for (int i = 0; i < kNumScans; ++i) {
      const std::int64_t time_ns = kStart_ns + std::llround(1e9 * log_.scans[i].scan.timestamp_s);
      const Pose2& pose = log_.scans[i].odom_from_robot;
      if (with_odometry_messages) {
        bag.push_back({"/odom", "nav_msgs/msg/Odometry", "cdr", time_ns,
                       OdometryBytes(kEncoding, time_ns, pose)});
      } else {
        bag.push_back({"/tf", "tf2_msgs/msg/TFMessage", "cdr", time_ns,
                       TransformBytes(kEncoding, time_ns, "odom", "base_link", pose)});
      }
      bag.push_back(scans_[i].Message(time_ns));
    }
    return bag;
  }

  // The trajectory of a run.
  std::string Map(const TestBag& bag, const std::string& flags = "") {
    WriteSqliteBag(folder_ + "a.db3", bag);
    const Outcome run = Slam("a.db3", "--picture_side_px=100 " + flags);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return Result("out", "trajectory.tum");
  }

  std::vector<std::string> WarningIds() const {
    std::vector<std::string> ids;
    const std::string report = Result("out", "report.html");
    const nlohmann::json summary = Summary();
    for (const nlohmann::json& warning : summary["warnings"]) {
      ids.push_back(warning["id"]);
      EXPECT_THAT(report, HasSubstr("[" + ids.back() + "]"));
    }
    return ids;
  }

  SimulatedLog log_;
  std::vector<ScanFields> scans_;
};

TEST_F(OddBagsTest, TransformsThatNothingNeedsDoNotMatter) {
  const std::string expected = Map(Bag());
  EXPECT_THAT(WarningIds(), IsEmpty());
  TestBag bag = Bag();
  bag.push_back(Transform("base_link", "wheel", {kNan, 0.0, 0.0}));
  bag.push_back(Transform("map", "odom", {0.0, kNan, 0.0}));
  EXPECT_EQ(Map(bag), expected);
  EXPECT_THAT(WarningIds(), IsEmpty());
  bag.push_back(Transform("base_link", "base_link", {1.0, 0.0, 0.0}));
  bag.push_back(Transform("", "base_link", {1.0, 0.0, 0.0}));
  bag.push_back(Transform("map", "base_link", {7.0, 0.0, 0.0}));
  bag.push_back(Transform("camera", "laser", {7.0, 0.0, 0.0}));
  EXPECT_EQ(Map(bag), expected);
  EXPECT_THAT(WarningIds(), ElementsAre("ignored_transforms"));
  const std::string by_transforms = Map(Bag(false));
  bag = Bag(false);
  bag.push_back(Transform("map", "base_link", {7.0, 0.0, 0.0}));
  EXPECT_EQ(Map(bag), by_transforms);
}

TEST_F(OddBagsTest, OneBadMessageIsSkipped) {
  const std::string expected = Map(Bag());
  TestBag bag = Bag();
  bag.insert(bag.begin(), bag[1]);
  bag[0].bytes = OdometryBytes(kEncoding, kStart_ns, {kNan, 0.0, 0.0});
  EXPECT_EQ(Map(bag), expected);
  EXPECT_THAT(WarningIds(), ElementsAre("bad_messages"));
  const std::vector<ScanFields> scans = scans_;
  bag = Bag();
  for (int kind = 0; kind < 4; ++kind) {
    ScanFields bad = scans[9];
    if (kind == 0) bad.ranges.clear();
    if (kind == 1) bad.stamp_ns = 0;
    if (kind == 2) bad.range_max_m = 0.0;
    bag.insert(bag.begin() + 20, bad.Message(kStart_ns));
    if (kind == 3) bag[20].bytes.resize(100);
  }
  EXPECT_EQ(Map(bag), expected);
  EXPECT_THAT(WarningIds(), ElementsAre("bad_messages"));
  EXPECT_EQ(Summary()["skipped_records"], 4);
}

TEST_F(OddBagsTest, HabitsOfDriversDoNotMatter) {
  const std::string expected = Map(Bag());
  for (ScanFields& scan : scans_) scan.range_max_m = 0.0;
  EXPECT_EQ(Map(Bag()), expected);
  EXPECT_THAT(WarningIds(), IsEmpty());
  TestBag bag;
  for (const TestMessage& message : Bag()) {
    bag.insert(bag.end(), message.topic == "/scan" ? 3 : 1, message);
  }
  EXPECT_EQ(Map(bag), expected);
  EXPECT_THAT(WarningIds(), ElementsAre("repeated_scans"));
}

TEST_F(OddBagsTest, UselessStampsGiveWayToTheTimesOfRecording) {
  const std::string expected = Map(Bag());
  for (ScanFields& scan : scans_) scan.stamp_ns -= std::int64_t{1400000000} * 1000000000;
  EXPECT_EQ(Map(Bag()), expected);
  EXPECT_THAT(WarningIds(), ElementsAre("record_clock"));
  for (ScanFields& scan : scans_) scan.stamp_ns = 0;
  EXPECT_EQ(Map(Bag()), expected);
  EXPECT_THAT(WarningIds(), ElementsAre("record_clock"));
  EXPECT_EQ(Map(Bag(), "--clock=record"), expected);
  EXPECT_THAT(WarningIds(), IsEmpty());
  WriteSqliteBag(folder_ + "a.db3", Bag());
  std::filesystem::remove_all(folder_ + "out");
  ExpectError(Slam("a.db3", "--clock=header"), "the stamps of 60 of 60 headers are not set");
}

// The array runs from the left to the right, but the increment is positive.
TEST_F(OddBagsTest, AngleMaxAndTheTurnsDecideAboutBeams) {
  const std::vector<ScanFields> scans = scans_;
  Map(Bag());
  const std::size_t num_returns = Summary()["returns"];
  const std::string expected = [&] {
    for (ScanFields& scan : scans_) {
      std::reverse(scan.ranges.begin(), scan.ranges.end());
      std::swap(scan.angle_min_rad, scan.angle_max_rad);
      scan.angle_increment_rad = -scan.angle_increment_rad;
    }
    return Map(Bag());
  }();
  EXPECT_THAT(WarningIds(), IsEmpty());
  for (ScanFields& scan : scans_) scan.angle_increment_rad = -scan.angle_increment_rad;
  EXPECT_EQ(Map(Bag()), expected);
  EXPECT_EQ(Summary()["returns"], num_returns);
  EXPECT_THAT(WarningIds(), ElementsAre("beam_angles_contradict"));
}

// Every seventh beam, others in each scan, reads 29.95 +- 0.03 m.
TEST_F(OddBagsTest, NoReturnsBelowTheMaximumRangeAreNone) {
  const std::vector<ScanFields> scans = scans_;
  const auto spoil = [&](double level_m, double noise_m) {
    for (int i = 0; i < kNumScans; ++i) {
      scans_[i] = scans[i];
      scans_[i].range_max_m = 30.0;
      for (double& range_m : scans_[i].ranges) {
        if (range_m >= 20.0) range_m = std::numeric_limits<double>::infinity();
      }
      for (std::size_t beam = i % 7; beam < scans[i].ranges.size(); beam += 7) {
        scans_[i].ranges[beam] = level_m + noise_m * std::sin(1.0 * beam * i);
      }
    }
    return Map(Bag());
  };
  const std::string expected = spoil(std::numeric_limits<double>::infinity(), 0.0);
  const std::string map = Result("out", "map.pgm");
  for (const double noise_m : {0.0, 0.03}) {
    EXPECT_EQ(spoil(29.95, noise_m), expected) << noise_m;
    EXPECT_EQ(Result("out", "map.pgm"), map);
    const double level_m = Summary()["no_return_level_m"];
    EXPECT_LE(level_m, 29.95 - noise_m);
    EXPECT_GT(level_m, 29.8);
  }
}

TEST_F(OddBagsTest, ALaserThatNoTransformKnowsIsAtTheCentre) {
  const std::string expected = Map(Bag(false));
  for (ScanFields& scan : scans_) scan.frame = "stranger";
  EXPECT_EQ(Map(Bag(false)), expected);
  EXPECT_THAT(WarningIds(), ElementsAre("unknown_mounting"));
}

TEST_F(OddBagsTest, OneOfSeveralLasersOnATopicIsChosen) {
  TestBag bag = Bag();
  const std::string expected = Map(bag);
  for (int i = 0; i < kNumScans; ++i) {
    ScanFields rear = scans_[i];
    rear.frame = "rear";
    rear.ranges.assign(rear.ranges.size(), 1.0);
    bag.push_back(rear.Message(rear.stamp_ns));
  }
  WriteSqliteBag(folder_ + "a.db3", bag);
  std::filesystem::remove_all(folder_ + "out");
  ExpectError(Slam("a.db3"),
              "several lasers share /scan: choose one by --laser_frame; the frames "
              "are 'laser' (60 scans), 'rear' (60 scans)");
  EXPECT_EQ(Map(bag, "--laser_frame=laser"), expected);
}

TEST_F(OddBagsTest, InfoDescribesABagWithoutMappingIt) {
  WriteSqliteBag(folder_ + "a.db3", Bag());
  const Outcome run = Run("slam", "--info=" + folder_ + "a.db3");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("a.db3: bag of ROS\n"));
  EXPECT_THAT(run.out, HasSubstr("  topic /odom (nav_msgs/msg/Odometry, cdr): 60 messages, "
                                 "recorded from 1500000000.000 s to "));
  EXPECT_THAT(run.out, HasSubstr("  used: 60 scans with "));
  EXPECT_THAT(run.out, HasSubstr("  odometry: 59 steps, "));
  for (ScanFields& scan : scans_) scan.ranges.clear();
  WriteSqliteBag(folder_ + "a.db3", Bag());
  EXPECT_THAT(Run("slam", "--info=" + folder_ + "a.db3").out,
              HasSubstr("  refused: " + folder_ +
                        "a.db3: 60 of 60 messages on /scan cannot be "
                        "used: field 'ranges' is empty (60)"));
  ExpectError(Run("slam", "--info=" + folder_ + "none"), "none");
}

}  // namespace
}  // namespace plumbline
