#include "plumbline/apps/convert/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plumbline/apps/io/ply_reader.h"
#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/test/apps/io/ros_map_reader.h"
#include "plumbline/test/apps/room_as_g2o.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ConvertTest : public testing::Test {
 protected:
  // A robot that drives 1 m along x twice, 2 m from a wall on its left; its laser is 0.1 m ahead of
  // it and sees nothing on the right.
  void WriteLog() const {
    std::string text;
    for (int scan = 0; scan < 3; ++scan) {
      const std::string x = std::to_string(scan);
      text += "FLASER 180";
      for (int beam = 0; beam < 180; ++beam) {
        text +=
            beam > 120 ? ' ' + std::to_string(2.0 / std::sin((beam - 90) * kPi / 180.0)) : " 81.83";
      }
      text += ' ' + x + ".1 0 0 " + x + " 0 0 " + std::to_string(100 + scan) + ".25 host 0\n";
    }
    WriteFile(Path("a.clf"), text);
  }
  // Its poses, 5 m to the left.
  void WriteTrajectory() const {
    WriteFile(Path("a.tum"), "100.25 0 5 0 0 0 0 1\n101.25 1 5 0 0 0 0 1\n102.25 2 5 0 0 0 0 1\n");
  }
  std::string Path(const std::string& name) const { return folder_ + name; }

  Status Run(const std::string& input, const std::vector<std::string>& outputs,
             const std::string& trajectory = "") {
    ConvertOptions options;
    options.input = Path(input);
    if (!trajectory.empty()) options.trajectory = Path(trajectory);
    std::string paths;
    for (const std::string& output : outputs) paths += (paths.empty() ? "" : ",") + Path(output);
    const Status status = ParseConversionTargets(paths, "", &options.targets);
    EXPECT_TRUE(status.ok()) << status.message();
    return Convert(options, &report_);
  }
  void ExpectRuns(const std::string& input, const std::vector<std::string>& outputs,
                  const std::string& trajectory = "") {
    const Status status = Run(input, outputs, trajectory);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  SlamGraph Graph(const std::string& name) const {
    PoseGraphFile file;
    const Status status = ReadPoseGraphFile(Path(name), &file);
    EXPECT_TRUE(status.ok()) << status.message();
    return file.graph;
  }

  const std::string folder_ = TempFolder();
  ConversionReport report_;
};

TEST_F(ConvertTest, ALogBecomesAPoseGraphWithItsScans) {
  WriteLog();
  ExpectRuns("a.clf", {"a.g2o", "a.toro"});
  EXPECT_EQ(report_.num_poses, 3u);
  EXPECT_EQ(report_.num_edges, 2u);
  EXPECT_EQ(report_.num_scans, 3u);
  EXPECT_EQ(report_.num_returns, 3u * 59u);
  EXPECT_THAT(report_.left_out, ElementsAre("", ""));
  SlamGraph log;
  LogNotes notes;
  ASSERT_TRUE(ReadLogIntoGraph(Path("a.clf"), 0, &notes, &log).ok());
  for (const char* name : {"a.g2o", "a.toro"}) {
    const SlamGraph graph = Graph(name);
    EXPECT_EQ(graph.initial_poses(), log.initial_poses());
    EXPECT_EQ(graph.returns().range_m, log.returns().range_m);
    EXPECT_EQ(graph.Bearings(), log.Bearings());
    EXPECT_EQ(graph.Beams(), log.Beams());
    EXPECT_NEAR(graph.laser(0).robot_from_laser.x, 0.1, 1e-12);
    EXPECT_EQ(graph.timestamp_s(2), 102.25);
    ASSERT_EQ(graph.relative_poses().size(), 2u);
    EXPECT_EQ(graph.relative_poses()[1].from_from_to.x, 1.0);
  }
}

TEST_F(ConvertTest, ATrajectoryMovesVerticesPointsAndMapButNotTheMeasurements) {
  WriteLog();
  WriteTrajectory();
  ExpectRuns("a.clf", {"a.g2o", "b.tum", "a.ply", "a.pcd", "map.yaml"}, "a.tum");
  EXPECT_THAT(report_.left_out, ElementsAre("", "2 edges, 3 scans", "3 poses, 2 edges",
                                            "3 poses, 2 edges", "3 poses, 2 edges, 3 scans"));
  const SlamGraph graph = Graph("a.g2o");
  EXPECT_THAT(graph.initial_poses(), ElementsAre(0, 5, 0, 1, 5, 0, 2, 5, 0));
  EXPECT_EQ(graph.relative_poses()[0].from_from_to.y, 0.0);
  EXPECT_THAT(ReadFile(Path("a.g2o")), HasSubstr(" 1.1 0 0 1 0 0 0 0 0 0 0 101.25 "));
  EXPECT_EQ(ReadFile(Path("b.tum")).substr(0, 40), "100.250000 0.000000000 5.000000000 0 0 0");

  std::vector<double> points;
  ASSERT_TRUE(ReadPointsPly(Path("a.ply"), &points).ok());
  ASSERT_EQ(points.size(), 2u * 3u * 59u);
  for (std::size_t i = 1; i < points.size(); i += 2) EXPECT_NEAR(points[i], 7.0, 1e-5);
  EXPECT_THAT(ReadFile(Path("a.pcd")), HasSubstr("\nPOINTS 177\n"));
  const ServedMap map = ServeMap(Path("map.yaml"));
  EXPECT_EQ(map.resolution, 0.05);
  EXPECT_EQ(map.At(1.1, 6.5), Occupancy::kFree);
  EXPECT_EQ(map.At(1.1, 4.0), Occupancy::kUnknown);
  EXPECT_EQ(std::filesystem::exists(Path("map.pgm")), true);
}

TEST_F(ConvertTest, APoseGraphKeepsItsNumbersAndIds) {
  const std::string text =
      "VERTEX_SE2 40 1.0 2 3.5\nVERTEX_SE2 7 3 4 0.50\nFIX 7\n"
      "EDGE_SE2 7 40 1.50 -0.5 0.25 4 1 0.5 9 -1 16\n";
  WriteFile(Path("a.g2o"), text);
  ExpectRuns("a.g2o", {"b.graph", "b.tum"});
  EXPECT_THAT(report_.left_out, ElementsAre("", "1 edge, 1 fixed pose"));
  EXPECT_THAT(ReadFile(Path("b.tum")), HasSubstr("\n1.000000 3.000000000 4.000000000"));
  ExpectRuns("b.graph", {"c.g2o"});
  EXPECT_EQ(ReadFile(Path("c.g2o")), text);
  WriteFile(Path("index.tum"), "0 8 0 0 0 0 0 1\n1 9 0 0 0 0 0 1\n");
  ExpectRuns("c.g2o", {"d.g2o"}, "index.tum");
  EXPECT_THAT(ReadFile(Path("d.g2o")), HasSubstr("VERTEX_SE2 40 8 0 0\nVERTEX_SE2 7 9 0 0\nFIX"));
}

TEST_F(ConvertTest, AGraphWithScansBecomesPoints) {
  WriteFile(Path("a.g2o"), AsG2o(MakeNoisyRoom()));
  ExpectRuns("a.g2o", {"a.ply", "a.tum", "a.toro"});
  std::vector<double> points;
  ASSERT_TRUE(ReadPointsPly(Path("a.ply"), &points).ok());
  EXPECT_EQ(points, Graph("a.g2o").InitialState().points);
  std::vector<TimedPose> trajectory;
  ASSERT_TRUE(ReadTumTrajectory(Path("a.tum"), &trajectory).ok());
  EXPECT_EQ(trajectory.at(3).timestamp_s, 103.0);
  EXPECT_EQ(Graph("a.toro").InitialState(), Graph("a.g2o").InitialState());
}

TEST_F(ConvertTest, ErrorsLeaveNoFiles) {
  EXPECT_EQ(Run("none.clf", {"a.g2o"}).code(), StatusCode::kNotFound);
  WriteLog();
  const int num_files = NumFilesIn(folder_);
  EXPECT_EQ(Run("a.clf", {"a.g2o"}, "none.tum").code(), StatusCode::kNotFound);
  EXPECT_EQ(Run("a.clf", {"none/a.g2o"}).code(), StatusCode::kUnavailable);
  EXPECT_EQ(Run("a.clf", {"none/map.pgm"}).code(), StatusCode::kUnavailable);
  EXPECT_EQ(NumFilesIn(folder_), num_files);
  std::filesystem::create_directory(Path("map.yaml"));
  EXPECT_THAT(Run("a.clf", {"map.pgm"}).message(),
              HasSubstr("'" + Path("map.yaml") + "': Is a directory"));
  std::filesystem::remove(Path("map.yaml"));
  EXPECT_EQ(NumFilesIn(folder_), num_files);

  WriteFile(Path("gap.tum"), "100.25 0 5 0 0 0 0 1\n102.25 2 5 0 0 0 0 1\n");
  EXPECT_THAT(Run("a.clf", {"a.g2o", "a.ply"}, "gap.tum").message(),
              HasSubstr("gap.tum: no pose at 101.25 s, the time of pose 1"));
  WriteFile(Path("bare.g2o"), "VERTEX_SE2 0 0 0 0\n");
  EXPECT_THAT(Run("bare.g2o", {"b.tum", "map.pgm"}).message(),
              HasSubstr("bare.g2o: there are no returns of a laser for '" + Path("map.pgm")));
  WriteFile(Path("bad.g2o"), "VERTEX_SE2 0 0 0\n");
  EXPECT_THAT(Run("bad.g2o", {"b.tum"}).message(), HasSubstr("bad.g2o:1: VERTEX_SE2"));
  ConvertOptions options;
  options.map_resolution_m = 0.0;
  EXPECT_THAT(Convert(options, &report_).message(), HasSubstr("ROS map: resolution_m = 0"));
  EXPECT_EQ(NumFilesIn(folder_), num_files + 3);
}

}  // namespace
}  // namespace plumbline
