#include "plumbline/solvers/incremental/active_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/factors/factor_testing.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// A room whose landmarks are stored, and the problems that parts of it make.
struct Parts {
  NoisyRoom room = MakeNoisyRoom();
  MeasuredSurface surface = SurfaceOf(room.graph);
  LineLandmarkOptions options = LandmarkOptionsFor(FactorOptions(), AssociationOptions());
  LandmarkStore store{options};
  EdgesByPose edges;
  ThreadPool pool{1};
  const GemanMcClure loss = GemanMcClure::FromGate(3.0);

  Parts() {
    // Far from the origin of the world, where moments would lose digits.
    for (std::size_t i = 0; i < room.state.poses.size(); i += 3) room.state.poses[i] += 1e5;
    const std::vector<int> all = All();
    store.Extend(room.graph);
    store.Reset(DominantDirection(room.graph, room.state.poses, surface, &pool));
    store.Place(all, room.graph, surface, FramesOf(room.state.poses), loss, &pool);
    Weigh(all);
    edges.Extend(room.graph, FactorOptions());
  }

  std::vector<int> All() const {
    std::vector<int> all(room.graph.num_poses());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  void Weigh(const std::vector<int>& poses) {
    store.Weigh(poses, room.graph, FramesOf(room.state.poses), loss, &pool);
  }
  ActiveProblem Problem(const std::vector<int>& active) {
    return {active, room.graph, edges, store, room.state.poses, &pool};
  }
  // At the lines as they are.
  double Cost(const ActiveProblem& problem) {
    return LandmarkLineCost(problem.observations, FramesOf(problem.poses), problem.landmarks,
                            &pool) +
           problem.terms.Cost(problem.poses);
  }
};

void Move(int id, const Pose2& by, ActiveProblem* problem) {
  const auto at = std::find(problem->pose_ids.begin() + 1, problem->pose_ids.end(), id);
  ASSERT_NE(at, problem->pose_ids.end());
  const std::size_t i = at - problem->pose_ids.begin();
  problem->poses[3 * i] += by.x;
  problem->poses[3 * i + 1] += by.y;
  problem->poses[3 * i + 2] += by.yaw;
}

TEST(ActiveProblemTest, PosesThatAreHeldCountAsIfTheyWereThere) {
  Parts parts;
  ActiveProblem all = parts.Problem(parts.All()), part = parts.Problem({3, 4, 8});
  EXPECT_LT(part.observations.observations.size(), all.observations.observations.size() / 2);
  const double all_before = parts.Cost(all), part_before = parts.Cost(part);
  for (ActiveProblem* problem : {&all, &part}) {
    Move(3, {0.02, -0.01, 0.01}, problem);
    Move(8, {-0.01, 0.03, -0.02}, problem);
  }
  const double change = parts.Cost(all) - all_before;
  EXPECT_GT(change, 100.0);
  EXPECT_NEAR(parts.Cost(part) - part_before, change, 1e-5 * change);
}

TEST(ActiveProblemTest, LinesFollowLikeThoseOfAllPoses) {
  Parts parts;
  ActiveProblem all = parts.Problem(parts.All()), part = parts.Problem({5});
  for (ActiveProblem* problem : {&all, &part}) {
    Move(5, {0.02, -0.01, 0.01}, problem);
    FitLandmarkLines(problem->observations, FramesOf(problem->poses), &parts.pool,
                     &problem->landmarks);
  }
  for (std::size_t i = 0; i < part.landmark_ids.size(); ++i) {
    const auto same =
        std::find(all.landmark_ids.begin(), all.landmark_ids.end(), part.landmark_ids[i]);
    ASSERT_NE(same, all.landmark_ids.end());
    const LineLandmark &a = part.landmarks[i], &b = all.landmarks[same - all.landmark_ids.begin()];
    EXPECT_NEAR(std::abs(a.normal.dot(b.normal)), 1.0, 1e-9);
    EXPECT_NEAR(std::abs(a.offset_m), std::abs(b.offset_m), 1e-6);
  }
}

TEST(ActiveProblemTest, OthersAreConstant) {
  Parts parts;
  const ActiveProblem part = parts.Problem({0, 1});
  // The origin, the two, and the other ends of their constraints.
  EXPECT_EQ(part.terms.is_constant.size(), part.pose_ids.size());
  EXPECT_THAT(std::vector<int>(part.pose_ids.begin() + 1, part.pose_ids.end()),
              ElementsAre(0, 1, 2, 11, 5));
  EXPECT_THAT(part.terms.is_constant, ElementsAre(true, true, false, true, true, true));
}

TEST(ActiveProblemTest, TellsWhoseReturnsHaveMovedAgainstTheirLines) {
  Parts parts;
  ActiveProblem part = parts.Problem({3, 4, 8});
  EXPECT_THAT(part.MovedPoses(parts.store, 0.001), IsEmpty());
  Move(4, {0.02, 0.02, 0.0}, &part);
  EXPECT_THAT(part.MovedPoses(parts.store, 0.001), ElementsAre(4));
  EXPECT_THAT(part.MovedPoses(parts.store, 0.1), IsEmpty());
}

TEST(ActiveProblemTest, ReadsWhatWasWeighedAgain) {
  Parts parts;
  ActiveProblem part = parts.Problem({3, 4});
  const Pose2 moved = parts.room.state.WorldFromRobot(4) * Pose2(0.05, 0.0, 0.02);
  parts.room.state.SetPose(4, moved);
  parts.Weigh({4});
  Move(4, Pose2(moved.x - part.poses[6], moved.y - part.poses[7], moved.yaw - part.poses[8]),
       &part);
  part.ReadObservations(parts.store, &parts.pool);
  EXPECT_NEAR(parts.Cost(part), parts.Cost(parts.Problem({3, 4})), 1e-6);
  EXPECT_THAT(part.MovedPoses(parts.store, 1e-6), IsEmpty());
}

}  // namespace
}  // namespace plumbline
