#include "plumbline/solvers/pose_graph/robust_pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {
namespace {

const Eigen::Matrix3d kCovariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
constexpr int kLap = 40;

// Twice round a circle; steps turn a little too much, so that the chain alone spirals.
struct Laps {
  std::vector<Pose2> truth, chained;
  std::vector<RelativePoseConstraint> steps, closures;
};

Laps MakeLaps() {
  Laps laps;
  for (int i = 0; i <= 2 * kLap; ++i) {
    const double angle = 2.0 * kPi * i / kLap;
    laps.truth.emplace_back(5.0 * std::cos(angle), 5.0 * std::sin(angle), angle + 0.5 * kPi);
  }
  laps.chained = {laps.truth.front()};
  for (int i = 0; i < 2 * kLap; ++i) {
    const Pose2 step = Between(laps.truth[i], laps.truth[i + 1]) * Pose2(0.0, 0.0, 0.003);
    laps.steps.push_back({i, i + 1, step, kCovariance});
    laps.chained.push_back(laps.chained.back() * step);
  }
  for (int i = 0; i < kLap; i += 4) {
    laps.closures.push_back(
        {i, i + kLap, Between(laps.truth[i], laps.truth[i + kLap]), kCovariance});
  }
  return laps;
}

double WorstM(const std::vector<Pose2>& a, const std::vector<Pose2>& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::hypot(a[i].x - b[i].x, a[i].y - b[i].y));
  }
  return worst;
}

TEST(OptimizeRobustly, FindsTheOptimumThatAGeneralSolverFinds) {
  const Laps laps = MakeLaps();
  std::vector<Pose2> poses = laps.chained, expected = laps.chained;
  OptimizeRobustly(laps.steps, laps.closures, &poses);
  OptimizePoseGraph(laps.steps, laps.closures, &expected);
  EXPECT_GT(WorstM(laps.chained, expected), 0.3);
  EXPECT_LT(WorstM(poses, expected), 2e-3);
  EXPECT_EQ(poses.front().x, laps.chained.front().x);
}

TEST(OptimizeRobustly, WrongClosuresDoNotBendIt) {
  Laps laps = MakeLaps();
  std::vector<Pose2> sound = laps.chained;
  OptimizeRobustly(laps.steps, laps.closures, &sound);
  for (const int i : {3, 5, 6}) {
    laps.closures.push_back({i, i + kLap / 2, Pose2(0.1 * i, 0.0, 0.0), kCovariance});
  }
  std::vector<Pose2> poses = laps.chained;
  OptimizeRobustly(laps.steps, laps.closures, &poses);
  EXPECT_LT(WorstM(poses, sound), 0.02);
}

TEST(OptimizeRobustly, LeavesPosesThatNothingTies) {
  Laps laps = MakeLaps();
  laps.steps.erase(laps.steps.begin() + 10);
  std::vector<Pose2> poses = laps.chained;
  OptimizeRobustly(laps.steps, {}, &poses);
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_TRUE(std::isfinite(poses[i].x)) << i;
  std::vector<Pose2> none, one{Pose2(1.0, 2.0, 3.0)};
  OptimizeRobustly({}, {}, &none);
  OptimizeRobustly({}, {}, &one);
  EXPECT_EQ(one.front().x, 1.0);
}

}  // namespace
}  // namespace plumbline
