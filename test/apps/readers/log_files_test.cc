#include "plumbline/apps/readers/log_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Two scans in a corner, half a metre apart.
SlamGraph Corner() {
  LaserModel laser;
  laser.num_beams = 4;
  laser.first_bearing_rad = -0.75;
  laser.bearing_step_rad = 0.5;
  laser.max_range_m = 10.0;
  SlamGraph graph;
  const int id = graph.AddLaser(laser);
  for (int pose = 0; pose < 2; ++pose) {
    graph.AddPose({0.5 * pose, 0.0, 0.0}, 10.0 + pose);
    graph.AddScan(pose, id, {2.0, 3.0, 3.0, 2.0});
  }
  graph.AddOdometry({0, 1, {0.5, 0.0, 0.0}});
  return graph;
}

TEST(LogFilesTest, WritesAMapAndReadsItAgain) {
  const SlamGraph graph = Corner();
  const std::vector<Pose2> poses = {{0.0, 0.0, 0.0}, {0.49, 0.02, 0.01}};
  const MapState map{PoseArray(poses), graph.MeasuredMap(PoseArray(poses))};
  const std::string folder = TempFolder();
  ASSERT_TRUE(io::WriteTrajectory(folder + "t.tum", graph, poses).ok());
  ASSERT_TRUE(io::WritePoints(folder + "p.ply", graph, map).ok());
  ASSERT_TRUE(io::WriteGrid(folder + "grid", graph, map).ok());
  ASSERT_TRUE(io::WritePoseGraph(folder + "map.g2o", graph, poses).ok());
  for (const char* name : {"t.tum", "p.ply", "grid.pgm", "grid.yaml"}) {
    EXPECT_GT(std::filesystem::file_size(folder + name), 20u) << name;
  }
  const io::Log read = io::ReadPoseGraph(folder + "map.g2o");
  ASSERT_TRUE(read.status.ok()) << read.status.message();
  ASSERT_EQ(read.graph.num_poses(), 2);
  EXPECT_EQ(read.graph.num_returns(), graph.num_returns());
  EXPECT_EQ(read.graph.InitialPose(1).y, 0.02);
}

TEST(LogFilesTest, ReadsALogAndTellsOfRecordsThatItSkips) {
  const std::string path = TempFolder() + "log.clf";
  WriteFile(path,
            "FLASER 3 2.0 3.0 2.0 0 0 0 0 0 0 1.0 host 1.0\n"
            "FLASER 3 2.0 x 2.0 0.1 0 0 0.1 0 0 2.0 host 2.0\n"
            "FLASER 3 2.0 3.0 2.0 0.2 0 0 0.2 0 0 3.0 host 3.0\n");
  const io::Log log = io::ReadLog(path);
  ASSERT_TRUE(log.status.ok()) << log.status.message();
  EXPECT_EQ(log.graph.num_scans(), 2);
  EXPECT_THAT(log.warnings, Contains(HasSubstr("log.clf:2")));
  io::ReadOptions first;
  first.max_scans = 1;
  EXPECT_EQ(io::ReadLog(path, first).graph.num_scans(), 1);
}

TEST(LogFilesTest, SaysWhatIsWrong) {
  const io::Log log = io::ReadLog("no/such.clf");
  EXPECT_EQ(log.status.code(), StatusCode::kNotFound);
  EXPECT_THAT(log.status.message(), HasSubstr("no/such.clf"));
  EXPECT_EQ(log.graph.num_poses(), 0);
  EXPECT_EQ(io::ReadPoseGraph("no/such.g2o").status.code(), StatusCode::kNotFound);

  const SlamGraph graph = Corner();
  const std::string folder = TempFolder();
  const Status status = io::WriteTrajectory(folder + "t.tum", graph, {Pose2()});
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("2 poses"));
  EXPECT_FALSE(std::filesystem::exists(folder + "t.tum"));
  EXPECT_EQ(io::WritePoints(folder + "p.ply", graph, {}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(io::WriteGrid(folder + "g", graph, graph.InitialState(), -1.0).code(),
            StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace plumbline
