#include "plumbline/apps/live/live_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/apps/live/live_scan.h"
#include "plumbline/apps/live/save_live_map.h"
#include "plumbline/test/apps/live/simulated_robot.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::StartsWith;

const SimulatedRobot& Robot() {
  static const SimulatedRobot robot;
  EXPECT_TRUE(robot.is_good());
  return robot;
}

LiveOptions Repeatable() {
  LiveOptions options;
  options.wait_for_background = true;
  return options;
}

// A node that is given the messages of the simulated robot.
class LiveNodeTest : public testing::Test {
 protected:
  // The messages of scan i come now.
  void Send(int i, bool with_odometry = true) {
    if (with_odometry) node_->AddTransforms(Robot().OdometryTransform(i));
    node_->AddScan(Robot().Scan(i), now_s_);
    Work();
  }
  void SendUpTo(int num_scans) {
    for (; num_sent_ < num_scans; ++num_sent_) Send(num_sent_);
  }
  void Work() { node_->Work(now_s_, &updates_); }
  void UseOptions(const LiveOptions& options) { node_ = std::make_unique<LiveNode>(options); }
  double ErrorM(int i, const Pose2& map_from_robot) const {
    const auto& scans = Robot().log().scans;
    const Pose2 truth = Between(scans[0].world_from_robot, scans[i].world_from_robot);
    return (map_from_robot.translation() - truth.translation()).norm();
  }
  std::size_t Count(const std::string& kind) const {
    const auto faults = node_->Report().faults;
    const auto found = faults.find(kind);
    return found == faults.end() ? 0 : found->second;
  }

  std::unique_ptr<LiveNode> node_ = std::make_unique<LiveNode>(LiveOptions());
  std::vector<LiveUpdate> updates_;
  double now_s_ = 5.0;
  int num_sent_ = 0;
};

TEST_F(LiveNodeTest, MapsLikeTheOnlineMapper) {
  constexpr int kNumScans = 60;
  UseOptions(Repeatable());
  node_->AddTransforms(Robot().StaticTransforms());
  SendUpTo(kNumScans);
  ASSERT_EQ(updates_.size(), static_cast<std::size_t>(kNumScans));
  EXPECT_THAT(node_->TakeNews(), IsEmpty());

  LaserPlace place;
  place.robot_from_laser = {0.2, 0.0, 0.0};
  OnlineMapper mapper({LaserOf(Robot().Scan(0), place)});
  for (int i = 0; i < kNumScans; ++i) {
    OnlinePose now;
    const Pose2 odometry =
        InPlane(Eigen::Translation3d(PlanarPose(Robot().log().scans[i].odom_from_robot).position) *
                PlanarPose(Robot().log().scans[i].odom_from_robot).rotation.normalized());
    ASSERT_TRUE(mapper.AddScan({Robot().StampS(i), Robot().Scan(i).ranges}, odometry, &now).ok());
    ASSERT_TRUE(mapper.Wait().ok());
    EXPECT_EQ(updates_[i].stamp_s, Robot().StampS(i));
    EXPECT_EQ(updates_[i].child_frame, "odom");
    EXPECT_EQ(updates_[i].map_from_base.x, now.map_from_robot.x);
    EXPECT_EQ(updates_[i].map_from_base.y, now.map_from_robot.y);
    EXPECT_EQ(updates_[i].map_from_base.yaw, now.map_from_robot.yaw);
    const Pose2 back = updates_[i].map_from_child * odometry;
    EXPECT_NEAR(back.x, now.map_from_robot.x, 1e-9);
    EXPECT_NEAR(back.y, now.map_from_robot.y, 1e-9);
  }
  OnlineMap expected;
  ASSERT_TRUE(mapper.GetMap(&expected).ok());
  LiveMap map;
  ASSERT_TRUE(node_->BuildMap(&map).ok());
  EXPECT_EQ(map.num_scans, kNumScans);
  EXPECT_EQ(map.num_closures, expected.num_closures);
  EXPECT_EQ(map.stamp_s, Robot().StampS(kNumScans - 1));
  ASSERT_GT(map.path.size(), 10u);
  EXPECT_EQ(map.path.back().world_from_robot.x, expected.map_from_robot.back().x);
  EXPECT_GT(std::count(map.grid.cells.begin(), map.grid.cells.end(), Occupancy::kOccupied), 500);
  EXPECT_GT(std::count(map.grid.cells.begin(), map.grid.cells.end(), Occupancy::kFree), 5000);
}

TEST_F(LiveNodeTest, TakesOdometryMessages) {
  LiveOptions options = Repeatable();
  options.odometry_by_messages = true;
  options.odom_frame = "elsewhere";
  UseOptions(options);
  node_->AddTransforms(Robot().StaticTransforms());
  for (int i = 0; i < 20; ++i) {
    node_->AddOdometry(Robot().Odometry(i));
    Send(i, false);
  }
  ASSERT_EQ(updates_.size(), 20u);
  EXPECT_EQ(updates_.back().child_frame, "odom");
  EXPECT_LT(ErrorM(19, updates_.back().map_from_base), 0.1);
}

TEST_F(LiveNodeTest, WaitsForTransformsAndOdometry) {
  Send(0);
  EXPECT_THAT(updates_, IsEmpty());
  EXPECT_EQ(node_->Report().state, "waiting for transforms and odometry");
  node_->AddTransforms(Robot().StaticTransforms());
  Work();
  EXPECT_EQ(updates_.size(), 1u);
  // The odometry of this one comes later.
  Send(1, false);
  EXPECT_EQ(updates_.size(), 1u);
  now_s_ += 0.1;
  node_->AddTransforms(Robot().OdometryTransform(1));
  Work();
  EXPECT_EQ(updates_.size(), 2u);
  EXPECT_THAT(node_->TakeNews(), IsEmpty());
  // That of this one never.
  Send(2, false);
  now_s_ += 0.25;
  Work();
  ASSERT_EQ(updates_.size(), 3u);
  EXPECT_EQ(updates_.back().child_frame, "base_link");
  // Nobody waits for odometry that has ceased.
  Send(3, false);
  EXPECT_EQ(updates_.size(), 4u);
  EXPECT_THAT(node_->TakeNews(), ElementsAre(StartsWith("scans without odometry of their time")));
  Send(4);
  ASSERT_EQ(updates_.size(), 5u);
  EXPECT_EQ(updates_.back().child_frame, "odom");
  EXPECT_EQ(Count("scans without odometry of their time"), 2u);
}

TEST_F(LiveNodeTest, MapsScansAlone) {
  for (int i = 0; i < 5; ++i) Send(i, false);
  EXPECT_THAT(updates_, IsEmpty());
  now_s_ += 3.5;
  Work();
  ASSERT_EQ(updates_.size(), 5u);
  EXPECT_EQ(updates_.back().child_frame, "laser");
  EXPECT_THAT(node_->TakeNews(),
              ElementsAre(StartsWith("no odometry: no transform joins 'laser'")));
  EXPECT_LT((updates_.back().map_from_base.translation() -
             Between(Robot().log().scans[0].world_from_robot * Pose2(0.2, 0.0, 0.0),
                     Robot().log().scans[4].world_from_robot * Pose2(0.2, 0.0, 0.0))
                 .translation())
                .norm(),
            0.1);
}

TEST_F(LiveNodeTest, TellsAndCountsBadMessages) {
  node_->AddTransforms(Robot().StaticTransforms());
  SendUpTo(3);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  RosScan scan = Robot().Scan(3);
  const auto refuse = [&](const RosScan& bad) {
    node_->AddScan(bad, now_s_);
    node_->AddScan(bad, now_s_);
    Work();
  };
  scan.angle_min_rad = kNaN;
  refuse(scan);
  scan = Robot().Scan(3);
  scan.ranges.assign(200000, 1.0);
  scan.angle_max_rad = scan.angle_min_rad + 199999 * scan.angle_increment_rad;
  refuse(scan);
  scan = Robot().Scan(3);
  scan.stamp_s = kNaN;
  refuse(scan);
  scan.stamp_s = 1e300;
  refuse(scan);
  EXPECT_EQ(updates_.size(), 3u);
  EXPECT_THAT(node_->TakeNews(),
              ElementsAre("scans that are no sweep of a laser: field 'angle_min' is not finite"));
  EXPECT_EQ(Count("scans that are no sweep of a laser"), 8u);

  std::vector<RosTransform> transforms = Robot().OdometryTransform(3);
  transforms[0].pose.position.x() = kNaN;
  node_->AddTransforms(transforms);
  transforms[0].pose = RosPose();
  transforms[0].pose.rotation.w() = 7.0;
  node_->AddTransforms(transforms);
  transforms[0].child_frame = "odom";
  transforms[0].pose = RosPose();
  node_->AddTransforms(transforms);
  EXPECT_EQ(Count("transforms of no use"), 3u);
  node_->AddOdometry(Robot().Odometry(3));
  EXPECT_EQ(Count("odometry of no use"), 1u);
  node_->AddFault("messages that cannot be decoded", "field 'ranges': too long");
  EXPECT_EQ(Count("messages that cannot be decoded"), 1u);
  EXPECT_EQ(node_->TakeNews().size(), 3u);

  // All readings NaN: a scan that sees nothing.
  scan = Robot().Scan(3);
  std::fill(scan.ranges.begin(), scan.ranges.end(), kNaN);
  node_->AddTransforms(Robot().OdometryTransform(3));
  node_->AddScan(scan, now_s_);
  Work();
  EXPECT_EQ(updates_.size(), 4u);
  num_sent_ = 4;
  SendUpTo(10);
  EXPECT_EQ(updates_.size(), 10u);
  EXPECT_LT(ErrorM(9, updates_.back().map_from_base), 0.1);
}

TEST_F(LiveNodeTest, KeepsToOneFrame) {
  node_->AddTransforms(Robot().StaticTransforms());
  SendUpTo(3);
  RosScan other = Robot().Scan(3);
  other.frame = "rear_laser";
  node_->AddScan(other, now_s_);
  Work();
  EXPECT_EQ(updates_.size(), 3u);
  EXPECT_THAT(node_->TakeNews(),
              ElementsAre("scans of another frame: 'rear_laser' instead of 'laser'"));
  num_sent_ = 4;
  SendUpTo(6);
  EXPECT_EQ(updates_.size(), 5u);
  // A new map takes the frame of its first scan.
  node_->Clear();
  node_->AddTransforms({{0.0, "base_link", "rear_laser", PlanarPose({0.2, 0.0, 0.0})},
                        Robot().OdometryTransform(6)[0]});
  other.stamp_s = Robot().StampS(6);
  node_->AddScan(other, now_s_);
  Work();
  EXPECT_EQ(updates_.size(), 6u);
  EXPECT_EQ(updates_.back().map_from_base.x, 0.0);
}

TEST_F(LiveNodeTest, GoesOnWhenTheClockJumps) {
  node_->AddTransforms(Robot().StaticTransforms());
  SendUpTo(20);
  const auto send_with_clock = [&](int i, double offset_s) {
    std::vector<RosTransform> transforms = Robot().OdometryTransform(i);
    transforms[0].stamp_s += offset_s;
    node_->AddTransforms(transforms);
    RosScan scan = Robot().Scan(i);
    scan.stamp_s += offset_s;
    node_->AddScan(scan, now_s_);
    now_s_ += 0.3;
    Work();
  };
  for (int i = 20; i < 30; ++i) send_with_clock(i, -60.0);
  ASSERT_EQ(updates_.size(), 30u);
  EXPECT_EQ(updates_.back().stamp_s, Robot().StampS(29) - 60.0);
  EXPECT_LT(ErrorM(29, updates_.back().map_from_base), 0.2);
  for (int i = 30; i < 40; ++i) send_with_clock(i, 1e6);
  ASSERT_EQ(updates_.size(), 40u);
  EXPECT_LT(ErrorM(39, updates_.back().map_from_base), 0.2);
  EXPECT_EQ(Count("jumps of the clock"), 1u);
  EXPECT_EQ(Count("gaps in the scans"), 1u);
  // Late by a little.
  RosScan late = Robot().Scan(39);
  late.stamp_s += 1e6 - 0.2;
  node_->AddScan(late, now_s_);
  Work();
  EXPECT_EQ(updates_.size(), 40u);
  EXPECT_EQ(Count("scans older than the one before"), 1u);
}

TEST_F(LiveNodeTest, StaysBoundedInAFlood) {
  node_->AddTransforms(Robot().StaticTransforms());
  SendUpTo(2);
  // A kilohertz.
  RosScan scan = Robot().Scan(2);
  for (int i = 0; i < 1000; ++i) {
    scan.stamp_s = Robot().StampS(2) + 0.001 * i;
    node_->AddScan(scan, now_s_);
  }
  EXPECT_GT(Count("scans too soon after the one before"), 900u);
  // Nothing is mapped meanwhile.
  for (int i = 0; i < 1000; ++i) {
    scan.stamp_s = Robot().StampS(3) + 0.1 * i;
    node_->AddScan(scan, now_s_);
  }
  EXPECT_GE(Count("scans that came faster than they were mapped"), 800u);
  EXPECT_EQ(node_->TakeNews().size(), 2u);
  now_s_ += 1.0;
  Work();
  EXPECT_EQ(updates_.size(), 202u);
}

TEST_F(LiveNodeTest, MapsASecondlyScanWhileTheRobotRests) {
  node_->AddTransforms(Robot().StaticTransforms());
  SendUpTo(2);
  for (int i = 1; i <= 95; ++i) {
    RosScan scan = Robot().Scan(1);
    std::vector<RosTransform> transforms = Robot().OdometryTransform(1);
    scan.stamp_s += 0.1 * i;
    transforms[0].stamp_s = scan.stamp_s;
    node_->AddTransforms(transforms);
    node_->AddScan(scan, now_s_);
    Work();
  }
  EXPECT_EQ(updates_.size(), 97u);
  const LiveReport report = node_->Report();
  EXPECT_NEAR(static_cast<double>(report.num_mapped), 11.0, 1.0);
  EXPECT_EQ(report.num_mapped + report.num_resting, 97u);
  EXPECT_NEAR(updates_.back().map_from_base.x, updates_[1].map_from_base.x, 0.02);
  EXPECT_THAT(node_->TakeNews(), IsEmpty());
}

TEST_F(LiveNodeTest, ResamplesOtherBeams) {
  node_->AddTransforms(Robot().StaticTransforms());
  SendUpTo(10);
  for (int i = 10; i < 20; ++i) {
    RosScan scan = Robot().Scan(i);
    scan.ranges.pop_back();
    scan.angle_max_rad -= scan.angle_increment_rad;
    node_->AddTransforms(Robot().OdometryTransform(i));
    node_->AddScan(scan, now_s_);
    Work();
  }
  ASSERT_EQ(updates_.size(), 20u);
  EXPECT_LT(ErrorM(19, updates_.back().map_from_base), 0.1);
  RosScan backwards = Robot().Scan(20);
  backwards.angle_min_rad += kPi;
  backwards.angle_max_rad += kPi;
  node_->AddTransforms(Robot().OdometryTransform(20));
  node_->AddScan(backwards, now_s_);
  Work();
  EXPECT_EQ(updates_.size(), 20u);
  EXPECT_THAT(node_->Report().faults,
              ElementsAre(Pair("scans with other beams than the first one", 11)));
}

TEST_F(LiveNodeTest, PausesAndClears) {
  LiveMap map;
  EXPECT_FALSE(node_->BuildMap(&map).ok());
  node_->AddTransforms(Robot().StaticTransforms());
  SendUpTo(10);
  node_->Pause(true);
  EXPECT_EQ(node_->Report().state, "paused");
  SendUpTo(15);
  EXPECT_EQ(updates_.size(), 10u);
  node_->Pause(false);
  SendUpTo(20);
  EXPECT_EQ(updates_.size(), 15u);
  EXPECT_LT(ErrorM(19, updates_.back().map_from_base), 0.1);
  EXPECT_TRUE(node_->BuildMap(&map).ok());
  node_->Clear();
  EXPECT_FALSE(node_->BuildMap(&map).ok());
  SendUpTo(21);
  EXPECT_EQ(updates_.back().map_from_base.x, 0.0);
  EXPECT_EQ(node_->Report().num_mapped, 1u);
}

TEST_F(LiveNodeTest, TakesALaserThatHangsUpsideDown) {
  RosTransform mounting = Robot().StaticTransforms()[0];
  mounting.pose.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  node_->AddTransforms({mounting});
  for (int i = 0; i < 10; ++i) {
    RosScan scan = Robot().Scan(i);
    std::reverse(scan.ranges.begin(), scan.ranges.end());
    node_->AddTransforms(Robot().OdometryTransform(i));
    node_->AddScan(scan, now_s_);
    Work();
  }
  ASSERT_EQ(updates_.size(), 10u);
  EXPECT_LT(ErrorM(9, updates_.back().map_from_base), 0.1);
}

TEST_F(LiveNodeTest, LeavesOutScansOfATiltedLaser) {
  RosTransform mounting = Robot().StaticTransforms()[0];
  mounting.pose.rotation = Eigen::Quaterniond(std::cos(0.1), std::sin(0.1), 0.0, 0.0);
  node_->AddTransforms({mounting});
  SendUpTo(5);
  EXPECT_THAT(updates_, IsEmpty());
  EXPECT_THAT(node_->TakeNews(), ElementsAre(HasSubstr("is tilted by")));
}

// The map of the first scans, saved and read again.
class SavedLiveMapTest : public LiveNodeTest {
 protected:
  static constexpr int kNumSaved = 150;

  void SaveMap() {
    node_->AddTransforms(Robot().StaticTransforms());
    SendUpTo(kNumSaved);
    MappedDrive drive;
    ASSERT_TRUE(node_->MapNow(&drive).ok());
    EXPECT_FALSE(drive.continues_map);
    EXPECT_EQ(drive.mapping.graph.num_scans(), kNumSaved);
    const Status status = SaveLiveMap(LiveOptions().mapper.map, 0.05, folder_, std::move(drive));
    ASSERT_TRUE(status.ok()) << status.message();
  }
  // A node that begins in the saved map, the next day.
  void BeginIn(bool is_fixed) {
    SlamGraph map;
    const Status status = ReadSavedMap(folder_ + "map.g2o", is_fixed, &map);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(map.num_scans(), kNumSaved);
    UseOptions(Repeatable());
    node_->UseMap(std::move(map));
    node_->AddTransforms(Robot().StaticTransforms());
    updates_.clear();
  }

  const std::string folder_ = TempFolder() + "map/";
};

TEST_F(SavedLiveMapTest, FindsTheRobotInAFixedMap) {
  SaveMap();
  BeginIn(true);
  Send(20);
  EXPECT_EQ(node_->Report().state, "looking for its place in the saved map");
  LiveMap map;
  ASSERT_TRUE(node_->BuildMap(&map).ok());
  EXPECT_GT(map.grid.cells.size(), 10000u);
  EXPECT_THAT(map.path, IsEmpty());
  int num_sent = 1;
  while (updates_.empty() && num_sent < 120) Send(20 + num_sent++);
  ASSERT_FALSE(updates_.empty());
  // Within a place of overlap.
  EXPECT_LT((Robot().log().scans[20 + num_sent - 1].world_from_robot.translation() -
             Robot().log().scans[20].world_from_robot.translation())
                .norm(),
            20.0);
  EXPECT_EQ(node_->Report().state, "localising");
  EXPECT_LT(ErrorM(20 + num_sent - 1, updates_.back().map_from_base), 0.2);
  for (int i = num_sent; i < num_sent + 10; ++i) Send(20 + i);
  EXPECT_LT(ErrorM(20 + num_sent + 9, updates_.back().map_from_base), 0.1);
  MappedDrive drive;
  EXPECT_THAT(node_->MapNow(&drive).message(), HasSubstr("which stays as it is"));
  LiveMap later;
  ASSERT_TRUE(node_->BuildMap(&later).ok());
  EXPECT_EQ(later.grid.cells, map.grid.cells);
  EXPECT_GT(later.path.size(), 5u);
}

TEST_F(SavedLiveMapTest, ContinuesAMap) {
  SaveMap();
  LiveMap first;
  ASSERT_TRUE(node_->BuildMap(&first).ok());
  BeginIn(false);
  for (int i = kNumSaved - 70; i < kNumSaved + 20; ++i) Send(i);
  ASSERT_FALSE(updates_.empty());
  EXPECT_EQ(node_->Report().state, "mapping");
  EXPECT_LT(ErrorM(kNumSaved + 19, updates_.back().map_from_base), 0.2);
  LiveMap map;
  ASSERT_TRUE(node_->BuildMap(&map).ok());
  EXPECT_GT(std::count(map.grid.cells.begin(), map.grid.cells.end(), Occupancy::kFree),
            std::count(first.grid.cells.begin(), first.grid.cells.end(), Occupancy::kFree));
  MappedDrive drive;
  ASSERT_TRUE(node_->MapNow(&drive).ok());
  EXPECT_TRUE(drive.continues_map);
  EXPECT_EQ(drive.mapping.graph.num_scans(), kNumSaved + 90);
  const Status status = SaveLiveMap(LiveOptions().mapper.map, 0.05, folder_, std::move(drive));
  EXPECT_TRUE(status.ok()) << status.message();
  node_->Clear();
  Send(kNumSaved + 20);
  EXPECT_EQ(updates_.back().map_from_base.x, 0.0);
}

TEST_F(SavedLiveMapTest, NamesAFileThatIsNoMap) {
  SlamGraph map;
  EXPECT_FALSE(ReadSavedMap(folder_ + "map.g2o", true, &map).ok());
  const std::string path = TempFolder() + "a.txt";
  WriteFile(path, "nothing");
  EXPECT_THAT(ReadSavedMap(path, true, &map).message(), HasSubstr("no pose graph with scans"));
  WriteFile(path, "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n");
  EXPECT_FALSE(ReadSavedMap(path, true, &map).ok());
}

TEST(LiveOptionsTest, ChecksItsFields) {
  LiveOptions options;
  std::string error;
  EXPECT_TRUE(options.Check(&error));
  options.resolution_m = 0.0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_THAT(error, HasSubstr("resolution_m = 0"));
  options = LiveOptions();
  options.base_frame.clear();
  EXPECT_FALSE(options.Check(&error));
}

}  // namespace
}  // namespace plumbline
