#include "plumbline/apps/io/ply_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

using testing::StartsWith;

/// `num_scans` scans of three beams, the middle one without return.
SlamGraph MakeGraph(int num_scans) {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = 3;
  laser.bearing_step_rad = 0.1;
  const int laser_id = graph.AddLaser(laser);
  for (int i = 0; i < num_scans; ++i) {
    const int pose = graph.AddPose({1000.0 + i, -7.0, 0.3}, i);
    graph.AddScan(pose, laser_id, {1.0, 99.0, 2.0});
  }
  return graph;
}

template <typename T>
T Load(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

TEST(PlyWriterTest, WritesHeaderAndEveryPointExactly) {
  const std::string path = TempFolder() + "points.ply";
  const SlamGraph graph = MakeGraph(20000);  // More than one block of the writer.
  ASSERT_EQ(graph.num_returns(), 40000u);
  const MapState state = graph.InitialState();
  ASSERT_TRUE(WritePointsPly(path, graph, state).ok());
  const std::string content = ReadFile(path);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\n"
      "comment map points of Plumbline, x y z [m] in the world frame, z = 0\n"
      "element vertex 40000\nproperty double x\nproperty double y\nproperty double z\n"
      "property int scan\nend_header\n";
  ASSERT_THAT(content, StartsWith(header));
  ASSERT_EQ(content.size(), header.size() + 40000 * 28);
  for (std::size_t i = 0; i < 40000; ++i) {
    const std::size_t offset = header.size() + 28 * i;
    ASSERT_EQ(Load<double>(content, offset), state.points[2 * i]);
    ASSERT_EQ(Load<double>(content, offset + 8), state.points[2 * i + 1]);
    ASSERT_EQ(Load<double>(content, offset + 16), 0.0);
    ASSERT_EQ(Load<std::int32_t>(content, offset + 24), static_cast<int>(i / 2));
  }
}

TEST(PlyWriterTest, AnEmptyGraphIsAnEmptyCloud) {
  const std::string path = TempFolder() + "points.ply";
  ASSERT_TRUE(WritePointsPly(path, SlamGraph(), MapState()).ok());
  EXPECT_NE(ReadFile(path).find("element vertex 0\n"), std::string::npos);
}

TEST(PlyWriterTest, StoredPointsAreThereOnceTheyAreCommitted) {
  const SlamGraph graph = MakeGraph(100);
  const MapState state = graph.InitialState();
  const std::string root = TempFolder();
  for (const int num_processes : {1, 3}) {
    const std::string folder = root + std::to_string(num_processes) + "/";
    std::filesystem::create_directory(folder);
    const auto write = [&](const SlamGraph& part, bool commits) {
      ReturnRecords file;
      EXPECT_TRUE(StorePointsPly(folder + "points.ply", part, PartOf(part, state), &file).ok());
      if (commits) {
        EXPECT_TRUE(file.Commit().ok());
      }
    };
    for (const bool commits : {false, true}) {
      if (num_processes == 1) {
        write(graph, commits);
      } else {
        RunOnParts(graph, num_processes, [&](const SlamGraph& part) { write(part, commits); });
      }
      EXPECT_EQ(NumFilesIn(folder), commits ? 1 : 0);
    }
    ASSERT_TRUE(WritePointsPly(folder + "whole.ply", graph, state).ok());
    EXPECT_TRUE(ReadFile(folder + "points.ply") == ReadFile(folder + "whole.ply"));
  }
}

TEST(PlyWriterTest, MissingFolderIsUnavailable) {
  EXPECT_EQ(WritePointsPly(TempFolder() + "none/points.ply", SlamGraph(), MapState()).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
