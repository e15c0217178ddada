#include "plumbline/apps/saved_maps/slam_toolbox_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "plumbline/apps/saved_maps/karto_classes.h"
#include "plumbline/test/apps/saved_maps/posegraph_writer.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class SlamToolboxGraphTest : public testing::Test {
 protected:
  Status Build() {
    WriteKartoMap(stem_, map_);
    SlamToolboxMap map;
    PLUMBLINE_RETURN_IF_ERROR(ReadSlamToolboxMap(stem_ + ".posegraph", 0.0, &map));
    return BuildGraph(map, &graph_, &num_restarts_);
  }
  void ExpectRefused(const std::string& file, const std::string& problem) {
    const Status status = Build();
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), AllOf(StartsWith(stem_ + file + ": "), HasSubstr(problem)));
  }
  void ExpectPose(const Pose2& pose, const Pose2& expected) {
    EXPECT_NEAR(pose.x, expected.x, 1e-12);
    EXPECT_NEAR(pose.y, expected.y, 1e-12);
    EXPECT_NEAR(pose.yaw, expected.yaw, 1e-12);
  }

  const std::string stem_ = TempFolder() + "map";
  KartoMap map_ = SmallKartoMap();
  SlamGraph graph_;
  int num_restarts_ = -1;
};

TEST_F(SlamToolboxGraphTest, HasTheScansAtTheirCorrectedPosesAndTimes) {
  ASSERT_TRUE(Build().ok());
  ASSERT_EQ(graph_.num_poses(), 3);
  ASSERT_EQ(graph_.num_scans(), 3);
  for (int i = 0; i < 3; ++i) {
    ExpectPose(graph_.InitialPose(i), map_.scans[i].corrected);
    EXPECT_EQ(graph_.timestamp_s(i), map_.scans[i].time_s);
    // The third reading is beyond the threshold.
    ASSERT_EQ(graph_.scan(i).num_returns, 3u);
    const std::size_t first = graph_.scan(i).first_return;
    EXPECT_EQ(graph_.returns().range_m[first], 1.0 + i);
    EXPECT_EQ(graph_.returns().range_m[first + 2], 4.0);
    EXPECT_EQ(graph_.Beam(first + 2), 3);
  }
}

TEST_F(SlamToolboxGraphTest, HasTheLaser) {
  ASSERT_TRUE(Build().ok());
  ASSERT_EQ(graph_.num_lasers(), 1);
  const LaserModel& laser = graph_.laser(0);
  EXPECT_EQ(laser.num_beams, 4);
  EXPECT_EQ(laser.first_bearing_rad, -1.5);
  EXPECT_EQ(laser.bearing_step_rad, 1.0);
  EXPECT_EQ(laser.min_range_m, 0.1);
  EXPECT_EQ(laser.max_range_m, 20.0);
  ExpectPose(laser.robot_from_laser, {0.1, -0.2, 0.3});
}

TEST_F(SlamToolboxGraphTest, HasTheStepsOfTheOdometry) {
  ASSERT_TRUE(Build().ok());
  ASSERT_EQ(graph_.odometry().size(), 2u);
  EXPECT_EQ(num_restarts_, 0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(graph_.odometry()[i].from, i);
    EXPECT_EQ(graph_.odometry()[i].to, i + 1);
    ExpectPose(graph_.odometry()[i].from_from_to,
               Between(map_.scans[i].odometric, map_.scans[i + 1].odometric));
  }
}

TEST_F(SlamToolboxGraphTest, HasTheEdges) {
  map_.edges[1].covariance = {4e-2, 1e-3, 2e-3, 1e-3, 5e-2, 3e-3, 2e-3, 3e-3, 6e-2};
  ASSERT_TRUE(Build().ok());
  ASSERT_EQ(graph_.relative_poses().size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const RelativePoseConstraint& edge = graph_.relative_poses()[i];
    EXPECT_EQ(edge.from, map_.edges[i].from);
    EXPECT_EQ(edge.to, map_.edges[i].to);
    ExpectPose(edge.from_from_to, map_.edges[i].difference);
    for (int j = 0; j < 9; ++j) {
      EXPECT_EQ(edge.covariance(j / 3, j % 3), map_.edges[i].covariance[j]);
    }
  }
}

TEST_F(SlamToolboxGraphTest, IdsGiveTheOrder) {
  std::swap(map_.scans[0].id, map_.scans[2].id);
  ASSERT_TRUE(Build().ok());
  ExpectPose(graph_.InitialPose(0), map_.scans[2].corrected);
  EXPECT_EQ(graph_.relative_poses()[0].from, 2);
}

TEST_F(SlamToolboxGraphTest, OdometryThatStartsAnewIsNoStep) {
  map_.scans[2].odometric = {-40.0, 2.0, 0.0};
  ASSERT_TRUE(Build().ok());
  EXPECT_EQ(num_restarts_, 1);
  ASSERT_EQ(graph_.odometry().size(), 1u);
  EXPECT_EQ(graph_.odometry()[0].to, 1);
}

TEST_F(SlamToolboxGraphTest, EachLaserHasAMountingAndOdometryOfItsOwn) {
  map_.lasers.push_back(map_.lasers[0]);
  map_.lasers[1].name = "rear";
  map_.lasers[1].offset = {-0.3, 0.0, 3.0};
  map_.scans[1].laser = "rear";
  ASSERT_TRUE(Build().ok());
  ExpectPose(graph_.LaserOfScan(0).robot_from_laser, {0.1, -0.2, 0.3});
  ExpectPose(graph_.LaserOfScan(1).robot_from_laser, {-0.3, 0.0, 3.0});
  ASSERT_EQ(graph_.odometry().size(), 1u);
  EXPECT_EQ(graph_.odometry()[0].from, 0);
  EXPECT_EQ(graph_.odometry()[0].to, 2);
}

TEST_F(SlamToolboxGraphTest, FilesThatDoNotBelongTogetherAreRefused) {
  map_.scans[1].laser = "rear";
  map_.lasers.push_back(map_.lasers[0]);
  map_.lasers[1].name = "rear";
  WriteKartoMap(stem_, map_);
  WriteFile(stem_ + ".data", DataBytes(SmallKartoMap()));
  SlamToolboxMap map;
  ASSERT_TRUE(ReadSlamToolboxMap(stem_ + ".posegraph", 0.0, &map).ok());
  EXPECT_EQ(BuildGraph(map, &graph_, &num_restarts_).message(),
            stem_ + ".posegraph: scan 1: its laser 'rear' is not in '" + stem_ +
                ".data'; do the files belong together?");
}

TEST_F(SlamToolboxGraphTest, RefusesWhatMakesNoGraph) {
  const KartoMap good = map_;
  map_.scans[1].ranges.pop_back();
  ExpectRefused(".posegraph", "scan 1: 3 readings for a laser of 4 beams");
  map_ = good;
  map_.scans[2].id = 1;
  ExpectRefused(".posegraph", "scan 1: there are two of this id");
  map_ = good;
  map_.edges = {good.edges[0]};
  ExpectRefused(".posegraph", "no edges connect scan 2 with the first scan, 0");
  map_ = good;
  map_.edges[2].covariance[0] = -1.0;
  ExpectRefused(".posegraph", "edge 0 -> 2: relative pose 2 (0 -> 2): covariance is not symmetric");
  map_ = good;
  map_.edges[2].difference.yaw = std::nan("");
  ExpectRefused(".posegraph", "edge 0 -> 2: ");
  map_ = good;
  map_.scans[0].corrected.x = std::numeric_limits<double>::infinity();
  ExpectRefused(".posegraph", "scan 0: pose 0: coordinates or time are not finite");
  map_ = good;
  map_.scans[0].odometric.y = 1e30;
  ExpectRefused(".posegraph", "scan 0: its odometric pose is not finite, or beyond all limits");
  map_ = good;
  map_.lasers[0].step_rad = 0.0;
  ExpectRefused(".data", "laser 'laser': ");
  map_ = good;
  map_.scans.clear();
  map_.edges.clear();
  ExpectRefused(".posegraph", "the map has no scans");
}

// Whatever the bytes have become, they make a graph or an error.
TEST_F(SlamToolboxGraphTest, FlippedBytesMakeAGraphOrAnError) {
  const std::string posegraph = PosegraphBytes(map_), data = DataBytes(map_);
  std::size_t num_read = 0;
  for (std::size_t i = 0; i < posegraph.size() + data.size(); ++i) {
    std::string flipped = posegraph + data;
    flipped[i] = static_cast<char>(flipped[i] ^ (i % 2 == 0 ? 0xff : 0x40));
    SlamToolboxMap map;
    map.path = "a.posegraph";
    if (!map.mapper.Read(flipped.substr(0, posegraph.size()), KartoClasses(), "karto::Mapper")
             .ok() ||
        !map.dataset.Read(flipped.substr(posegraph.size()), KartoClasses(), "karto::Dataset")
             .ok()) {
      continue;
    }
    const Status status = BuildGraph(map, &graph_, &num_restarts_);
    EXPECT_EQ(status.ok(), status.message().empty()) << i;
    if (!status.ok()) continue;
    EXPECT_EQ(graph_.num_scans(), 3) << i;
    ++num_read;
  }
  EXPECT_GT(num_read, 0u);
}

TEST(SlamToolboxMapTest, FilesAreNamedWhereOneIsMissingOrAnotherOne) {
  const std::string folder = TempFolder();
  WriteKartoMap(folder + "a", SmallKartoMap());
  SlamToolboxMap map;
  EXPECT_TRUE(IsSlamToolboxMap(folder + "a.posegraph"));
  EXPECT_TRUE(IsSlamToolboxMap(folder + "a.data"));
  EXPECT_EQ(ReadSlamToolboxMap(folder + "a.data", 0.0, &map).message(),
            folder +
                "a.data: of the two files of a map of slam_toolbox, name the one that ends in "
                ".posegraph");
  std::filesystem::rename(folder + "a.data", folder + "b.data");
  const Status no_data = ReadSlamToolboxMap(folder + "a.posegraph", 0.0, &map);
  EXPECT_EQ(no_data.code(), StatusCode::kNotFound);
  EXPECT_EQ(no_data.message(), folder + "a.posegraph: there is no '" + folder +
                                   "a.data', where slam_toolbox saves the lasers of this map");
  EXPECT_EQ(ReadSlamToolboxMap(folder + "b.posegraph", 0.0, &map).code(), StatusCode::kNotFound);
  EXPECT_TRUE(IsSlamToolboxMap(folder + "b.posegraph"));  // by its name
  EXPECT_FALSE(IsSlamToolboxMap(folder + "b.g2o"));
}

TEST(SlamToolboxMapTest, TheFilesMayNotBeEachOther) {
  const std::string folder = TempFolder();
  const KartoMap map = SmallKartoMap();
  WriteFile(folder + "a.posegraph", DataBytes(map));
  WriteFile(folder + "a.data", DataBytes(map));
  SlamToolboxMap read;
  const Status status = ReadSlamToolboxMap(folder + "a.posegraph", 0.0, &read);
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(status.message(),
              StartsWith(folder + "a.posegraph: cannot be read as a map of slam_toolbox: byte "));
}

TEST(SlamToolboxMapTest, DamageIsNamedByItsFile) {
  const std::string folder = TempFolder();
  WriteKartoMap(folder + "a", SmallKartoMap());
  const std::string data = ReadFile(folder + "a.data");
  WriteFile(folder + "a.data", data.substr(0, data.size() - 1));
  SlamToolboxMap map;
  const Status status = ReadSlamToolboxMap(folder + "a.posegraph", 0.0, &map);
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_EQ(status.message(), folder + "a.data: cannot be read as a map of slam_toolbox: byte " +
                                  std::to_string(data.size() - 2) +
                                  ": karto::Dataset.dataset_info: the file ends there");
}

TEST(SlamToolboxMapTest, MemoryIsLimited) {
  const std::string folder = TempFolder();
  WriteKartoMap(folder + "a", SmallKartoMap());
  SlamToolboxMap map;
  EXPECT_EQ(ReadSlamToolboxMap(folder + "a.posegraph", 5e3, &map).code(),
            StatusCode::kInvalidArgument);
  EXPECT_TRUE(ReadSlamToolboxMap(folder + "a.posegraph", 1e6, &map).ok());
}

}  // namespace
}  // namespace plumbline
