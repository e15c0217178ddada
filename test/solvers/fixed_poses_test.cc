// Solve with fixed poses: they are constants to every solver.

#include "plumbline/core/fixed_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

struct SolverChoice {
  SolverType type;
  bool reduced_ceres = false;

  std::string Name() const { return ToString(type) + std::string(reduced_ceres ? "_reduced" : ""); }
  SolverOptions Options() const {
    SolverOptions options;
    options.type = type;
    options.ceres->reduced = reduced_ceres;
    options.rounds.max_coarse_rounds = options.rounds.max_fine_rounds = 1;
    return options;
  }
};

void PrintTo(const SolverChoice& solver, std::ostream* out) { *out << solver.Name(); }

std::string NameOf(const testing::TestParamInfo<SolverChoice>& info) { return info.param.Name(); }

// The published method leaves the map of sparse scans as it is.
NoisyRoom DisturbedRoom(const SolverChoice& solver) {
  const bool needs_dense_scans = solver.type == SolverType::kPublished;
  NoisyRoomOptions options;
  options.num_beams = needs_dense_scans ? 720 : options.num_beams;
  options.range_sigma_m = needs_dense_scans ? 0.03 : options.range_sigma_m;
  NoisyRoom room = RoomWithEdges(options);
  DisturbPoses(needs_dense_scans ? 0.005 : 0.03, room.graph, &room.state);
  return room;
}

void ExpectAtFixedPoses(const NoisyRoom& room) {
  for (const FixedPose& fixed : room.graph.fixed_poses()) {
    EXPECT_EQ(ToBlock(room.state.WorldFromRobot(fixed.pose)), ToBlock(fixed.world_from_robot))
        << fixed.pose;
  }
}

class FixedPosesTest : public testing::TestWithParam<SolverChoice> {};
INSTANTIATE_TEST_SUITE_P(
    EverySolver, FixedPosesTest,
    testing::Values(SolverChoice{SolverType::kReduced}, SolverChoice{SolverType::kAlternatingCg},
                    SolverChoice{SolverType::kPublished}, SolverChoice{SolverType::kCeres},
                    SolverChoice{SolverType::kCeres, true}, SolverChoice{SolverType::kPoseGraph},
                    SolverChoice{SolverType::kSgd}),
    NameOf);

class FixedPosesOfScansTest : public testing::TestWithParam<SolverChoice> {};
INSTANTIATE_TEST_SUITE_P(JointSolvers, FixedPosesOfScansTest,
                         testing::Values(SolverChoice{SolverType::kReduced},
                                         SolverChoice{SolverType::kAlternatingCg},
                                         SolverChoice{SolverType::kPublished},
                                         SolverChoice{SolverType::kCeres},
                                         SolverChoice{SolverType::kCeres, true}),
                         NameOf);

TEST_P(FixedPosesTest, StayBitForBitWhereTheyWereFixed) {
  for (const std::vector<int>& poses : {std::vector<int>{}, {4}, {3, 8}, {9, 8, 2}}) {
    NoisyRoom room = DisturbedRoom(GetParam());
    for (const int pose : poses) room.graph.FixPose(pose);
    MapState seed = room.state;
    PutAtFixedPoses(room.graph, &seed);
    const SolverSummary summary = RefineState(GetParam().Options(), room.graph, &room.state);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
    EXPECT_NE(summary.termination, TerminationType::kNoImprovement) << summary.message;
    ExpectAtFixedPoses(room);
    for (const int pose : {5, 10}) {
      EXPECT_NE(ToBlock(room.state.WorldFromRobot(pose)), ToBlock(seed.WorldFromRobot(pose)));
    }
  }
}

TEST_P(FixedPosesTest, WhereAllAreFixedTheSeedComesBack) {
  for (const bool in_place : {true, false}) {
    NoisyRoom room = in_place ? RoomWithEdges() : DisturbedRoom(GetParam());
    for (int pose = 0; pose < room.graph.num_poses(); ++pose) {
      room.graph.FixPose(pose);
    }
    MapState seed = room.state;
    PutAtFixedPoses(room.graph, &seed);
    EXPECT_EQ(seed == room.state, in_place);
    const SolverSummary summary = RefineState(GetParam().Options(), room.graph, &room.state);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
    EXPECT_EQ(room.state.poses, seed.poses);
    // The published method does not ask whether moving the points is worth anything.
    if (GetParam().type == SolverType::kPublished) continue;
    EXPECT_EQ(summary.termination, TerminationType::kNoImprovement) << summary.message;
    EXPECT_EQ(room.state, seed);
  }
}

TEST_P(FixedPosesTest, AStateThatIsElsewhereIsMovedThereAsAWhole) {
  NoisyRoom room = DisturbedRoom(GetParam()), elsewhere = room;
  const Pose2 motion(2.0, -5.0, 0.7);
  for (int pose = 0; pose < room.graph.num_poses(); ++pose) {
    elsewhere.state.SetPose(pose, motion * room.state.WorldFromRobot(pose));
  }
  elsewhere.state.points = room.graph.MeasuredMap(elsewhere.state.poses);
  ASSERT_TRUE(RefineState(GetParam().Options(), room.graph, &room.state).IsSolutionUsable());
  const SolverSummary summary =
      RefineState(GetParam().Options(), elsewhere.graph, &elsewhere.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  ExpectAtFixedPoses(elsewhere);
  for (std::size_t i = 0; i < room.state.poses.size(); ++i) {
    EXPECT_NEAR(elsewhere.state.poses[i], room.state.poses[i], 1e-6) << i;
  }
  for (std::size_t i = 0; i < room.state.points.size(); ++i) {
    ASSERT_NEAR(elsewhere.state.points[i], room.state.points[i], 1e-6) << i;
  }
}

TEST_P(FixedPosesTest, AStateThatIsElsewhereStaysThereIfTheSolverFails) {
  NoisyRoom room = DisturbedRoom(GetParam());
  room.graph.FixPose(4, {5.0, 5.0, 0.0});
  const MapState before = room.state;
  SolverOptions options = GetParam().Options();
  options.callback = [](const IterationSummary&) -> bool { throw std::runtime_error("no more"); };
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_THAT(summary.message, HasSubstr("no more"));
  EXPECT_EQ(room.state, before);
}

// The energy knows no world frame.
TEST_P(FixedPosesTest, AMapThatIsMovedAsAWholeIsRefinedAlike) {
  const auto refined = [](const Pose2& motion) {
    NoisyRoom room = DisturbedRoom(GetParam());
    room.graph.FixPose(0, motion * room.state.WorldFromRobot(0));
    SolverOptions options = GetParam().Options();
    options.factors.shape = true;
    options.published.max_passes = 6;
    const SolverSummary summary = RefineState(options, room.graph, &room.state);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
    EXPECT_NE(summary.termination, TerminationType::kNoImprovement) << summary.message;
    return room.state;
  };
  const Pose2 motion(30.0, -20.0, DegToRad(117.0));
  const MapState reference = refined(Pose2()), moved = refined(motion);
  // Where a solver stops, and where surfaces are cut into landmarks, depends on the frame a little.
  for (int i = 0; i < reference.num_poses(); ++i) {
    const Pose2 difference = Between(motion * reference.WorldFromRobot(i), moved.WorldFromRobot(i));
    EXPECT_LT(difference.translation().norm(), 0.003) << i;
    EXPECT_LT(std::abs(difference.yaw), 0.002) << i;
  }
  double sum_m = 0.0;
  const std::size_t num_points = reference.points.size() / 2;
  for (std::size_t p = 0; p < num_points; ++p) {
    const Eigen::Vector2d at_reference(&reference.points[2 * p]), at_moved(&moved.points[2 * p]);
    sum_m += (motion * at_reference - at_moved).norm();
  }
  EXPECT_LT(sum_m / static_cast<double>(num_points), 0.003);
}

TEST_P(FixedPosesOfScansTest, TheOnlyScanIsReturnedAtItsFixedPose) {
  SyntheticScene scene;
  scene.faces = {{{3, -2}, {3, 2}}, {{3, 2}, {-3, 2}}, {{-3, 2}, {-3, -2}}, {{-3, -2}, {3, -2}}};
  scene.laser = PanoramicLaser(180);
  scene.range_sigma_m = 0.01;
  scene.poses = {{0.5, 0.2, 0.3}};
  for (const bool in_place : {true, false}) {
    SlamGraph graph = MakeGraph(scene);
    if (!in_place) {
      graph.FixPose(0, {1.0, 2.0, 3.0});
    }
    MapState state = graph.InitialState(), seed = state;
    PutAtFixedPoses(graph, &seed);
    const SolverSummary summary = RefineState(GetParam().Options(), graph, &state);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
    EXPECT_EQ(state.poses, seed.poses);
    if (GetParam().type == SolverType::kPublished) continue;  // moves its points all the same
    EXPECT_EQ(summary.termination, TerminationType::kNoImprovement) << summary.message;
    EXPECT_EQ(state, seed);
    EXPECT_EQ(state == graph.InitialState(), in_place);
  }
}

}  // namespace
}  // namespace plumbline
