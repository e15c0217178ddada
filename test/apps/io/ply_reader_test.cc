#include "plumbline/apps/io/ply_reader.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

SlamGraph MakeGraph() {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = 3;
  laser.bearing_step_rad = 0.1;
  const int laser_id = graph.AddLaser(laser);
  const int pose = graph.AddPose({1000.0, -7.0, 0.3}, 0.0);
  graph.AddScan(pose, laser_id, {1.0, 1.5, 2.0});
  return graph;
}

TEST(PlyReaderTest, ReadsBackWhatTheWriterWrote) {
  const std::string path = TempFolder() + "points.ply";
  const SlamGraph graph = MakeGraph();
  const MapState state = graph.InitialState();
  ASSERT_TRUE(WritePointsPly(path, graph, state).ok());
  std::vector<double> points;
  const Status status = ReadPointsPly(path, &points);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(points, state.points);
}

TEST(PlyReaderTest, AFileThatEndsEarlyIsDataLoss) {
  const std::string path = TempFolder() + "points.ply";
  const SlamGraph graph = MakeGraph();
  ASSERT_TRUE(WritePointsPly(path, graph, graph.InitialState()).ok());
  const std::string whole = ReadFile(path);
  WriteFile(path, whole.substr(0, whole.size() - 1));
  std::vector<double> points(1);
  Status status = ReadPointsPly(path, &points);
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_EQ(status.message(), path + ": the file ends at vertex 2 of 3");
  EXPECT_EQ(points.size(), 1u);  // Untouched.
  WriteFile(path, "ply\nformat binary_little_endian 1.0\n");
  EXPECT_EQ(ReadPointsPly(path, &points).code(), StatusCode::kDataLoss);
}

TEST(PlyReaderTest, ErrorsNameFileLineAndField) {
  const std::string path = TempFolder() + "points.ply";
  const auto read = [&path](const std::string& content) {
    WriteFile(path, content);
    std::vector<double> points;
    const Status status = ReadPointsPly(path, &points);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    return status.message();
  };
  const std::string start = "ply\nformat binary_little_endian 1.0\n";
  EXPECT_EQ(read("# no such file\n"), path + ":1: not a PLY file");
  EXPECT_EQ(read("ply\nformat ascii 1.0\n"),
            path + ":2: field 'format': it is not binary_little_endian");
  EXPECT_EQ(read(start + "element vertex many\n"),
            path + ":3: field 'count': 'many' is not a count");
  EXPECT_EQ(read(start + "element vertex 1\nproperty real x\n"),
            path + ":4: field 'type': 'real' is not a scalar type");
  EXPECT_EQ(read(start + "element vertex 1\nproperty float x\nproperty float y\nend_header\n"),
            path + ":6: field 'property': no x and y of type double");
}

TEST(PlyReaderTest, PointsThatAreNotFiniteAreRefused) {
  const std::string path = TempFolder() + "points.ply";
  const SlamGraph graph = MakeGraph();
  MapState state = graph.InitialState();
  state.points[3] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(WritePointsPly(path, graph, state).ok());
  std::vector<double> points;
  EXPECT_EQ(ReadPointsPly(path, &points).message(),
            path + ": vertex 1 is not finite, or beyond 1e7 m");
}

TEST(PlyReaderTest, MissingFileIsNotFound) {
  std::vector<double> points;
  EXPECT_EQ(ReadPointsPly(TempFolder() + "none", &points).code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace plumbline
