#include "plumbline/apps/bags/ros1_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/building_reader.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"
#include "plumbline/test/apps/bags/bag_file_testing.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/ros1_writer.h"
#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr TestEncoding kRos1 = TestEncoding::kRos1;

// Writes bags and reads them again.
class Ros1BagTest : public ProgramTest, public BagFile {
 protected:
  Ros1BagTest() : BagFile(folder_ + "a.bag") {}

  Status ReadContent(const std::string& content, std::string* messages) const {
    return ReadAll(MakeRos1Bag("x.bag", content).get(), messages);
  }
  // Reading fails with words on the record that begins behind `before`, both behind a good start.
  void ExpectDamaged(const std::string& before, const std::string& damaged,
                     const std::string& problem) const {
    const std::string start = Indexed(before);
    std::string messages;
    const Status status = ReadContent(Indexed(before + damaged) + kConnection, &messages);
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(),
                StartsWith("x.bag: cannot be read as a ROS bag: the record at byte " +
                           std::to_string(start.size()) + ": " + problem));
  }
  // These records behind a header that has the index follow them.
  static std::string Indexed(const std::string& records) {
    return kRos1Start + Ros1BagHeader(kRos1Start.size() + 4096 + records.size(), 1, 1) + records;
  }

  const std::string kConnection = Ros1Connection(0, "/scan", "sensor_msgs/LaserScan");
};

std::vector<Ros1Layout> Ros1Layouts() {
  std::vector<Ros1Layout> layouts;
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    for (const std::size_t messages_per_chunk : {1, 3, 100}) {
      for (const bool is_indexed : {true, false}) {
        layouts.push_back({compression, messages_per_chunk, is_indexed});
      }
    }
  }
  return layouts;
}

TEST_F(Ros1BagTest, ReadsWhatTheMessagesSay) {
  for (const Ros1Layout& layout : Ros1Layouts()) {
    WriteFile(path_, Ros1Bytes(SmallBag(kRos1), layout));
    const RosRecording recording = Read();
    EXPECT_EQ(recording.scan_topic, "/scan");
    EXPECT_EQ(recording.odom_topic, "/odom");
    EXPECT_EQ(recording.odom_frame, "odom");
    EXPECT_EQ(recording.robot_frame, "base_link");
    ASSERT_EQ(recording.scans.size(), 2u);
    const RosScan& scan = recording.scans[1];
    EXPECT_EQ(scan.stamp_s, 1500000000.25);
    EXPECT_EQ(scan.frame, "laser");
    EXPECT_EQ(scan.angle_min_rad, -0.5);
    EXPECT_EQ(scan.range_max_m, 30.0);
    ASSERT_EQ(scan.ranges.size(), 3u);
    EXPECT_EQ(scan.ranges[0], 1.25);
    EXPECT_TRUE(std::isnan(scan.ranges[1]));
    ASSERT_EQ(recording.odometry.size(), 2u);
    EXPECT_NEAR(recording.odometry[1].world_from_robot.x, 0.1, 1e-12);
    EXPECT_EQ(recording.omission.empty(), layout.is_indexed);
  }
}

TEST_F(Ros1BagTest, TopicsTypesTimesAndBytesAreThoseWritten) {
  std::string expected, messages;
  for (const TestMessage& message : SmallBag(kRos1)) {
    if (message.topic == "/image") continue;
    expected += message.topic + message.type + "ros1" +
                std::to_string(1e-9 * static_cast<double>(message.time_ns)) + message.bytes;
  }
  for (const Ros1Layout& layout : Ros1Layouts()) {
    const Status status = ReadContent(Ros1Bytes(SmallBag(kRos1), layout), &messages);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(messages, expected);
  }
}

TEST_F(Ros1BagTest, TransformsKeepNoLeadingSlash) {
  TestBag bag = SmallBag(kRos1);
  bag[0].bytes = TransformBytes(kRos1, 0, "/base_link", "/laser", {0.1, 0.2, 0.3}, true);
  WriteFile(path_, Ros1Bytes(bag));
  const RosRecording recording = Read();
  std::optional<TransformPath> path;
  ASSERT_TRUE(recording.transforms.FindPath("base_link", "laser", &path).ok());
  ASSERT_TRUE(path);
  const Eigen::Isometry3d transform = recording.transforms.At(*path, 1.5e9);
  EXPECT_NEAR(InPlane(transform).yaw, 0.3, 1e-12);
  EXPECT_NEAR(transform.linear()(2, 2), -1.0, 1e-12);
}

TEST_F(Ros1BagTest, ABagWithoutScansListsItsTopics) {
  TestBag bag = SmallBag(kRos1);
  bag.erase(bag.begin() + 2, bag.end());
  WriteFile(path_, Ros1Bytes(bag));
  EXPECT_THAT(Fails().message(), AllOf(HasSubstr("no topic of type sensor_msgs/LaserScan"),
                                       HasSubstr("the bag has /odom (nav_msgs/Odometry)")));
}

// Interrupted recordings are read up to the last whole record.
TEST_F(Ros1BagTest, EveryCutIsReadUpToTheLastWholeRecord) {
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    const std::string whole = Ros1Bytes(SmallBag(kRos1), {compression, 3, true});
    std::string all, messages, before;
    ASSERT_TRUE(ReadContent(whole, &all).ok());
    for (std::size_t size = kRos1Start.size() + 4096; size < whole.size(); ++size) {
      const std::unique_ptr<BagContainer> bag = MakeRos1Bag("x.bag", whole.substr(0, size));
      const Status status = ReadAll(bag.get(), &messages);
      ASSERT_TRUE(status.ok()) << size << ": " << status.message();
      // Between two records of the index all messages are there.
      if (messages != all) EXPECT_THAT(bag->Omission(), HasSubstr("its index is missing")) << size;
      ASSERT_THAT(messages, StartsWith(before)) << size;
      ASSERT_THAT(all, StartsWith(messages)) << size;
      before = messages;
    }
    EXPECT_EQ(before, all);
  }
}

TEST_F(Ros1BagTest, ACutInTheFirstRecordIsDataLoss) {
  const std::string whole = Ros1Bytes(SmallBag(kRos1));
  std::string messages;
  for (std::size_t size = 0; size < kRos1Start.size() + 4096; size += 7) {
    EXPECT_EQ(ReadContent(whole.substr(0, size), &messages).code(), StatusCode::kDataLoss);
  }
}

// The lengths of a chunk are zero until it is complete.
TEST_F(Ros1BagTest, PlainMessagesOfAnUnfinishedChunkAreRead) {
  const std::string start = kRos1Start + Ros1BagHeader(0, 0, 0);
  const std::string message = Ros1Message(0, kStart_ns, "content");
  const std::string records = kConnection + message + message;
  std::string whole, messages;
  ASSERT_TRUE(ReadContent(start + Ros1Chunk(records, "none", 0 + records.size()), &whole).ok());
  const auto open = [](const std::string& compression) {
    return Ros1Record({Ros1Op(5), "compression=" + compression, "size=" + Ros1Number(0u)}, "");
  };
  ASSERT_TRUE(ReadContent(start + open("none") + records, &messages).ok());
  EXPECT_EQ(messages, whole);
  ASSERT_TRUE(ReadContent(start + open("none") + records + message.substr(0, 30), &messages).ok());
  EXPECT_EQ(messages, whole);
  const auto bag = MakeRos1Bag("x.bag", start + open("bz2") + Bzip2Bytes(records).substr(0, 40));
  ASSERT_TRUE(ReadAll(bag.get(), &messages).ok());
  EXPECT_EQ(messages, "");
  EXPECT_THAT(bag->Omission(), HasSubstr("the last 40 of its "));
}

// As a file system may leave them after the power has failed.
TEST_F(Ros1BagTest, ZerosEndAnUnfinishedRecording) {
  const std::string whole = Ros1Bytes(SmallBag(kRos1), {"lz4", 3, false});
  std::string expected, messages;
  ASSERT_TRUE(ReadContent(whole, &expected).ok());
  const auto bag = MakeRos1Bag("x.bag", whole + std::string(500, '\0'));
  ASSERT_TRUE(ReadAll(bag.get(), &messages).ok());
  EXPECT_EQ(messages, expected);
  EXPECT_THAT(bag->Omission(), HasSubstr("and the last 500 of its "));
}

TEST_F(Ros1BagTest, EveryFlippedByteIsReadOrNamed) {
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    const std::string whole = Ros1Bytes(SmallBag(kRos1), {compression, 3, true});
    std::size_t num_found = 0;
    for (std::size_t i = 0; i<whole.size(); i += i> 100 && i < 4000 ? 97 : 1) {
      std::string flipped = whole, messages;
      flipped[i] = static_cast<char>(flipped[i] ^ (i % 3 == 0 ? 0x01 : i % 3 == 1 ? 0x80 : 0xff));
      const Status status = ReadContent(flipped, &messages);
      EXPECT_EQ(status.ok(), status.message().find("x.bag: ") == std::string::npos) << i;
      num_found += status.ok() ? 0 : 1;
    }
    EXPECT_GT(num_found, 100u);
  }
}

TEST_F(Ros1BagTest, OtherFormatsAreNamed) {
  std::string messages;
  const std::string rest = Ros1BagHeader(0, 0, 0);
  for (const std::string start : {"#ROSBGA V2.0\n", "#ROSBAG V2.00\n", "#ROSBAG V1.2\n", ""}) {
    const Status status = ReadContent(start + rest, &messages);
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(), HasSubstr("it does not begin with the line '#ROSBAG V2.0'"));
  }
  EXPECT_THAT(ReadContent(kRos1Start, &messages).message(), HasSubstr("at byte 13: it is cut off"));
  EXPECT_THAT(ReadContent(kRos1Start + kConnection, &messages).message(),
              HasSubstr("at byte 13: it is no header of a bag"));
}

TEST_F(Ros1BagTest, AnEncryptedBagIsNamed) {
  std::string messages;
  const auto encrypted = [](const std::string& by) {
    return kRos1Start +
           Ros1Record({Ros1Op(3), "index_pos=" + Ros1Number(std::uint64_t{0}), "encryptor=" + by},
                      "");
  };
  const Status status = ReadContent(encrypted("rosbag/AesCbcEncryptor"), &messages);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("encrypted by 'rosbag/AesCbcEncryptor'"));
  EXPECT_TRUE(ReadContent(encrypted("rosbag/NoEncryptor"), &messages).ok());
  EXPECT_TRUE(ReadContent(encrypted(""), &messages).ok());
}

TEST_F(Ros1BagTest, RecordsThatDoNotFitAreNamed) {
  constexpr char kTooLong[] = "it is longer than what is left of the file";
  constexpr char kNoFields[] = "its header has no fields, or no 'op' among them";
  const std::string good = kConnection;
  ExpectDamaged(good, Ros1Number(0xffffu) + "xyz", kTooLong);
  ExpectDamaged(good, "abc", kTooLong);
  ExpectDamaged(good, Ros1Text(Ros1Fields({Ros1Op(2)})) + Ros1Number(0xffffffu), kTooLong);
  ExpectDamaged(good, Ros1Text("") + Ros1Text(""), kNoFields);
  ExpectDamaged(good, Ros1Text(Ros1Text("abc")) + Ros1Text(""), kNoFields);
  ExpectDamaged(good, Ros1Text(Ros1Number(9u) + "a=b") + Ros1Text(""), kNoFields);
  ExpectDamaged(good, Ros1Text(std::string((1 << 20) + 1, 'x')), "its header is too long for one");
  ExpectDamaged(good, Ros1Record({Ros1Op(7), "topic=/a"}, ""), "a connection without field 'conn'");
  ExpectDamaged(good, Ros1Record({Ros1Op(7), "conn=" + Ros1Number(1u)}, "abcd"),
                "a connection whose data have no fields");
}

TEST_F(Ros1BagTest, ChunksHaveTheSizeAndTheRecordsThatTheySay) {
  const std::string records = kConnection + Ros1Message(0, kStart_ns, std::string(1000, 'a'));
  const auto size = static_cast<std::uint32_t>(records.size());
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    for (const std::uint32_t wrong : {size - 1, size + 1}) {
      ExpectDamaged("", Ros1Chunk(records, compression, wrong), "");
    }
    ExpectDamaged("", Ros1Chunk(records, compression, 0xffffffff),
                  "a chunk of 4294967295 bytes; 1 GiB is the limit");
    ExpectDamaged("", Ros1Chunk(records + "abc", compression, size + 3),
                  "in the chunk there, the record at byte " + std::to_string(size) +
                      ": it is longer than the chunk");
  }
  ExpectDamaged("", Ros1Chunk(records, "lz4", size - 1), "the compressed data expand to more than");
  ExpectDamaged("", Ros1Chunk(records, "zip", size), "its compression is neither none nor bz2");
  const std::string stranger = Ros1Message(7, kStart_ns, "");
  ExpectDamaged("", Ros1Chunk(stranger, "none", static_cast<std::uint32_t>(stranger.size())),
                "in the chunk there, the record at byte 0: a message of connection 7, which has");
  const std::string timeless = Ros1Record({Ros1Op(2), "conn=" + Ros1Number(0u)}, "");
  ExpectDamaged("", Ros1Chunk(timeless, "none", static_cast<std::uint32_t>(timeless.size())),
                "in the chunk there, the record at byte 0: a message without field 'time'");
}

TEST_F(Ros1BagTest, AFileThatIsNotThereIsNamed) {
  std::string messages;
  EXPECT_EQ(ReadAll(MakeRos1Bag(path_, std::nullopt).get(), &messages).code(),
            StatusCode::kNotFound);
}

TEST_F(Ros1BagTest, ABagThatIsCompressedAsAWholeIsRead) {
  WriteFile(path_, ZstdBytes(Ros1Bytes(SmallBag(kRos1))));
  EXPECT_EQ(Read().scans.size(), 2u);
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
  std::int64_t StampNs(int scan) const {
    return kStart_ns + std::llround(1e9 * log_.scans[scan].scan.timestamp_s);
  }
  double Stamp(int scan) const {
    const std::int64_t stamp_ns = StampNs(scan), seconds = stamp_ns / 1000000000;
    return static_cast<double>(seconds) + 1e-9 * static_cast<double>(stamp_ns % 1000000000);
  }

  void WriteDrive(bool as_transforms, const Ros1Layout& layout) {
    LaserModel laser = log_.laser;
    laser.first_bearing_rad = -laser.first_bearing_rad;
    laser.bearing_step_rad = -laser.bearing_step_rad;
    Ros1Writer writer(layout);
    writer.Write(
        {"/tf_static", "tf2_msgs/TFMessage", "", kStart_ns,
         TransformBytes(kRos1, 0, "base_link", "laser", log_.laser.robot_from_laser, true)});
    for (int i = 0; i < kNumScans; ++i) {
      const Pose2& pose = log_.scans[i].odom_from_robot;
      const std::int64_t stamp_ns = StampNs(i);
      if (as_transforms) {
        writer.Write({"/tf", "tf/tfMessage", "", stamp_ns,
                      TransformBytes(kRos1, stamp_ns, "odom", "base_link", pose)});
      } else {
        writer.Write(
            {"/odom", "nav_msgs/Odometry", "", stamp_ns, OdometryBytes(kRos1, stamp_ns, pose)});
      }
      writer.Write({"/scan", "sensor_msgs/LaserScan", "", stamp_ns,
                    ScanBytes(kRos1, stamp_ns, log_.scans[i].scan.ranges, laser)});
    }
    WriteFile(path_, writer.Finish());
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
      EXPECT_EQ(graph.timestamp_s(i), Stamp(i));
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
    WriteDrive(as_transforms, {"bz2", 50, true});
    ExpectDrive();
  }
}

TEST_F(Ros1DriveTest, TheProgramsMapAndMeasureABag) {
  SimulateDrive();
  WriteDrive(true, {"lz4", 50, true});
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

TEST_F(Ros1DriveTest, AnInterruptedRecordingGivesTheSameMapAndAWarning) {
  SimulateDrive();
  WriteDrive(false, {"none", 50, true});
  ASSERT_EQ(Slam("a.bag", "--picture_side_px=200").exit_code, 0);
  const std::string expected = Result("out", "trajectory.tum");
  WriteDrive(false, {"lz4", 50, false});
  const Outcome run = Slam("a.bag", "--picture_side_px=200", "again");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Result("again", "trajectory.tum"), expected);
  EXPECT_EQ(run.err, "warning: " + path_ +
                         ": the recording was not closed or is cut off, its index is missing "
                         "[interrupted_recording]\n");
}

}  // namespace
}  // namespace plumbline
