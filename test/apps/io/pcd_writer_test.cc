#include "plumbline/apps/io/pcd_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

struct Pcd {
  std::map<std::string, std::string> header;
  std::vector<float> xyz;
  std::vector<std::uint32_t> scan;
};

Pcd ReadPcd(const std::string& path) {
  Pcd pcd;
  const std::string content = ReadFile(path);
  std::size_t at = 0;
  while (pcd.header.count("DATA") == 0) {
    const std::size_t end = content.find('\n', at);
    if (end == std::string::npos) break;
    const std::string line = content.substr(at, end - at);
    at = end + 1;
    if (line[0] == '#') continue;
    const std::size_t blank = line.find(' ');
    pcd.header[line.substr(0, blank)] = line.substr(blank + 1);
  }
  for (; at + 16 <= content.size(); at += 16) {
    float xyz[3];
    std::uint32_t scan;
    std::memcpy(xyz, &content[at], 12);
    std::memcpy(&scan, &content[at + 12], 4);
    pcd.xyz.insert(pcd.xyz.end(), xyz, xyz + 3);
    pcd.scan.push_back(scan);
  }
  EXPECT_EQ(at, content.size());
  return pcd;
}

/// `num_scans` scans of three beams, the middle one without return.
SlamGraph MakeGraph(int num_scans, double x_m, double y_m) {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = 3;
  laser.bearing_step_rad = 0.1;
  const int laser_id = graph.AddLaser(laser);
  for (int i = 0; i < num_scans; ++i) {
    const int pose = graph.AddPose({x_m + 0.01 * i, y_m, 0.3}, i);
    graph.AddScan(pose, laser_id, {1.0, 99.0, 2.0});
  }
  return graph;
}

class PcdWriterTest : public testing::Test {
 protected:
  Pcd Write(const SlamGraph& graph, const MapState& state) const {
    const Status status = WritePointsPcd(path_, graph, state);
    EXPECT_TRUE(status.ok()) << status.message();
    return ReadPcd(path_);
  }
  const std::string folder_ = TempFolder();
  const std::string path_ = folder_ + "points.pcd";
};

TEST_F(PcdWriterTest, WritesEveryPointWithItsScan) {
  const SlamGraph graph = MakeGraph(10000, 4900.0, -7.0);  // More than one block of the writer.
  const MapState state = graph.InitialState();
  Pcd pcd = Write(graph, state);
  EXPECT_EQ(pcd.header["VERSION"], "0.7");
  EXPECT_EQ(pcd.header["FIELDS"], "x y z scan");
  EXPECT_EQ(pcd.header["SIZE"], "4 4 4 4");
  EXPECT_EQ(pcd.header["TYPE"], "F F F U");
  EXPECT_EQ(pcd.header["COUNT"], "1 1 1 1");
  EXPECT_EQ(pcd.header["WIDTH"], "20000");
  EXPECT_EQ(pcd.header["HEIGHT"], "1");
  EXPECT_EQ(pcd.header["POINTS"], "20000");
  EXPECT_EQ(pcd.header["DATA"], "binary");
  EXPECT_EQ(pcd.header["VIEWPOINT"], "0 0 0 1 0 0 0");
  ASSERT_EQ(pcd.scan.size(), 20000u);
  for (std::size_t i = 0; i < pcd.scan.size(); ++i) {
    ASSERT_EQ(pcd.xyz[3 * i], static_cast<float>(state.points[2 * i]));
    ASSERT_EQ(pcd.xyz[3 * i + 1], static_cast<float>(state.points[2 * i + 1]));
    ASSERT_EQ(pcd.xyz[3 * i + 2], 0.0f);
    ASSERT_EQ(pcd.scan[i], i / 2);
  }
}

TEST_F(PcdWriterTest, MapsFarFromTheOriginKeepTheirMillimetres) {
  const SlamGraph graph = MakeGraph(100, 417321.0, -5317654.5);  // A place in UTM coordinates.
  const MapState state = graph.InitialState();
  Pcd pcd = Write(graph, state);
  double x_m = 0.0, y_m = 0.0;
  std::istringstream(pcd.header["VIEWPOINT"]) >> x_m >> y_m;
  EXPECT_EQ(x_m, 420000.0);
  EXPECT_EQ(y_m, -5320000.0);
  for (std::size_t i = 0; i < pcd.scan.size(); ++i) {
    ASSERT_NEAR(x_m + pcd.xyz[3 * i], state.points[2 * i], 0.00025);
    ASSERT_NEAR(y_m + pcd.xyz[3 * i + 1], state.points[2 * i + 1], 0.00025);
  }
}

TEST_F(PcdWriterTest, APointThatIsNotANumberStaysInItsPlace) {
  const SlamGraph graph = MakeGraph(2, 0.0, 0.0);
  MapState state = graph.InitialState();
  state.points[2] = std::numeric_limits<double>::quiet_NaN();
  const Pcd pcd = Write(graph, state);
  ASSERT_EQ(pcd.scan.size(), 4u);
  EXPECT_TRUE(std::isnan(pcd.xyz[3]));
  EXPECT_FALSE(std::isnan(pcd.xyz[6]));
}

TEST_F(PcdWriterTest, AnEmptyGraphIsAnEmptyCloud) {
  EXPECT_EQ(Write(SlamGraph(), MapState()).header["POINTS"], "0");
}

TEST_F(PcdWriterTest, BadInputLeavesNoFile) {
  const SlamGraph graph = MakeGraph(1, 0.0, 0.0);
  MapState state = graph.InitialState();
  state.poses[0] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(WritePointsPcd(path_, graph, state).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(NumFilesIn(folder_), 0);
  EXPECT_EQ(WritePointsPcd(folder_ + "none/points.pcd", SlamGraph(), MapState()).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
