#include "plumbline/solvers/front_end/global_icp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// Around a block of 8 x 4 m on a corridor, one and a half times, so that every place of the first
// half is seen twice; 0.5 m between scans.
SyntheticScene LapScene() {
  SyntheticScene scene;
  scene.faces = Rectangle({0.0, 0.0}, {12.0, 8.0});
  const std::vector<Face> inside = {{{2.0, 2.0}, {2.0, 6.0}},   {{2.0, 6.0}, {10.0, 6.0}},
                                    {{10.0, 6.0}, {10.0, 2.0}}, {{10.0, 2.0}, {2.0, 2.0}},
                                    {{5.0, 0.0}, {5.0, 0.4}},   {{7.0, 7.4}, {7.0, 8.0}},
                                    {{11.5, 3.0}, {12.0, 3.0}}, {{0.0, 5.0}, {0.5, 5.0}}};
  scene.faces.insert(scene.faces.end(), inside.begin(), inside.end());
  scene.range_sigma_m = 0.01;
  const std::vector<Eigen::Vector2d> corners = {{1.0, 1.0}, {11.0, 1.0}, {11.0, 7.0}, {1.0, 7.0},
                                                {1.0, 1.0}, {11.0, 1.0}, {11.0, 7.0}};
  for (std::size_t c = 0; c + 1 < corners.size(); ++c) {
    const Eigen::Vector2d way = corners[c + 1] - corners[c];
    const int steps = static_cast<int>(std::lround(way.norm() / 0.5));
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d at = corners[c] + i * way / steps;
      scene.poses.emplace_back(at.x(), at.y(), std::atan2(way.y(), way.x()));
    }
  }
  return scene;
}

// A start that drifts steadily: by half a metre and more, and 7 degrees.
std::vector<Pose2> Drifting(const std::vector<Pose2>& truth) {
  std::vector<Pose2> poses = {truth.front()};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose2 step = Between(truth[i - 1], truth[i]);
    poses.push_back(poses.back() * Pose2(1.01 * step.x, step.y, step.yaw + 0.0012));
  }
  return poses;
}

double WorstErrorM(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    worst = std::max(worst, DistanceM(poses[i], truth[i]));
  }
  return worst;
}

struct Lap {
  SyntheticScene scene = LapScene();
  SlamGraph graph = MakeGraph(scene);
  MeasuredSurface surface = SurfaceOf(graph);
  MapState start;

  Lap() { start.poses = PoseArray(Drifting(scene.poses)); }

  Status Align(const GlobalIcpOptions& options, int num_threads, MapState* state) const {
    ThreadPool pool(num_threads);
    return AlignScansGlobally(options, MotionOptions(), surface, &pool, graph, state);
  }
};

class GlobalIcpTest : public testing::TestWithParam<IcpMetric> {
 protected:
  static GlobalIcpOptions Options() {
    RangeBeamOptions beam;
    beam.sigma_range_m = 0.01;
    return GlobalIcpOptionsFor(beam, GetParam());
  }
};
INSTANTIATE_TEST_SUITE_P(Metrics, GlobalIcpTest,
                         testing::Values(IcpMetric::kPointToPoint, IcpMetric::kPointToLine),
                         [](const auto& info) {
                           return std::string(info.param == IcpMetric::kPointToPoint
                                                  ? "point_to_point"
                                                  : "point_to_line");
                         });

TEST_P(GlobalIcpTest, ClosesALapThatDriftsApart) {
  const Lap lap;
  ASSERT_GT(WorstErrorM(PosesOf(lap.start.poses), lap.scene.poses), 0.4);
  MapState state = lap.start;
  ASSERT_TRUE(lap.Align(Options(), 2, &state).ok());
  const std::vector<Pose2> poses = PosesOf(state.poses);
  EXPECT_LT(WorstErrorM(poses, lap.scene.poses),
            GetParam() == IcpMetric::kPointToLine ? 0.02 : 0.06);
  EXPECT_EQ(poses.front().x, lap.scene.poses.front().x);
  EXPECT_EQ(state.points, lap.graph.MeasuredMap(state.poses));
}

TEST_P(GlobalIcpTest, IsTheSameForAnyNumberOfThreads) {
  const Lap lap;
  MapState one = lap.start, three = lap.start;
  ASSERT_TRUE(lap.Align(Options(), 1, &one).ok());
  ASSERT_TRUE(lap.Align(Options(), 3, &three).ok());
  EXPECT_TRUE(one == three);
}

TEST(GlobalIcpInputTest, ScansWithoutReturnsKeepTheirPlaceInTheStart) {
  Lap lap;
  SlamGraph empty;
  empty.AddLaser(lap.graph.laser(0));
  for (const Pose2& pose : PosesOf(lap.start.poses)) {
    empty.AddPose(pose, 0.1 * empty.num_poses());
  }
  MapState state = lap.start;
  ThreadPool pool(1);
  ASSERT_TRUE(AlignScansGlobally(GlobalIcpOptions(), MotionOptions(), MeasuredSurface(), &pool,
                                 empty, &state)
                  .ok());
  EXPECT_EQ(state.poses, lap.start.poses);
}

TEST(GlobalIcpInputTest, WrongInputIsRefusedAndTheStateStays) {
  const Lap lap;
  MapState state = lap.start;
  ThreadPool pool(1);
  const auto refusal = [&](const GlobalIcpOptions& options, const MeasuredSurface& surface) {
    return AlignScansGlobally(options, MotionOptions(), surface, &pool, lap.graph, &state)
        .message();
  };
  EXPECT_THAT(refusal(GlobalIcpOptions(), MeasuredSurface()), HasSubstr("one normal per return"));
  GlobalIcpOptions options;
  options.max_partners = 0;
  EXPECT_THAT(refusal(options, lap.surface), HasSubstr("max_partners"));
  options = GlobalIcpOptions();
  options.icp.gate_m = -1.0;
  EXPECT_THAT(refusal(options, lap.surface), HasSubstr("gate_m"));
  EXPECT_TRUE(state == lap.start);
  state.poses.pop_back();
  state.poses.pop_back();
  state.poses.pop_back();
  EXPECT_THAT(refusal(GlobalIcpOptions(), lap.surface), HasSubstr("a start for each of"));
}

}  // namespace
}  // namespace plumbline
