#include "plumbline/apps/run/pose_graph_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/apps/convert/convert.h"
#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/solvers/pose_graph/refine_pose_graph.h"
#include "plumbline/test/apps/room_as_g2o.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

class PoseGraphRunTest : public testing::Test {
 protected:
  // Prints nothing.
  Status Run(const std::string& log, SolverType solver = SolverOptions().type) const {
    PoseGraphRunOptions options;
    options.log = folder_ + log;
    options.output_dir = folder_ + "out";
    options.outputs = {200, 0.05};
    options.solver.type = solver;
    testing::internal::CaptureStdout();
    const Status status = RunPoseGraph(options);
    testing::internal::GetCapturedStdout();
    return status;
  }
  bool Exists(const std::string& name) const {
    return std::filesystem::exists(folder_ + "out/" + name);
  }
  nlohmann::json Summary() const {
    return nlohmann::json::parse(ReadFile(folder_ + "out/summary.json"));
  }

  const std::string folder_ = TempFolder();
};

// The same file with its vertices elsewhere.
std::string WithVertices(const std::string& g2o, const std::vector<Pose2>& poses) {
  std::string text;
  std::istringstream lines(g2o);
  int vertex = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("VERTEX_SE2", 0) == 0) {
      line = "VERTEX_SE2 " + std::to_string(10 * vertex) + Text(poses[vertex]);
      ++vertex;
    }
    text += line + "\n";
  }
  return text;
}

TEST_F(PoseGraphRunTest, WarnsThatScansWithoutAReturnDoNothing) {
  WriteFile(folder_ + "a.g2o",
            "VERTEX_SE2 0 0 0 0\n"
            "ROBOTLASER1 0 -1 2 1 30 0.01 0 3 -1 -2 -3 0 5 6 0 5 6 0 0 0 0 0 0 10 host 0\n"
            "VERTEX_SE2 1 1 0 0\n"
            "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  testing::internal::CaptureStderr();
  const Status status = Run("a.g2o");
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("warning: " + folder_ + "a.g2o: 1 of 1 scans have next to no readings"));
  EXPECT_TRUE(status.ok()) << status.message();
}

TEST_F(PoseGraphRunTest, RefinesAGraphWithItsScans) {
  NoisyRoom room = MakeNoisyRoom();
  const std::string text = AsG2o(room);
  WriteFile(folder_ + "a.g2o", text);
  const Status status = Run("a.g2o");
  ASSERT_TRUE(status.ok()) << status.message();
  for (const char* name : {"points.ply", "points.pcd", "map.pgm", "map.yaml", "before_after.png",
                           "map_given.png", "map_pose_graph.png", "map_refined.png",
                           "conflicts.png", "summary.json", "trajectory.tum", "graph.g2o"}) {
    EXPECT_TRUE(Exists(name)) << name;
  }
  PoseGraphFile given, refined;
  ASSERT_TRUE(ReadPoseGraphFile(folder_ + "a.g2o", &given).ok());
  ASSERT_TRUE(ReadPoseGraphFile(folder_ + "out/graph.g2o", &refined).ok());
  EXPECT_EQ(refined.vertex_ids, given.vertex_ids);
  EXPECT_EQ(refined.lines[1], given.lines[1]);  // the scan

  // Edges alone leave centimetres; beams of 1 cm noise against walls do better.
  const auto error_m = [&room](const MapState& state) {
    room.state.poses = state.poses;
    return MeanPoseError(room);
  };
  MapState state = given.graph.InitialState();
  const double given_error_m = error_m(state);
  RefinePoseGraph(given.graph, &state);
  const double edges_error_m = error_m(state);
  EXPECT_LT(edges_error_m, 0.8 * given_error_m);
  EXPECT_LT(error_m(refined.graph.InitialState()), 0.5 * edges_error_m);

  std::vector<TimedPose> trajectory;
  ASSERT_TRUE(ReadTumTrajectory(folder_ + "out/trajectory.tum", &trajectory).ok());
  ASSERT_EQ(trajectory.size(), room.truth.size());
  EXPECT_EQ(trajectory[3].timestamp_s, 103.0);
  EXPECT_NEAR(trajectory[3].world_from_robot.x, refined.graph.InitialPose(3).x, 1e-8);
  const nlohmann::json summary = Summary();
  EXPECT_LT(summary["pose_graph"]["chi2_pose_graph"], summary["pose_graph"]["chi2_given"]);
  EXPECT_EQ(summary["joint"]["start"], "pose graph");
  EXPECT_EQ(summary["stages"].size(), 4u);
  EXPECT_EQ(summary["alarm"], false);
  const auto& refined_map = summary["consistency"]["refined"];
  EXPECT_GT(refined_map["within_pass"]["compared"], 100);
  EXPECT_LE(refined_map["worst_over_explicable"],
            summary["consistency"]["given"]["worst_over_explicable"]);
}

// 2 m off; by the names that the file has for the poses.
TEST_F(PoseGraphRunTest, EdgesThatTheScansContradictAreIgnoredAndListed) {
  const NoisyRoom room = MakeNoisyRoom();
  const Pose2 motion = Between(room.truth[2], room.truth[7]) * Pose2(1.6, 1.2, 0.0);
  WriteFile(folder_ + "a.g2o",
            AsG2o(room) + "EDGE_SE2 20 70" + Text(motion) + " 2500 0 0 2500 0 2500\n");
  ASSERT_TRUE(Run("a.g2o").ok());
  const nlohmann::json ignored = Summary()["joint"]["local"]["ignored_edges"];
  ASSERT_EQ(ignored.size(), 1u);
  EXPECT_EQ(ignored[0]["from"], 20);
  EXPECT_EQ(ignored[0]["to"], 70);
  EXPECT_NEAR(ignored[0]["off_m"], 2.0, 0.05);
  EXPECT_NEAR(ignored[0]["sigmas"], 100.0, 3.0);
  EXPECT_THAT(ReadFile(folder_ + "out/report.html"), HasSubstr("Edges that the scans contradict"));
}

TEST_F(PoseGraphRunTest, ScansOutOfOrderCannotBeCheckedForPasses) {
  std::string text = AsG2o(MakeNoisyRoom());
  text.replace(text.find(" 103 host"), 4, " 999");  // between those of 102 and 104
  WriteFile(folder_ + "a.g2o", text);
  ASSERT_TRUE(Run("a.g2o").ok());
  EXPECT_FALSE(Exists("conflicts.png"));
  EXPECT_FALSE(Summary().contains("consistency"));
  EXPECT_TRUE(Summary().at("alarm").is_null());  // not checked
}

TEST_F(PoseGraphRunTest, KeepsAGivenStartThatTheScansFitBetter) {
  const NoisyRoom room = MakeNoisyRoom();
  WriteFile(folder_ + "a.g2o", WithVertices(AsG2o(room), room.truth));
  ASSERT_TRUE(Run("a.g2o").ok());
  EXPECT_EQ(Summary()["joint"]["start"], "given");
}

// The key scans of intel at poses that are 0.95 m off in the mean, and edges that say the same.
TEST_F(PoseGraphRunTest, PosesThatContradictTheScansAreNotTheStart) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "PLUMBLINE_DATASETS is not set";
  ConvertOptions conversion;
  conversion.input = DatasetsFolder() + "/intel-poor-poses.clf.gz";
  conversion.targets = {{folder_ + "a.g2o", ConversionFormat::kG2o}};
  ConversionReport converted;
  ASSERT_TRUE(Convert(conversion, &converted).ok());
  ASSERT_TRUE(Run("a.g2o").ok());
  EXPECT_EQ(Summary()["joint"]["start"], "scans");
  std::vector<Relation> relations;
  ASSERT_TRUE(ReadRelations(DatasetsFolder() + "/intel-poor-poses.relations", &relations).ok());
  std::vector<TimedPose> trajectory;
  ASSERT_TRUE(ReadTumTrajectory(folder_ + "out/trajectory.tum", &trajectory).ok());
  const RelationsMetric metric = MeasureRelations(relations, trajectory, RelationsOptions());
  EXPECT_EQ(metric.all.num_matched, relations.size());
  EXPECT_LT(metric.all.translation_m.mean, 0.045);
}

TEST_F(PoseGraphRunTest, RefinesAGraphWithoutScans) {
  // 2 m one way and 2.3 m the other: with equal sigmas each edge gives way by 0.1 m.
  WriteFile(folder_ + "a.graph",
            "VERTEX2 4 0 0 0\nVERTEX2 2 1 0 0\nVERTEX2 9 2 0 0\n"
            "EDGE2 4 2 1 0 0 4 0 4 4 0 0\nEDGE2 2 9 1 0 0 4 0 4 4 0 0\n"
            "EDGE2 4 9 2.3 0 0 4 0 4 4 0 0\n");
  const Status status = Run("a.graph");
  ASSERT_TRUE(status.ok()) << status.message();
  PoseGraphFile refined;
  ASSERT_TRUE(ReadPoseGraphFile(folder_ + "out/graph.toro", &refined).ok());
  EXPECT_NEAR(refined.graph.InitialPose(1).x, 1.1, 1e-6);
  EXPECT_NEAR(refined.graph.InitialPose(2).x, 2.2, 1e-6);
  EXPECT_FALSE(Exists("points.ply") || Exists("map_refined.png") || Exists("map.pgm"));
  const nlohmann::json figures = Summary()["pose_graph"];
  EXPECT_NEAR(figures["chi2_given"], 4.0 * 0.09, 1e-9);
  EXPECT_NEAR(figures["chi2_final"], 4.0 * 0.03, 1e-6);
  EXPECT_EQ(figures["converged"], true);
}

TEST_F(PoseGraphRunTest, ByEdgesAloneIfTheSolverSaysSo) {
  WriteFile(folder_ + "a.g2o", AsG2o(MakeNoisyRoom()));
  PoseGraphFile given;
  ASSERT_TRUE(ReadPoseGraphFile(folder_ + "a.g2o", &given).ok());
  MapState expected = given.graph.InitialState();
  const PoseGraphSummary edges = RefinePoseGraph(given.graph, &expected);
  for (const SolverType solver : {SolverType::kPoseGraph, SolverType::kSgd}) {
    const Status status = Run("a.g2o", solver);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_TRUE(Exists("map_given.png") && Exists("map_refined.png") && Exists("points.ply"));
    EXPECT_FALSE(Exists("map_pose_graph.png"));
    const nlohmann::json summary = Summary();
    EXPECT_FALSE(summary.contains("pose_graph") || summary.contains("joint"));
    EXPECT_EQ(summary["solver"]["solver"], ToString(solver));
    EXPECT_NEAR(summary["solver"]["chi2_seed"], edges.given_chi2, 1e-6 * edges.given_chi2);
    EXPECT_LT(summary["solver"]["chi2_final"], 1.1 * edges.final_chi2 + 1.0);
    EXPECT_GE(summary["solver"]["chi2_final"], 0.999 * edges.final_chi2);
    EXPECT_FALSE(summary["solver"]["iterations"].empty());
    EXPECT_EQ(summary["stages"].size(), 3u);
    PoseGraphFile refined;
    ASSERT_TRUE(ReadPoseGraphFile(folder_ + "out/graph.g2o", &refined).ok());
    if (solver == SolverType::kSgd) continue;
    EXPECT_NEAR(refined.graph.InitialPose(5).x, expected.WorldFromRobot(5).x, 1e-9);
    std::filesystem::remove_all(folder_ + "out");
  }
}

TEST_F(PoseGraphRunTest, SgdTakesAGraphWithoutScans) {
  WriteFile(folder_ + "a.graph",
            "VERTEX2 4 0 0 0\nVERTEX2 2 1 0 0\nVERTEX2 9 2 0 0\n"
            "EDGE2 4 2 1 0 0 4 0 4 4 0 0\nEDGE2 2 9 1 0 0 4 0 4 4 0 0\n"
            "EDGE2 4 9 2.3 0 0 4 0 4 4 0 0\n");
  ASSERT_TRUE(Run("a.graph", SolverType::kSgd).ok());
  const nlohmann::json figures = Summary()["solver"];
  EXPECT_NEAR(figures["chi2_seed"], 4.0 * 0.09, 1e-9);
  EXPECT_NEAR(figures["chi2_final"], 4.0 * 0.03, 1e-3);
  EXPECT_EQ(figures["relative_poses"], 3);
  EXPECT_FALSE(Exists("map_refined.png") || Summary().contains("stages"));
  // A graph of one pose has no edges.
  WriteFile(folder_ + "a.graph", "VERTEX2 0 0 0 0\n");
  EXPECT_THAT(Run("a.graph", SolverType::kSgd).message(), HasSubstr("no relative poses"));
}

TEST_F(PoseGraphRunTest, FixedVerticesStay) {
  WriteFile(folder_ + "a.g2o",
            "VERTEX_SE2 0 5 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 3 0 0\n"
            "EDGE_SE2 0 1 1 0 0 4 0 0 4 0 4\nEDGE_SE2 1 2 1 0 0 4 0 0 4 0 4\nFIX 1 2\n");
  ASSERT_TRUE(Run("a.g2o").ok());
  const std::string graph = ReadFile(folder_ + "out/graph.g2o");
  EXPECT_THAT(graph, HasSubstr("VERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 3 0 0\n"));
  PoseGraphFile refined;
  ASSERT_TRUE(ReadPoseGraphFile(folder_ + "out/graph.g2o", &refined).ok());
  EXPECT_NEAR(refined.graph.InitialPose(0).x, 0.0, 1e-6);
}

TEST_F(PoseGraphRunTest, MirroredScansAreRefusedBeforeAnythingIsWritten) {
  NoisyRoomOptions options;
  options.num_poses = 24;
  NoisyRoom room = MakeNoisyRoom(options);
  const std::string sound = AsG2o(room);
  std::vector<Pose2> mirror_images, nowhere(room.truth.size());
  for (const Pose2& pose : room.truth) mirror_images.emplace_back(pose.x, -pose.y, -pose.yaw);
  // Where the edges know better than the vertices, nothing is wrong with the scans.
  WriteFile(folder_ + "a.g2o", WithVertices(sound, mirror_images));
  EXPECT_TRUE(Run("a.g2o").ok());
  std::filesystem::remove_all(folder_ + "out");

  room.truth = mirror_images;  // edges likewise
  const std::string mirrored = AsG2o(room);
  for (const std::string& text : {mirrored, WithVertices(mirrored, nowhere)}) {
    WriteFile(folder_ + "a.g2o", text);
    EXPECT_THAT(Run("a.g2o").message(), HasSubstr("a.g2o: the scans look mirrored"));
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out"));
  }
  EXPECT_TRUE(Run("a.g2o", SolverType::kPoseGraph).ok());  // does not look at them
}

TEST_F(PoseGraphRunTest, AFileThatCannotBeReadLeavesNoResults) {
  WriteFile(folder_ + "a.g2o", "VERTEX_SE2 0 0 0 0\nEDGE_SE2_XY 0 1 1 1 1 0 1\n");
  EXPECT_THAT(Run("a.g2o").message(), HasSubstr("a.g2o:2: EDGE_SE2_XY"));
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out"));
  WriteFile(folder_ + "out", "in the way");
  WriteFile(folder_ + "a.g2o", "VERTEX_SE2 0 0 0 0\n");
  EXPECT_THAT(Run("a.g2o").message(), HasSubstr("cannot make the folder"));
}

}  // namespace
}  // namespace plumbline
