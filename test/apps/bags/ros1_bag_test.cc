#include "plumbline/apps/bags/ros1_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "plumbline/test/core/temp_file.h"

#ifndef PLUMBLINE_HAS_ROSBAG

namespace plumbline {
namespace {

TEST(Ros1BagTest, WithoutTheLibraryABagIsAnErrorThatSaysSo) {
  std::unique_ptr<BagContainer> bag;
  const Status status = OpenRos1Bag("a.bag", &bag);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(),
              testing::HasSubstr("a.bag: a bag of ROS 1, which this build cannot"));
  EXPECT_THAT(status.message(), testing::HasSubstr("librosbag-storage-dev"));
}

TEST(Ros1BagTest, ReadsBags) {
  GTEST_SKIP() << "built without librosbag_storage: nothing to read bags with";
}

}  // namespace
}  // namespace plumbline

#else

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <limits>

#include "plumbline/apps/simulation/building_reader.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"
#include "plumbline/test/apps/bags/bag_file_testing.h"
#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kStart_s = 1500000000.0;  // as of a clock on the wall

geometry_msgs::Quaternion Rotation(double yaw, bool upside_down = false) {
  const Eigen::Quaterniond q =
      Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
      Eigen::Quaterniond(Eigen::AngleAxisd(upside_down ? kPi : 0.0, Eigen::Vector3d::UnitX()));
  geometry_msgs::Quaternion rotation;
  rotation.w = q.w();
  rotation.x = q.x();
  rotation.y = q.y();
  rotation.z = q.z();
  return rotation;
}

nav_msgs::Odometry Odometry(double stamp_s, const Pose2& pose) {
  nav_msgs::Odometry message;
  message.header.stamp = ros::Time(stamp_s);
  message.header.frame_id = "odom";
  message.child_frame_id = "base_link";
  message.pose.pose.position.x = pose.x;
  message.pose.pose.position.y = pose.y;
  message.pose.pose.orientation = Rotation(pose.yaw);
  return message;
}

tf2_msgs::TFMessage Transform(double stamp_s, const std::string& parent, const std::string& child,
                              const Pose2& pose, bool upside_down = false) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time(stamp_s);
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform.translation.x = pose.x;
  transform.transform.translation.y = pose.y;
  transform.transform.translation.z = 0.2;
  transform.transform.rotation = Rotation(pose.yaw, upside_down);
  tf2_msgs::TFMessage message;
  message.transforms.push_back(transform);
  return message;
}

sensor_msgs::LaserScan Scan(double stamp_s, const std::vector<double>& ranges,
                            const LaserModel& laser) {
  sensor_msgs::LaserScan message;
  message.header.stamp = ros::Time(stamp_s);
  message.header.frame_id = "laser";
  message.angle_min = static_cast<float>(laser.first_bearing_rad);
  message.angle_increment = static_cast<float>(laser.bearing_step_rad);
  message.range_min = static_cast<float>(laser.min_range_m);
  message.range_max = static_cast<float>(laser.max_range_m);
  message.ranges.assign(ranges.begin(), ranges.end());
  return message;
}

// Writes bags and reads them again.
class Ros1BagTest : public ProgramTest, public BagFile {
 protected:
  Ros1BagTest() : BagFile(folder_ + "a.bag") {}

  // Writes with the stamp as time of arrival.
  template <typename Message>
  void Write(const std::string& topic, double stamp_s, const Message& message) {
    bag_.write(topic, ros::Time(stamp_s), message);
  }
  void Open(rosbag::CompressionType compression = rosbag::compression::Uncompressed) {
    bag_.open(path_, rosbag::bagmode::Write);
    bag_.setCompression(compression);
  }
  // Two scans and their odometry.
  void WriteSmallBag(rosbag::CompressionType compression = rosbag::compression::Uncompressed) {
    Open(compression);
    WriteSmallDrive("/scan");
    bag_.close();
  }
  void WriteSmallDrive(const std::string& scan_topic) {
    LaserModel laser;
    laser.num_beams = 3;
    laser.first_bearing_rad = -0.5;
    laser.bearing_step_rad = 0.5;
    laser.max_range_m = 30.0;
    for (int i = 0; i < 2; ++i) {
      const double stamp_s = kStart_s + i;
      Write("/odom", stamp_s, Odometry(stamp_s, {0.1 * i, 0.0, 0.2 * i}));
      Write(scan_topic, stamp_s, Scan(stamp_s, {1.25, std::nan(""), 3.5}, laser));
    }
  }

  rosbag::Bag bag_;
};

TEST_F(Ros1BagTest, ReadsWhatTheMessagesSay) {
  for (const rosbag::CompressionType compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    WriteSmallBag(compression);
    const RosRecording recording = Read();
    EXPECT_EQ(recording.scan_topic, "/scan");
    EXPECT_EQ(recording.odom_topic, "/odom");
    EXPECT_EQ(recording.odom_frame, "odom");
    EXPECT_EQ(recording.robot_frame, "base_link");
    ASSERT_EQ(recording.scans.size(), 2u);
    const RosScan& scan = recording.scans[1];
    EXPECT_EQ(scan.stamp_s, kStart_s + 1.0);
    EXPECT_EQ(scan.frame, "laser");
    EXPECT_EQ(scan.angle_min_rad, -0.5);
    EXPECT_EQ(scan.angle_increment_rad, 0.5);
    EXPECT_EQ(scan.range_min_m, 0.05f);
    EXPECT_EQ(scan.range_max_m, 30.0);
    ASSERT_EQ(scan.ranges.size(), 3u);
    EXPECT_EQ(scan.ranges[0], 1.25);
    EXPECT_TRUE(std::isnan(scan.ranges[1]));
    EXPECT_EQ(scan.ranges[2], 3.5);
    ASSERT_EQ(recording.odometry.size(), 2u);
    EXPECT_EQ(recording.odometry[1].timestamp_s, kStart_s + 1.0);
    EXPECT_NEAR(recording.odometry[1].world_from_robot.x, 0.1, 1e-12);
    EXPECT_NEAR(recording.odometry[1].world_from_robot.yaw, 0.2, 1e-12);
  }
}

TEST_F(Ros1BagTest, TransformsKeepNoLeadingSlash) {
  Open();
  WriteSmallDrive("/scan");
  Write("/tf", kStart_s, Transform(kStart_s, "/base_link", "/laser", {0.1, 0.2, 0.3}, true));
  bag_.close();
  const RosRecording recording = Read();
  std::optional<Eigen::Isometry3d> transform;
  ASSERT_TRUE(recording.transforms.Find("base_link", "laser", kStart_s, &transform).ok());
  ASSERT_TRUE(transform);
  EXPECT_NEAR(InPlane(*transform).yaw, 0.3, 1e-12);
  EXPECT_NEAR(transform->linear()(2, 2), -1.0, 1e-12);
}

TEST_F(Ros1BagTest, OneOfTwoScanTopicsHasToBeChosen) {
  Open();
  WriteSmallDrive("/front/scan");
  WriteSmallDrive("/rear/scan");
  bag_.close();
  EXPECT_THAT(Fails().message(),
              AllOf(HasSubstr("--scan_topic"), HasSubstr("/front/scan (sensor_msgs/LaserScan)"),
                    HasSubstr("/rear/scan"), HasSubstr("/odom (nav_msgs/Odometry)")));
  BagReadOptions options;
  options.scan_topic = "rear/scan";
  EXPECT_EQ(Read(options).scan_topic, "/rear/scan");
  options.scan_topic = "/scan";
  EXPECT_THAT(Fails(options).message(), HasSubstr("there is no topic '/scan'"));
  options.scan_topic = "/odom";
  EXPECT_THAT(Fails(options).message(), HasSubstr("/odom is not of type sensor_msgs/LaserScan"));
  options.scan_topic = "/rear/scan";
  options.odom_topic = "/front/scan";
  EXPECT_THAT(Fails(options).message(), HasSubstr("/front/scan is neither of type"));
  options.odom_frame.clear();
  EXPECT_FALSE(options.Check(nullptr));
}

TEST_F(Ros1BagTest, TheTransformsTellTheOdometryIfAskedOrIfNothingElseDoes) {
  Open();
  WriteSmallDrive("/scan");
  Write("/tf", kStart_s, Transform(kStart_s, "wheels", "base_link", {}));
  bag_.close();
  BagReadOptions options;
  options.odom_topic = "/tf";
  options.odom_frame = "/wheels";
  const RosRecording recording = Read(options);
  EXPECT_EQ(recording.odom_topic, "");
  EXPECT_EQ(recording.odom_frame, "wheels");
  EXPECT_THAT(recording.odometry, IsEmpty());
}

TEST_F(Ros1BagTest, ABagWithoutScansListsItsTopics) {
  Open();
  Write("/odom", kStart_s, Odometry(kStart_s, {}));
  bag_.close();
  EXPECT_THAT(Fails().message(), AllOf(HasSubstr("no topic of type sensor_msgs/LaserScan"),
                                       HasSubstr("the bag has /odom (nav_msgs/Odometry)")));
}

TEST_F(Ros1BagTest, APoseThatIsNoneIsNamed) {
  Open();
  WriteSmallDrive("/scan");
  nav_msgs::Odometry odometry = Odometry(kStart_s + 2.0, {});
  odometry.pose.pose.orientation.w = 2.0;
  Write("/odom", kStart_s + 2.0, odometry);
  bag_.close();
  EXPECT_THAT(Fails().message(),
              HasSubstr("/odom message 2 (1500000002.000000 s): field 'pose.pose' has a quaternion "
                        "that is no rotation"));
  Open();
  WriteSmallDrive("/scan");
  Write("/tf", kStart_s + 2.0, Transform(0.0, "base_link", "laser", {std::nan(""), 0.0, 0.0}));
  bag_.close();
  EXPECT_THAT(Fails().message(),
              HasSubstr("/tf message 0 (1500000002.000000 s): the transform from 'base_link' to "
                        "'laser' is not finite"));
}

TEST_F(Ros1BagTest, DamageIsAnError) {
  WriteSmallBag(rosbag::compression::LZ4);
  const std::string whole = ReadFile(path_);
  for (const std::size_t size : {whole.size() / 2, whole.size() - 100, std::size_t{20}}) {
    WriteFile(path_, whole.substr(0, size));
    const Status status = Fails();
    EXPECT_EQ(status.code(), StatusCode::kDataLoss) << size;
    EXPECT_THAT(status.message(), HasSubstr("cannot be read as a ROS bag"));
  }
  // What an interrupted recording leaves: the header says that there is no index.
  std::string unindexed = whole;
  const std::size_t field = unindexed.find("index_pos=") + 10;
  unindexed.replace(field, 8, std::string(8, '\0'));
  WriteFile(path_, unindexed);
  EXPECT_THAT(Fails().message(), AllOf(HasSubstr("unindexed"), HasSubstr("rosbag reindex")));
  std::string corrupt = whole;
  corrupt.replace(4300, 60, std::string(60, 'x'));
  WriteFile(path_, corrupt);
  EXPECT_EQ(Fails().code(), StatusCode::kDataLoss);
  std::filesystem::remove(path_);
  EXPECT_EQ(Fails().code(), StatusCode::kNotFound);
}

// A drive through the small building, with a laser that hangs upside down behind the robot's centre
// and is mirrored, as its driver sends it. No odometry topic: all is told by transforms.
class Ros1DriveTest : public Ros1BagTest {
 protected:
  static constexpr int kNumScans = 150;

  void SimulateDrive() {
    Building building;
    ASSERT_TRUE(ReadBuilding(PLUMBLINE_WORLD, &building).ok());
    SimulationOptions options;
    options.laser.robot_from_laser = {-0.1, 0.03, 0.2};
    options.laser.max_range_m = 20.0;
    ASSERT_TRUE(Simulate(World(building), options, &log_).ok());
    log_.scans.resize(kNumScans);
  }
  double Stamp(int scan) const { return kStart_s + log_.scans[scan].scan.timestamp_s; }

  void WriteDrive(bool as_transforms, bool upside_down = true) {
    Open(rosbag::compression::LZ4);
    LaserModel laser = log_.laser;
    if (upside_down) {
      laser.first_bearing_rad = -laser.first_bearing_rad;
      laser.bearing_step_rad = -laser.bearing_step_rad;
    }
    Write("/tf_static", kStart_s,
          Transform(0.0, "base_link", "laser", log_.laser.robot_from_laser, upside_down));
    for (int i = 0; i < kNumScans; ++i) {
      const Pose2& pose = log_.scans[i].odom_from_robot;
      if (as_transforms) {
        Write("/tf", Stamp(i), Transform(Stamp(i), "odom", "base_link", pose));
      } else {
        Write("/odom", Stamp(i), Odometry(Stamp(i), pose));
      }
      Write("/scan", Stamp(i), Scan(Stamp(i), log_.scans[i].scan.ranges, laser));
    }
    bag_.close();
  }

  void WriteTruth() const {
    std::vector<TimedPose> truth;
    for (int i = 0; i < kNumScans; ++i) truth.push_back({Stamp(i), log_.scans[i].world_from_robot});
    ASSERT_TRUE(WriteTumTrajectory(folder_ + "truth.tum", truth).ok());
  }

  void ExpectDrive() const {
    const RosRecording recording = Read();
    RosGraphNotes notes;
    SlamGraph graph;
    const Status status = BuildGraph(recording, RosGraphOptions(), 0, &notes, &graph);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_THAT(notes.warnings, IsEmpty());
    ASSERT_EQ(graph.num_scans(), kNumScans);
    const Pose2& start = log_.scans[0].odom_from_robot;
    for (int i = 0; i < kNumScans; ++i) {
      const Pose2 expected = Between(start, log_.scans[i].odom_from_robot);
      const Pose2 off = Between(expected, graph.InitialPose(i));
      EXPECT_LT(std::hypot(off.x, off.y) + std::abs(off.yaw), 1e-9) << i;
      EXPECT_EQ(graph.timestamp_s(i), ros::Time(Stamp(i)).toSec());
    }
    const LaserModel& laser = graph.laser(0);
    EXPECT_NEAR(laser.robot_from_laser.x, -0.1, 1e-12);
    EXPECT_NEAR(laser.robot_from_laser.y, 0.03, 1e-12);
    EXPECT_NEAR(laser.robot_from_laser.yaw, 0.2, 1e-12);
    EXPECT_EQ(laser.first_bearing_rad, static_cast<float>(log_.laser.first_bearing_rad));
    std::size_t num_returns = 0;
    for (const SimulatedScan& scan : log_.scans) {
      for (const double range_m : scan.scan.ranges) {
        if (!log_.laser.IsReturn(range_m)) continue;
        ASSERT_EQ(graph.returns().range_m[num_returns++], static_cast<float>(range_m));
      }
    }
    EXPECT_EQ(graph.num_returns(), num_returns);
  }

  SimulatedLog log_;
};

TEST_F(Ros1DriveTest, RangesPosesAndMountingAreThoseOfTheDrive) {
  SimulateDrive();
  for (const bool as_transforms : {false, true}) {
    WriteDrive(as_transforms);
    ExpectDrive();
  }
}

TEST_F(Ros1DriveTest, TheExampleMapsOdometryMessages) {
  SimulateDrive();
  log_.laser.robot_from_laser = {};  // as the example has it; the odometry then moves the laser
  for (SimulatedScan& scan : log_.scans) {
    scan.odom_from_robot = scan.odom_from_robot * Pose2(-0.1, 0.03, 0.2);
    scan.world_from_robot = scan.world_from_robot * Pose2(-0.1, 0.03, 0.2);
  }
  WriteDrive(false, false);
  WriteTruth();
  const std::string topics = " /scan /odom ";
  const Outcome run = Run("example_refine_bag", path_ + topics + folder_ + "a.tum");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("150 scans, 150 of them with odometry"));
  const Outcome measured = Run("evaluate", "--trajectory=" + folder_ + "a.tum --truth=" + folder_ +
                                               "truth.tum --json=" + folder_ + "a.json");
  ASSERT_EQ(measured.exit_code, 0) << measured.err;
  const auto figures = nlohmann::json::parse(ReadFile(folder_ + "a.json"));
  EXPECT_LT(figures["absolute"]["translation_m"]["mean"], 0.005) << figures.dump(1);

  EXPECT_THAT(Run("example_refine_bag", path_ + " /scan /none " + folder_ + "b.tum").err,
              HasSubstr("no scan on /scan has odometry on /none"));
  EXPECT_THAT(Run("example_refine_bag", folder_ + "none.bag" + topics + folder_ + "b.tum").err,
              HasSubstr("none.bag"));
}

TEST_F(Ros1DriveTest, TheProgramsMapAndMeasureABag) {
  SimulateDrive();
  WriteDrive(true);
  WriteTruth();
  const Outcome run = Slam("a.bag", "--truth=" + folder_ + "truth.tum");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_EQ(FilesOf("out"), kResults);
  const nlohmann::json stages = Summary()["stages"];
  EXPECT_LT(stages[3]["mean_pose_error_m"], 0.005);
  EXPECT_LT(stages[3]["mean_pose_error_m"], 0.1 * stages[0]["mean_pose_error_m"].get<double>());
  EXPECT_EQ(Summary()["flags"]["odom_frame"], "odom");

  const Outcome measured =
      Run("evaluate", "--trajectory=" + folder_ + "out/trajectory.tum --log=" + path_ +
                          " --json=" + folder_ + "a.json");
  ASSERT_EQ(measured.exit_code, 0) << measured.err;
  EXPECT_THAT(measured.out, HasSubstr("map, raw ranges"));
  EXPECT_THAT(measured.err, IsEmpty());

  const Outcome failed = Slam("a.bag", "--odom_frame=wheels", "other");
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.err, HasSubstr("no frame 'wheels' above the laser's"));
}

}  // namespace
}  // namespace plumbline

#endif
