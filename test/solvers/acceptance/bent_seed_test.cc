// A seed that false edges have bent, and a result that is right but for a few poses.

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr int kNumPoses = 24;
constexpr int kFirst = 17, kLast = 20;  // where the seed is right and the result is not
constexpr double kOffM = 0.2;

NoisyRoom Room() {
  NoisyRoomOptions options;
  options.num_poses = kNumPoses;
  options.num_beams = 360;
  return MakeNoisyRoom(options);
}

struct Position {
  double x_m, y_m, sigma_m;

  template <typename T>
  bool operator()(const T* pose, T* residuals) const {
    residuals[0] = (pose[0] - x_m) / sigma_m;
    residuals[1] = (pose[1] - y_m) / sigma_m;
    return true;
  }
};

// Knowledge of a host that is wrong, and surer than the scans: it draws poses off the map.
void AddWrongPositions(NoisyRoom* room) {
  room->graph.FixPose(0);
  for (int pose = kFirst; pose <= kLast; ++pose) {
    const Pose2& at = room->truth[pose];
    room->graph.AddFactor("position",
                          std::make_shared<ceres::AutoDiffCostFunction<Position, 2, 3>>(
                              new Position{at.x + kOffM, at.y + kOffM, 0.003}),
                          {pose});
  }
}

// Poses 3 to 13, by up to half a metre.
void Bend(NoisyRoom* room) {
  for (int pose = 3; pose <= 13; ++pose) {
    const double bend_m = 0.5 * std::pow(std::sin(kPi * (pose - 2) / 12.0), 2);
    room->state.SetPose(pose, Pose2(bend_m, bend_m, 0.0) * room->state.WorldFromRobot(pose));
  }
  room->state.points = room->graph.MeasuredMap(room->state.poses);
}

void AddFalseEdge(NoisyRoom* room) {
  const Pose2 motion = Between(room->truth[2], room->truth[8]) * Pose2(3.0, 2.0, 1.0);
  room->graph.AddRelativePose({2, 8, motion, 1e-4 * Eigen::Matrix3d::Identity()});
}

TEST(BentSeedTest, IsNoYardstickForPartsOfTheDrive) {
  NoisyRoom room = Room();
  AddFalseEdge(&room);
  Bend(&room);
  AddWrongPositions(&room);
  const SolverSummary summary = RefineState(SolverOptions(), room.graph, &room.state);
  ASSERT_EQ(summary.ignored_edges.size(), 1u);
  EXPECT_TRUE(summary.started_from_constraints);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  // The result stays as it was found, wrong poses included.
  EXPECT_TRUE(summary.put_back.empty());
  for (int pose = kFirst; pose <= kLast; ++pose) {
    EXPECT_GT(room.state.WorldFromRobot(pose).x, room.truth[pose].x + 0.5 * kOffM);
    EXPECT_GT(room.state.WorldFromRobot(pose).y, room.truth[pose].y + 0.5 * kOffM);
  }
}

// Nothing says that edges have bent the seed: it is a yardstick, and what fits worse is refused.
TEST(BentSeedTest, WithoutFalseEdgesTheWrongPosesCount) {
  NoisyRoom room = Room();
  Bend(&room);
  AddWrongPositions(&room);
  const MapState seed = room.state;
  const SolverSummary summary = RefineState(SolverOptions(), room.graph, &room.state);
  EXPECT_TRUE(summary.ignored_edges.empty());
  EXPECT_EQ(summary.acceptance.num_worse_stretches, 1) << summary.message;
  EXPECT_EQ(room.state, seed);
}

}  // namespace
}  // namespace plumbline
