#include "plumbline/solvers/pose_graph/refine_pose_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Four places round a square of 1 m in a room, and the exact motions from each to the next and back
// to the first.
SlamGraph SquareDrive() {
  SyntheticScene scene;
  scene.faces = {{{-2, -2}, {3, -2}}, {{3, -2}, {3, 3}}, {{3, 3}, {-2, 3}}, {{-2, 3}, {-2, -2}}};
  scene.laser = PanoramicLaser(8);
  scene.poses = {{0, 0, 0}, {1, 0, 0.5 * kPi}, {1, 1, -kPi}, {0, 1, -0.5 * kPi}};
  SlamGraph graph = MakeGraph(scene);
  for (int from = 0; from < 4; ++from) {
    const int to = (from + 1) % 4;
    graph.AddRelativePose({from, to, Between(scene.poses[from], scene.poses[to]),
                           0.01 * Eigen::Matrix3d::Identity()});
  }
  return graph;
}

TEST(RefinePoseGraph, StartsWhereTheEdgesFitBetterAndPointsFollow) {
  const SlamGraph graph = SquareDrive();
  const MapState truth = graph.InitialState();
  MapState state = truth;
  for (int i = 1; i < 4; ++i) state.SetPose(i, Pose2(-3.0 * i, 2.0, 2.0));
  const PoseGraphSummary summary = RefinePoseGraph(graph, &state);
  EXPECT_EQ(summary.start, PoseGraphStart::kChordal);
  EXPECT_GT(summary.given_chi2, 100.0);
  ASSERT_TRUE(summary.chordal_chi2.has_value());
  EXPECT_LT(*summary.chordal_chi2, 1e-12);
  EXPECT_LT(summary.final_chi2, 1e-12);
  EXPECT_TRUE(summary.optimization.converged);
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    EXPECT_NEAR(state.points[i], truth.points[i], 1e-6);
  }
  EXPECT_THAT(summary.BriefReport(), AllOf(HasSubstr("4 poses, 4 edges"), HasSubstr("chordal")));
}

TEST(RefinePoseGraph, FixedPosesStayWhereTheyWereFixed) {
  SlamGraph graph = SquareDrive();
  const Pose2 fixed(1.2, 1.0, -kPi);
  graph.FixPose(0);
  graph.FixPose(2, fixed);
  MapState state = graph.InitialState();
  state.SetPose(2, fixed);
  state.SetPose(0, Pose2(8.0, 8.0, 8.0));
  const PoseGraphSummary summary = RefinePoseGraph(graph, &state);
  EXPECT_EQ(ToBlock(state.WorldFromRobot(0)), ToBlock(graph.InitialPose(0)));
  EXPECT_EQ(ToBlock(state.WorldFromRobot(2)), ToBlock(fixed));
  EXPECT_GT(state.WorldFromRobot(1).x, 1.05);  // shares the error
  EXPECT_GT(summary.final_chi2, 0.1);
  EXPECT_LT(summary.final_chi2, summary.given_chi2);
}

TEST(RefinePoseGraph, WithoutEdgesThePosesStay) {
  SlamGraph graph;
  MapState state;
  RefinePoseGraph(graph, &state);
  graph.AddPose({1.0, 2.0, 3.0}, 0.0);
  graph.AddPose({4.0, 5.0, 6.0}, 0.0);
  graph.ExtendState(&state);
  const PoseGraphSummary summary = RefinePoseGraph(graph, &state);
  EXPECT_FALSE(summary.chordal_chi2.has_value());
  EXPECT_EQ(state.WorldFromRobot(1).y, 5.0);
}

// Optima that Gauss-Newton reaches from the files' own poses or the chordal start, from the latter
// with 0.3 m and 0.2 rad of noise, and where it is known from the ground truth.
class RefinePoseGraphDataset : public testing::Test {
 protected:
  void SetUp() override {
    if (DatasetsFolder().empty()) {
      GTEST_SKIP() << "set PLUMBLINE_DATASETS to the folder of the pose graphs";
    }
  }
  void ExpectOptimum(const std::string& name, double chi2, int max_iterations = 20) {
    const Status status = ReadPoseGraphFile(DatasetsFolder() + "/" + name, &file_);
    ASSERT_TRUE(status.ok()) << status.message();
    MapState state = file_.graph.InitialState();
    const PoseGraphSummary summary = RefinePoseGraph(file_.graph, &state);
    EXPECT_NEAR(summary.final_chi2, chi2, 1e-6 * chi2) << summary.BriefReport();
    EXPECT_TRUE(summary.optimization.converged);
    EXPECT_LT(summary.optimization.iterations, max_iterations);
  }
  PoseGraphFile file_;
};

// Its edges know one direction up to ten thousand times better than the other.
TEST_F(RefinePoseGraphDataset, Intel) { ExpectOptimum("input_INTEL_g2o.g2o", 215.8302, 100); }

TEST_F(RefinePoseGraphDataset, M3500) { ExpectOptimum("input_M3500_g2o.g2o", 137.912951); }

TEST_F(RefinePoseGraphDataset, ManhattanOlson) {
  ExpectOptimum("manhattanOlson3500.g2o", 146.076613);
  std::ifstream truth_file(DatasetsFolder() + "/manhattanOlson3500.groundtruth.txt");
  std::vector<Pose2> truth;
  for (Pose2 pose; truth_file >> pose.x >> pose.y >> pose.yaw;) truth.push_back(pose);
  ASSERT_EQ(truth.size(), 3500u);
  // The optimum explains the noise better than the truth does, 3 degrees of freedom a pose.
  EXPECT_GT(GraphChi2(file_.graph.relative_poses(), truth), 146.1);
}

}  // namespace
}  // namespace plumbline
