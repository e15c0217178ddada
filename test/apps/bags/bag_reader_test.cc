#include "plumbline/apps/bags/bag_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "plumbline/test/apps/bags/bag_file_testing.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/mcap_writer.h"
#include "plumbline/test/apps/bags/scan_message_testing.h"
#include "plumbline/test/apps/bags/sqlite_writer.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Ways to write a bag.
struct Container {
  const char* name;
  std::function<void(const std::string& path, const TestBag& bag)> write;
};

Container Mcap(const char* name, const McapLayout& layout) {
  return {name, [layout](const std::string& path, const TestBag& bag) {
            WriteFile(path, McapBytes(bag, layout));
          }};
}

void ExpectSmallBag(const RosRecording& recording) {
  EXPECT_EQ(recording.scan_topic, "/scan");
  EXPECT_EQ(recording.odom_topic, "/odom");
  EXPECT_EQ(recording.odom_frame, "odom");
  EXPECT_EQ(recording.robot_frame, "base_link");
  ASSERT_EQ(recording.scans.size(), 2u);
  const RosScan& scan = recording.scans[1];
  EXPECT_EQ(scan.stamp_s, 1500000000.25);
  EXPECT_EQ(scan.frame, "laser");
  EXPECT_EQ(scan.angle_min_rad, -0.5);
  EXPECT_EQ(scan.angle_increment_rad, 0.5);
  EXPECT_EQ(scan.range_min_m, 0.125);
  EXPECT_EQ(scan.range_max_m, 30.0);
  ASSERT_EQ(scan.ranges.size(), 3u);
  EXPECT_EQ(scan.ranges[0], 1.25);
  EXPECT_TRUE(std::isnan(scan.ranges[1]));
  EXPECT_EQ(scan.ranges[2], 3.5);
  ASSERT_EQ(recording.odometry.size(), 2u);
  EXPECT_EQ(recording.odometry[1].timestamp_s, 1500000000.25);
  EXPECT_NEAR(recording.odometry[1].world_from_robot.x, 0.1, 1e-12);
  EXPECT_NEAR(recording.odometry[1].world_from_robot.yaw, 0.2, 1e-12);
  std::optional<TransformPath> path;
  ASSERT_TRUE(recording.transforms.FindPath("base_link", "laser", &path).ok());
  ASSERT_TRUE(path);
  const Eigen::Isometry3d mounting = recording.transforms.At(*path, 1500000000.0);
  EXPECT_NEAR(InPlane(mounting).y, 0.2, 1e-12);
  EXPECT_NEAR(InPlane(mounting).yaw, 0.3, 1e-12);
}

class BagReaderTest : public BagFile, public testing::TestWithParam<Container> {
 protected:
  BagReaderTest() : BagFile(TempFolder() + "a bag") {}
  void Write(const TestBag& bag) const { GetParam().write(path_, bag); }
};

TEST_P(BagReaderTest, ReadsWhatTheMessagesSay) {
  for (const TestEncoding encoding :
       {TestEncoding::kCdr, TestEncoding::kBigEndianCdr, TestEncoding::kRos1}) {
    Write(SmallBag(encoding));
    ExpectSmallBag(Read());
  }
}

TEST_P(BagReaderTest, ReadsMessagesThatAreCompressedOneByOne) {
  TestBag bag = SmallBag();
  for (TestMessage& message : bag) message.bytes = ZstdBytes(message.bytes);
  Write(bag);
  ExpectSmallBag(Read());

  bag.back().bytes.pop_back();
  Write(bag);
  const std::vector<RosScan> scans = Read().scans;
  ASSERT_EQ(scans.size(), 2u);
  EXPECT_EQ(scans[0].fault, "");
  EXPECT_THAT(scans[1].fault, HasSubstr("the compressed data are cut off"));
}

TEST_P(BagReaderTest, OneOfTwoScanTopicsHasToBeChosen) {
  TestBag bag = SmallBag(TestEncoding::kCdr, "/front/scan");
  const TestBag rear = SmallBag(TestEncoding::kCdr, "/rear/scan");
  bag.insert(bag.end(), rear.begin(), rear.end());
  Write(bag);
  EXPECT_THAT(Fails().message(),
              AllOf(HasSubstr("there are several topics of type sensor_msgs/LaserScan: choose one "
                              "by --scan_topic"),
                    HasSubstr("/front/scan (sensor_msgs/msg/LaserScan), "),
                    HasSubstr("/rear/scan (sensor_msgs/msg/LaserScan)")));
  BagReadOptions options;
  options.scan_topic = "rear/scan";
  EXPECT_EQ(Read(options).scan_topic, "/rear/scan");
  options.scan_topic = "/scan";
  EXPECT_THAT(Fails(options).message(), HasSubstr("there is no topic '/scan'"));
  options.scan_topic = "/odom";
  EXPECT_THAT(Fails(options).message(), HasSubstr("/odom is not of type sensor_msgs/LaserScan"));
  options.scan_topic = "/rear/scan";
  options.odom_topic = "/image";
  EXPECT_THAT(Fails(options).message(), HasSubstr("/image is neither of type nav_msgs/Odometry"));
}

TEST_P(BagReaderTest, TheTransformsTellTheOdometryIfAsked) {
  Write(SmallBag());
  BagReadOptions options;
  options.odom_topic = "/tf_static";
  options.odom_frame = "/wheels";
  const RosRecording recording = Read(options);
  EXPECT_EQ(recording.odom_topic, "");
  EXPECT_EQ(recording.odom_frame, "wheels");
  EXPECT_THAT(recording.odometry, IsEmpty());
}

TEST_P(BagReaderTest, OtherEncodingsAreRefusedByName) {
  TestBag bag = SmallBag();
  for (TestMessage& message : bag) {
    if (message.topic == "/scan") message.encoding = "json";
  }
  Write(bag);
  EXPECT_THAT(Fails().message(),
              AllOf(HasSubstr("/scan has messages in the encoding 'json'; only cdr and ros1"),
                    HasSubstr("/scan (sensor_msgs/msg/LaserScan, encoding 'json')")));
  for (TestMessage& message : bag) {
    message.type = "foxglove.LaserScan";
    message.encoding = "protobuf";
  }
  Write(bag);
  EXPECT_THAT(Fails().message(),
              AllOf(HasSubstr("there is no topic of type sensor_msgs/LaserScan"),
                    HasSubstr("/scan (foxglove.LaserScan, encoding 'protobuf')")));
}

TEST_P(BagReaderTest, ABagWithoutMessagesHasNoTopics) {
  Write({});
  EXPECT_THAT(Fails().message(), HasSubstr("; the bag has no topics"));
}

TEST_P(BagReaderTest, MessagesThatAreNoneOfTheirTypeAreKeptAsFaults) {
  TestBag bag = SmallBag();
  for (const std::size_t message : {0, 1, 3}) {
    bag.push_back(bag[message]);
    bag.back().bytes.resize(40);
  }
  Write(bag);
  const RosRecording recording = Read();
  ASSERT_EQ(recording.scans.size(), 3u);
  EXPECT_EQ(recording.scans[1].fault, "");
  EXPECT_THAT(recording.scans[2].fault, HasSubstr("field '"));
  EXPECT_NEAR(recording.scans[2].received_s, 1500000000.000001, 1e-6);
  EXPECT_EQ(recording.odometry.size(), 2u);
  EXPECT_THAT(recording.bad_odometry.examples(),
              ElementsAre(HasSubstr("/odom message 2 (1500000000.000000 s): field '")));
  EXPECT_EQ(recording.num_transform_messages, 2u);
  EXPECT_THAT(recording.bad_transforms.examples(),
              ElementsAre(HasSubstr("/tf_static message 1 (1500000000.000000 s): field '")));
}

TEST_P(BagReaderTest, TopicsWithoutMessagesAreNoChoice) {
  if (std::string(GetParam().name) != "Sqlite") return;  // the only writer of empty topics
  TestBag bag = SmallBag();
  std::vector<std::string> statements = BagStatements(bag);
  for (const char* topic :
       {"7, '/scan2', 'sensor_msgs/msg/LaserScan'", "8, '/odom2', 'nav_msgs/msg/Odometry'"}) {
    statements.insert(statements.end() - 1,
                      std::string("INSERT INTO topics VALUES(") + topic + ", 'cdr', '')");
  }
  WriteDatabase(path_, statements);
  ExpectSmallBag(Read());
}

TEST_P(BagReaderTest, ScansOfAnotherTypeTakeThePlaceOfATopicWithoutMessages) {
  if (std::string(GetParam().name) != "Sqlite") return;  // the only writer of empty topics
  TestBag bag = SmallBag();
  LaserModel laser;
  laser.num_beams = 3;
  for (TestMessage& message : bag) {
    if (message.topic != "/scan") continue;
    message.topic = "/echoes";
    message.type = "sensor_msgs/msg/MultiEchoLaserScan";
    message.bytes = MultiEchoBytes(TestEncoding::kCdr, kStart_ns, {{1.0}, {2.0}, {}},
                                   {{9.0}, {9.0}, {}}, laser);
  }
  std::vector<std::string> statements = BagStatements(bag);
  for (const char* topic : {"7, '/scan', 'sensor_msgs/msg/LaserScan'",
                            "8, '/echoes2', 'sensor_msgs/msg/"
                            "MultiEchoLaserScan'",
                            "9, '/points', 'sensor_msgs/msg/PointCloud2'"}) {
    statements.insert(statements.end() - 1,
                      std::string("INSERT INTO topics VALUES(") + topic + ", 'cdr', '')");
  }
  WriteDatabase(path_, statements);
  const RosRecording recording = Read();
  EXPECT_EQ(recording.scan_topic, "/echoes");
  EXPECT_EQ(recording.scans.size(), 2u);
  // A topic that the user names is taken as it is.
  BagReadOptions options;
  options.scan_topic = "/points";
  EXPECT_EQ(Read(options).scan_topic, "/points");
}

TEST_P(BagReaderTest, CloudsThatAreNoneAreKeptAsFaults) {
  TestBag bag = SmallBag();
  for (TestMessage& message : bag) {
    if (message.topic != "/scan") continue;
    message.type = "sensor_msgs/msg/PointCloud2";
    message.bytes =
        CloudBytes(TestEncoding::kCdr, kStart_ns, "laser", {{1.0, 2.0, 0.5}}, PlanarLayout());
  }
  bag.push_back(bag.back());
  bag.back().bytes.resize(60);
  Write(bag);
  const std::vector<RosScan> scans = Read().scans;
  ASSERT_EQ(scans.size(), 3u);
  EXPECT_EQ(scans[1].fault, "");
  EXPECT_EQ(scans[1].bearings_rad.size(), 1u);
  EXPECT_THAT(scans[2].fault, HasSubstr("field '"));
}

TEST_P(BagReaderTest, OdometryWithoutMessagesLeavesItToTheTransforms) {
  if (std::string(GetParam().name) != "Sqlite") return;  // the only writer of empty topics
  std::vector<std::string> statements = BagStatements(SmallBag());
  statements.insert(statements.end() - 1, "DELETE FROM messages WHERE topic_id = 2");
  WriteDatabase(path_, statements);
  const RosRecording recording = Read();
  EXPECT_EQ(recording.odom_topic, "");
  EXPECT_THAT(recording.odometry, IsEmpty());
}

TEST_P(BagReaderTest, APoseThatIsNoneIsKeptAsAFault) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  TestBag bag = SmallBag();
  bag.push_back(bag[1]);
  bag.back().bytes = OdometryBytes(TestEncoding::kCdr, kStart_ns, {kNan, 0.0, 0.0});
  Write(bag);
  RosRecording recording = Read();
  EXPECT_EQ(recording.odometry.size(), 2u);
  EXPECT_THAT(
      recording.bad_odometry.examples(),
      ElementsAre("/odom message 2 (1500000000.000000 s): field 'pose.pose' is not finite"));
  bag = SmallBag();
  std::string& transform = bag[0].bytes;
  transform.replace(transform.size() - 8, 8, 8, '\0');  // the w of the rotation
  Write(bag);
  std::optional<TransformPath> path;
  EXPECT_THAT(Read().transforms.FindPath("base_link", "laser", &path).message(),
              HasSubstr("/tf_static message 0 (1500000000.000000 s): the transform from "
                        "'base_link' to 'laser' has a quaternion that is no rotation"));
}

TEST_P(BagReaderTest, TakesNoMoreMemoryThanAllowed) {
  BagReadOptions options;
  options.max_bytes = 1e5;
  for (const std::size_t message : {0, 1, 3}) {  // a transform, a pose, a scan
    TestBag bag = SmallBag();
    for (int i = 0; i < 20; ++i) bag.push_back(bag[message]);
    Write(bag);
    Read(options);
    for (int i = 0; i < 2000; ++i) bag.push_back(bag[message]);
    Write(bag);
    EXPECT_THAT(Fails(options).message(),
                AllOf(HasSubstr(": " + bag[message].topic + " message "),
                      HasSubstr(" s): what was read so far takes more memory than the 0 MB")));
    Read();
  }
  options.max_bytes = -1.0;
  EXPECT_THAT(ReadBag(path_, options, nullptr).message(), HasSubstr("max_bytes = -1"));
}

TEST_P(BagReaderTest, NamesInMessagesCannotSpeakToATerminal) {
  TestBag bag = SmallBag(TestEncoding::kCdr, "/\x1b[2J");
  bag.push_back(bag[1]);
  bag.back().topic = "/\x1b[1J";
  Write(bag);
  EXPECT_THAT(Fails().message(),
              AllOf(HasSubstr("/\\x1b[2J (sensor_msgs"), testing::Not(HasSubstr("\x1b"))));
}

INSTANTIATE_TEST_SUITE_P(
    Containers, BagReaderTest,
    testing::Values(Container{"Sqlite", WriteSqliteBag}, Mcap("Mcap", {0, "", true, true}),
                    Mcap("McapBare", {0, "", false, false}), Mcap("Chunks", {3, "", true, true}),
                    Mcap("Lz4Chunks", {2, "lz4", true, true}),
                    Mcap("ZstdChunks", {1, "zstd", true, true}),
                    Mcap("OneChunk", {1000, "zstd", false, false})),
    [](const testing::TestParamInfo<Container>& info) { return info.param.name; });

// By make_mcap_fixture.mjs, with npm's @mcap/core.
TEST(McapFixtureTest, AFileOfAnotherWriterIsRead) {
  RosRecording recording;
  const Status status =
      ReadBag(PLUMBLINE_CORPUS "/bag/by_mcap_core.mcap", BagReadOptions(), &recording);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(recording.scans.size(), 8u);
  ASSERT_EQ(recording.odometry.size(), 8u);
  for (int i = 0; i < 8; ++i) {
    const RosScan& scan = recording.scans[i];
    EXPECT_NEAR(scan.stamp_s, 1700000000.0 + 0.2 * i, 1e-6);
    EXPECT_EQ(scan.frame, "laser");
    EXPECT_EQ(scan.range_min_m, 0.125);
    ASSERT_EQ(scan.ranges.size(), 120u);
    EXPECT_NEAR(scan.ranges[60], 3.75 - 0.125 * i, 1e-6);  // ahead
    EXPECT_NEAR(scan.ranges[90], 2.0, 1e-6);               // to the left
    EXPECT_EQ(recording.odometry[i].world_from_robot.x, 0.125 * i);
  }
  std::optional<TransformPath> path;
  ASSERT_TRUE(recording.transforms.FindPath("base_link", "laser", &path).ok());
  ASSERT_TRUE(path);
  const Eigen::Isometry3d mounting = recording.transforms.At(*path, 0.0);
  EXPECT_EQ(mounting.translation(), Eigen::Vector3d(0.25, 0.0, 0.5));
}

TEST(BagReadOptionsTest, TheFrameOfTheOdometryNeedsAName) {
  BagReadOptions options;
  EXPECT_TRUE(options.Check(nullptr));
  options.odom_frame.clear();
  std::string error;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_EQ(error, "odom_frame is empty");
}

}  // namespace
}  // namespace plumbline
