#include "plumbline/solvers/pose_graph/chordal_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

// A drive of several turns round a spiral, with closures from each lap to the next.
struct Spiral {
  std::vector<Pose2> truth;
  std::vector<RelativePoseConstraint> edges;

  explicit Spiral(double sigma) {
    RandomStates random(3);
    constexpr int kPosesPerLap = 20;
    for (int i = 0; i < 60; ++i) {
      const double turn = 2.0 * kPi * i / kPosesPerLap;
      const double radius_m = 3.0 + 0.05 * i;
      truth.emplace_back(1.0 + radius_m * std::cos(turn), 2.0 + radius_m * std::sin(turn),
                         NormalizeAngle(turn + 2.0));
      for (const int from : {i - 1, i - kPosesPerLap}) {
        if (from < 0) continue;
        const Pose2 noise(random.Gaussian(sigma), random.Gaussian(sigma), random.Gaussian(sigma));
        edges.push_back({from, i, Between(truth[from], truth[i]) * noise, CorrelatedCovariance()});
      }
    }
  }
};

TEST(ChordalStart, FindsTheTruthOfAGraphWithoutNoiseFromNowhere) {
  const Spiral spiral(0.0);
  std::vector<Pose2> poses(spiral.truth.size(), Pose2(5.0, -5.0, 1.0));
  poses[0] = spiral.truth[0];
  poses[41] = spiral.truth[41];
  ASSERT_TRUE(ChordalStart(spiral.edges, {0, 41}, &poses));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(poses[i].x, spiral.truth[i].x, 1e-9);
    EXPECT_NEAR(poses[i].y, spiral.truth[i].y, 1e-9);
    EXPECT_NEAR(NormalizeAngle(poses[i].yaw - spiral.truth[i].yaw), 0.0, 1e-9);
  }
  EXPECT_EQ(poses[41].x, spiral.truth[41].x);
}

TEST(ChordalStart, IsCloseToTheOptimumOfANoisyGraph) {
  const Spiral spiral(0.05);
  std::vector<Pose2> start(spiral.truth.size(), spiral.truth[0]);
  ASSERT_TRUE(ChordalStart(spiral.edges, {0}, &start));
  std::vector<Pose2> optimum = spiral.truth;
  ASSERT_TRUE(OptimizePoseGraph(spiral.edges, {}, &optimum).converged);
  const double best = GraphChi2(spiral.edges, optimum);
  EXPECT_GT(best, 0.0);
  EXPECT_LT(GraphChi2(spiral.edges, start), 1.2 * best);
}

TEST(ChordalStart, PositionsFollowTheCovarianceOfTheEdges) {
  // Headings agree. Pose 1 lies between two fixed ones that are 3 m apart; both edges say 1 m, the
  // first with half the sigma of the second: of the 1 m between them it takes one fifth.
  const auto edge = [](int from, int to, double sigma) {
    return RelativePoseConstraint{
        from, to, {1.0, 0.0, 0.0}, sigma * sigma * Eigen::Matrix3d::Identity()};
  };
  std::vector<Pose2> poses{{0.0, 0.0, 0.0}, {9.0, 9.0, 9.0}, {3.0, 0.0, 0.0}};
  ASSERT_TRUE(ChordalStart({edge(0, 1, 0.1), edge(1, 2, 0.2)}, {0, 2}, &poses));
  EXPECT_NEAR(poses[1].x, 1.2, 1e-12);
  EXPECT_NEAR(poses[1].y, 0.0, 1e-12);
  EXPECT_NEAR(poses[1].yaw, 0.0, 1e-12);
}

TEST(ChordalStart, RefusesNumbersBeyondADouble) {
  const std::vector<Pose2> before{{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  for (const int coordinate : {0, 2}) {  // of the positions and of the headings
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    covariance(coordinate, coordinate) = 1e-320;
    std::vector<Pose2> poses = before;
    EXPECT_FALSE(ChordalStart({{0, 1, {1.0, 0.0, 0.0}, covariance}}, {0}, &poses));
    EXPECT_EQ(poses[1].x, 4.0);
    EXPECT_EQ(poses[1].yaw, 6.0);
  }
}

TEST(ChordalStart, WithoutUnknownsThePosesStay) {
  std::vector<Pose2> one{{1.0, 2.0, 3.0}};
  EXPECT_TRUE(ChordalStart({}, {0}, &one));
  EXPECT_EQ(one[0].y, 2.0);
}

}  // namespace
}  // namespace plumbline
