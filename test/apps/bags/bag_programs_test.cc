// Bags of ROS 2 in the programs, from end to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "plumbline/apps/simulation/building_reader.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/mcap_writer.h"
#include "plumbline/test/apps/bags/sqlite_writer.h"
#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class BagProgramsTest : public ProgramTest {
 protected:
  static constexpr int kNumScans = 120;

  // A drive through the small building, with a laser that sits ahead of the robot's centre.
  static TestBag SimulateDrive() {
    Building building;
    EXPECT_TRUE(ReadBuilding(PLUMBLINE_WORLD, &building).ok());
    SimulationOptions options;
    options.laser.robot_from_laser = {0.1, 0.0, 0.2};
    options.laser.max_range_m = 20.0;
    SimulatedLog log;
    EXPECT_TRUE(Simulate(World(building), options, &log).ok());
    constexpr TestEncoding kEncoding = TestEncoding::kCdr;
    TestBag bag;
    bag.push_back(
        {"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", kStart_ns,
         TransformBytes(kEncoding, 0, "base_link", "laser", options.laser.robot_from_laser)});
    for (int i = 0; i < kNumScans; ++i) {
      const SimulatedScan& scan = log.scans[i];
      const std::int64_t stamp_ns = kStart_ns + std::llround(1e9 * scan.scan.timestamp_s);
      bag.push_back({"/odom", "nav_msgs/msg/Odometry", "cdr", stamp_ns,
                     OdometryBytes(kEncoding, stamp_ns, scan.odom_from_robot)});
      bag.push_back({"/scan", "sensor_msgs/msg/LaserScan", "cdr", stamp_ns,
                     ScanBytes(kEncoding, stamp_ns, scan.scan.ranges, log.laser)});
    }
    return bag;
  }

  // The trajectory of a run over a bag.
  std::string Map(const std::string& bag, const std::string& flags = "") const {
    const Outcome run = Slam(bag, flags);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return Result("out", "trajectory.tum");
  }

  // A folder "bag" of two files.
  void WriteFolder(const TestBag& bag) const {
    std::filesystem::create_directories(folder_ + "bag");
    const auto middle = bag.begin() + static_cast<std::ptrdiff_t>(bag.size() / 2);
    WriteSqliteBag(folder_ + "bag/bag_0.db3", TestBag(bag.begin(), middle));
    WriteSqliteBag(folder_ + "bag/bag_1.db3", TestBag(middle, bag.end()));
    WriteFile(folder_ + "bag/metadata.yaml",
              "rosbag2_bagfile_information:\n  version: 5\n"
              "  relative_file_paths:\n    - bag_0.db3\n    - bag_1.db3\n");
  }
};

TEST_F(BagProgramsTest, ADriveGivesTheSameTrajectoryFromEveryContainer) {
  const TestBag bag = SimulateDrive();
  WriteSqliteBag(folder_ + "a.db3", bag);
  WriteFile(folder_ + "plain.mcap", McapBytes(bag, {0, "", false, false}));
  WriteFile(folder_ + "chunks.mcap", McapBytes(bag, {50, "zstd", true, true}));
  WriteFolder(bag);
  const std::string expected = Map("a.db3");
  EXPECT_EQ(Lines(expected).size(), static_cast<std::size_t>(kNumScans));
  for (const char* other : {"plain.mcap", "chunks.mcap", "bag", "bag/metadata.yaml"}) {
    EXPECT_EQ(Map(other), expected) << other;
  }
}

TEST_F(BagProgramsTest, ABagWithoutOdometryIsMappedByItsScans) {
  TestBag bag = SimulateDrive();
  bag.erase(std::remove_if(bag.begin(), bag.end(),
                           [](const TestMessage& message) { return message.topic == "/odom"; }),
            bag.end());
  WriteSqliteBag(folder_ + "a.db3", bag);
  const Outcome run = Slam("a.db3", "--picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(std::to_string(kNumScans) + " scans, "));
  EXPECT_THAT(run.out, HasSubstr("The refined map is consistent"));
  EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
  EXPECT_THAT(run.err, HasSubstr("warning: " + folder_ + "a.db3: there is no odometry"));
  EXPECT_TRUE(Summary()["seeding"]["odometry_noise"]["is_prediction"]);
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out/map_odometry.png"));
}

TEST_F(BagProgramsTest, OdometryThatWasAskedForIsNotGoneWithout) {
  TestBag bag = SimulateDrive();
  bag.erase(std::remove_if(bag.begin(), bag.end(),
                           [](const TestMessage& message) { return message.topic == "/odom"; }),
            bag.end());
  WriteSqliteBag(folder_ + "a.db3", bag);
  ExpectError(Slam("a.db3", "--odom_topic=/odom"), "there is no topic '/odom'");
  ExpectError(Slam("a.db3", "--odom_topic=/tf_static"), "there is no odometry");
  ExpectError(Slam("a.db3", "--odom_frame=odom"), "no frame 'odom' above the laser's");
}

TEST_F(BagProgramsTest, ConvertReadsAFolderAndOverwritesNoneOfItsFiles) {
  WriteFolder(SimulateDrive());
  const std::string in = "--input=" + folder_ + "bag --output=" + folder_;
  const Outcome run = Run("convert", in + "a.tum");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Lines(ReadFile(folder_ + "a.tum")).size(), static_cast<std::size_t>(kNumScans));
  ExpectError(Run("convert", in + "bag/bag_1.db3 --format=tum"), "must be neither an input",
              kExitWrongUsage);
}

TEST_F(BagProgramsTest, ReadingStaysWithinTheMemoryAllowed) {
  TestBag bag = SimulateDrive();
  const TestBag drive = bag;
  while (bag.size() < 10 * drive.size()) bag.insert(bag.end(), drive.begin(), drive.end());
  WriteSqliteBag(folder_ + "a.db3", bag);
  ExpectError(Slam("a.db3", "--max_memory=1MB"),
              " s): what was read so far takes more memory than the 1 MB allowed");
}

// 1.25 GiB of zeros in 100 kB.
TEST_F(BagProgramsTest, WhatExpandsToTooMuchIsRefused) {
  const std::string frame = ZstdBytes(std::string(std::size_t{1} << 24, '\0'));
  std::string frames;
  for (int i = 0; i < 80; ++i) frames += frame;
  WriteFile(folder_ + "a.db3.zstd", frames);
  ExpectError(Slam("a.db3.zstd"), "expand to more than 1073741824 bytes (zstd -d");
  ExpectError(Slam("a.db3.zstd", "--max_memory=20MB"), "expand to more than 20000000 bytes");
}

// A TurtleBot 4 along a floor.
class TurtleBotTest : public ProgramTest {
 protected:
  static std::string Path() {
    const std::string path = DatasetsFolder() + "/ecosystem/turtlebot4_floor.db3";
    return !DatasetsFolder().empty() && std::filesystem::exists(path) ? path : "";
  }

  // All rows of its tables.
  static TestBag ReadRows(const std::string& path) {
    TestBag bag;
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open_v2(("file://" + path + "?immutable=1").c_str(), &database,
                              SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr),
              SQLITE_OK);
    sqlite3_stmt* rows = nullptr;
    EXPECT_EQ(
        sqlite3_prepare_v2(database,
                           "SELECT name, type, serialization_format, timestamp, data FROM "
                           "messages JOIN topics ON topics.id = topic_id ORDER BY messages.id",
                           -1, &rows, nullptr),
        SQLITE_OK);
    const auto text = [&rows](int column) {
      return std::string(static_cast<const char*>(sqlite3_column_blob(rows, column)),
                         sqlite3_column_bytes(rows, column));
    };
    while (sqlite3_step(rows) == SQLITE_ROW) {
      bag.push_back({text(0), text(1), text(2), sqlite3_column_int64(rows, 3), text(4)});
    }
    sqlite3_finalize(rows);
    sqlite3_close(database);
    return bag;
  }
};

TEST_F(TurtleBotTest, ItsBagBecomesAConsistentMapWithThinWalls) {
  if (Path().empty()) GTEST_SKIP() << "PLUMBLINE_DATASETS has no ecosystem/turtlebot4_floor.db3";
  const Outcome run =
      Run("slam", "--log=" + Path() + " --output_dir=" + folder_ + "out --picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("354 scans, "));
  EXPECT_THAT(run.out, HasSubstr("The refined map is consistent"));
  EXPECT_THAT(run.err, testing::Not(HasSubstr("warning")));
  const nlohmann::json stages = Summary()["stages"];
  EXPECT_GT(stages.front()["wall_thickness_m"], 0.035);
  EXPECT_LT(stages.back()["wall_thickness_m"], 0.017);

  const std::string expected = Result("out", "trajectory.tum");
  const TestBag bag = ReadRows(Path());
  ASSERT_GT(bag.size(), 2000u);
  WriteFile(folder_ + "a.mcap", McapBytes(bag, {100, "lz4", true, true}));
  ASSERT_EQ(Slam("a.mcap", "--picture_side_px=200").exit_code, 0);
  EXPECT_EQ(Result("out", "trajectory.tum"), expected);
}

}  // namespace
}  // namespace plumbline
