#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

NoisyRoom DisturbedRoomWithEdges() {
  NoisyRoom room = RoomWithEdges();
  DisturbPoses(0.05, room.graph, &room.state);
  return room;
}

double Chi2(const NoisyRoom& room) {
  return GraphChi2(room.graph.relative_poses(), PosesOf(room.state.poses));
}

class PoseOnlySolveTest : public testing::TestWithParam<SolverType> {
 protected:
  static SolverOptions Options() {
    SolverOptions options;
    options.type = GetParam();
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(Solvers, PoseOnlySolveTest,
                         testing::Values(SolverType::kPoseGraph, SolverType::kSgd),
                         [](const auto& info) { return std::string(ToString(info.param)); });

TEST_P(PoseOnlySolveTest, MovesThePosesToTheOptimumOfTheEdges) {
  NoisyRoom room = DisturbedRoomWithEdges();
  const double seed_chi2 = Chi2(room);
  const SolverSummary summary = RefineState(Options(), room.graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_EQ(summary.solver, ToString(GetParam()));
  EXPECT_EQ(summary.num_relative_poses, room.graph.relative_poses().size());
  EXPECT_EQ(summary.seed_chi2, seed_chi2);
  EXPECT_EQ(summary.final_chi2, Chi2(room));
  // Thirteen edges more than hold the eleven free poses: two loops, three degrees of freedom each.
  EXPECT_LT(summary.final_chi2, 25.0);
  EXPECT_GT(seed_chi2, 100.0);
  EXPECT_THAT(summary.message, HasSubstr("chi2 "));
  EXPECT_THAT(summary.FullReport(), HasSubstr(" relative poses, chi2 "));
  EXPECT_THAT(summary.FullReport(), testing::Not(HasSubstr("marginal")));
}

TEST_P(PoseOnlySolveTest, PointsRideAlong) {
  NoisyRoom room = DisturbedRoomWithEdges();
  DisturbPoints(0.1, &room.state);  // not where the beams end
  const MapState before = room.state;
  ASSERT_TRUE(RefineState(Options(), room.graph, &room.state).IsSolutionUsable());
  const SlamGraph& graph = room.graph;
  const auto in_robot = [&graph](const MapState& state, std::size_t r) -> Eigen::Vector2d {
    return state.WorldFromRobot(graph.scan(graph.ScanOfReturn(r)).pose).Inverse() *
           MapPoint(state, r);
  };
  EXPECT_GT((MapPoint(before, 1500) - MapPoint(room.state, 1500)).norm(), 1e-3);
  for (std::size_t r = 0; r < graph.num_returns(); r += 37) {
    EXPECT_LT((in_robot(before, r) - in_robot(room.state, r)).norm(), 1e-12) << r;
  }
}

TEST_P(PoseOnlySolveTest, ReportsEveryIteration) {
  NoisyRoom room = DisturbedRoomWithEdges();
  SolverOptions options = Options();
  std::vector<IterationSummary> rows;
  options.callback = [&](const IterationSummary& row) {
    rows.push_back(row);
    const double chi2 = GraphChi2(room.graph.relative_poses(), PosesOf(*row.poses));
    EXPECT_NEAR(row.cost, 0.5 * chi2, 1e-9 * chi2);
    EXPECT_GT(row.step_norm, 0.0);
    return rows.size() < 7;
  };
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  ASSERT_EQ(rows.size(), summary.iterations.size());
  ASSERT_GT(rows.size(), 1u);
  EXPECT_LE(rows.size(), 7u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].iteration, static_cast<int>(i) + 1);
    EXPECT_EQ(rows[i].phase, "poses");
    const double before = i > 0 ? rows[i - 1].cost : rows[0].cost + rows[0].cost_change;
    EXPECT_NEAR(rows[i].cost_change, before - rows[i].cost, 1e-9 * summary.seed_chi2);
  }
  EXPECT_NEAR(rows.back().cost, 0.5 * summary.final_chi2, 1e-6);
}

TEST_P(PoseOnlySolveTest, ReturnsTheGivenStateBitForBitIfNothingIsBetter) {
  NoisyRoom room = MakeNoisyRoom();
  SlamGraph perfect;
  for (const Pose2& pose : room.truth) perfect.AddPose(pose, 0.0);
  // Between() may be off by rounding: this motion is exact.
  MapState state = perfect.InitialState();
  state.SetPose(1, state.WorldFromRobot(0));
  perfect.AddRelativePose({0, 1, Pose2(), Eigen::Matrix3d::Identity()});
  const MapState before = state;
  const SolverSummary summary = RefineState(Options(), perfect, &state);
  EXPECT_EQ(summary.termination, TerminationType::kNoImprovement) << summary.message;
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_EQ(state, before);
  EXPECT_EQ(summary.final_chi2, summary.seed_chi2);
  EXPECT_THAT(summary.message, HasSubstr("returned as they were"));
}

TEST_P(PoseOnlySolveTest, HoldsFixedPosesAndPutsThemBack) {
  NoisyRoom room = DisturbedRoomWithEdges();
  const Pose2 fixed = room.state.WorldFromRobot(3);
  room.graph.FixPose(3, fixed);
  room.state.SetPose(3, {9.0, 9.0, 9.0});
  ASSERT_TRUE(RefineState(Options(), room.graph, &room.state).IsSolutionUsable());
  EXPECT_EQ(ToBlock(room.state.WorldFromRobot(3)), ToBlock(fixed));
}

TEST_P(PoseOnlySolveTest, HoldsFixedPosesAlsoWhereTheEdgesWouldRatherNot) {
  NoisyRoom room = DisturbedRoomWithEdges();
  const Pose2 fixed = room.state.WorldFromRobot(5) * Pose2(0.5, 0.0, 0.0);
  room.graph.FixPose(5, fixed);
  room.graph.FixPose(0);
  RefineState(Options(), room.graph, &room.state);
  EXPECT_EQ(ToBlock(room.state.WorldFromRobot(5)), ToBlock(fixed));
  EXPECT_EQ(ToBlock(room.state.WorldFromRobot(0)), ToBlock(room.graph.InitialPose(0)));
}

TEST_P(PoseOnlySolveTest, FailsWithoutRelativePoses) {
  SyntheticScene scene;
  scene.faces = {{{2, -1}, {2, 1}}};
  scene.poses = {Pose2(), Pose2(0.1, 0.0, 0.0)};
  const SlamGraph graph = MakeGraph(scene);
  MapState state = graph.InitialState();
  const SolverSummary summary = RefineState(Options(), graph, &state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_THAT(summary.message, HasSubstr("no relative poses"));
  EXPECT_THAT(summary.message, HasSubstr(ToString(GetParam())));
  EXPECT_EQ(state, graph.InitialState());
}

TEST_P(PoseOnlySolveTest, NamesAStateOrOptionThatIsWrong) {
  NoisyRoom room = DisturbedRoomWithEdges();
  SolverOptions options = Options();
  options.num_threads = 0;
  EXPECT_THAT(RefineState(options, room.graph, &room.state).message, HasSubstr("num_threads = 0"));
  room.state.poses[3 * 5] = std::numeric_limits<double>::quiet_NaN();
  const SolverSummary summary = RefineState(Options(), room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_THAT(summary.message, HasSubstr("pose 5"));
}

TEST(PoseOnlySolve, PoseGraphStopsAfterTheIterationItSaw) {
  NoisyRoom room = DisturbedRoomWithEdges();
  SolverOptions options;
  options.type = SolverType::kPoseGraph;
  options.callback = [](const IterationSummary&) { return false; };
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped);
  EXPECT_EQ(summary.iterations.size(), 1u);
  EXPECT_LT(summary.final_chi2, summary.seed_chi2);
  EXPECT_EQ(summary.final_chi2, Chi2(room));
}

TEST(PoseOnlySolve, SgdStopsWithTheStateSoFarWhenAskedTo) {
  NoisyRoom room = DisturbedRoomWithEdges();
  SolverOptions options;
  options.type = SolverType::kSgd;
  int num_calls = 0;
  options.callback = [&](const IterationSummary&) { return ++num_calls < 5; };
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped);
  EXPECT_EQ(summary.iterations.size(), 5u);
  EXPECT_LT(summary.final_chi2, summary.seed_chi2);
}

}  // namespace
}  // namespace plumbline
