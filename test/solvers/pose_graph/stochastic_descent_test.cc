#include "plumbline/solvers/pose_graph/stochastic_descent.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

using Edges = std::vector<RelativePoseConstraint>;

RelativePoseConstraint Edge(int from, int to, const Pose2& motion, double sigma = 0.1) {
  return {from, to, motion, sigma * sigma * Eigen::Matrix3d::Identity()};
}

PoseGraphResult Descend(const Edges& edges, std::vector<Pose2>* poses,
                        const std::vector<int>& fixed = {0}) {
  return DescendStochastically(edges, poses, fixed);
}

void ExpectNear(const Pose2& pose, const Pose2& expected, double tolerance) {
  EXPECT_NEAR(pose.x, expected.x, tolerance);
  EXPECT_NEAR(pose.y, expected.y, tolerance);
  EXPECT_NEAR(pose.yaw, expected.yaw, tolerance);
}

// Two laps of a ring with noisy odometry, and an edge from each pose of the second lap to the
// first.
struct Ring {
  Edges edges;
  std::vector<Pose2> truth, odometry{Pose2()};
};

Ring MakeRing(double sigma) {
  constexpr int kPosesPerLap = 40;
  Ring ring;
  RandomStates random(3);
  const auto measure = [&](int from, int to) {
    const Pose2 noise(random.Gaussian(sigma), random.Gaussian(sigma), random.Gaussian(sigma));
    ring.edges.push_back(Edge(from, to, Between(ring.truth[from], ring.truth[to]) * noise, sigma));
  };
  Pose2 pose;
  for (int i = 0; i < 2 * kPosesPerLap; ++i) {
    ring.truth.push_back(pose);
    pose = pose * Pose2(1.0, 0.0, 2.0 * kPi / kPosesPerLap);
  }
  for (int i = 1; i < 2 * kPosesPerLap; ++i) {
    measure(i - 1, i);
    ring.odometry.push_back(ring.odometry.back() * ring.edges.back().from_from_to);
  }
  for (int i = 0; i < kPosesPerLap; ++i) measure(i, i + kPosesPerLap);
  return ring;
}

TEST(StochasticDescent, SpreadsTheErrorOfALoopOverItsEdges) {
  std::vector<Pose2> poses{{5.0, 7.0, 0.0}, {6.0, 7.0, 0.0}, {7.0, 7.0, 0.0}};
  const PoseGraphResult result = Descend(
      {Edge(0, 1, {1.0, 0.0, 0.0}), Edge(1, 2, {1.0, 0.0, 0.0}), Edge(0, 2, {2.03, 0.0, 0.0})},
      &poses);
  EXPECT_EQ(result.iterations, kMaxDescentIterations);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(poses[0].x, 5.0);
  ExpectNear(poses[1], {6.01, 7.0, 0.0}, 1e-3);
  ExpectNear(poses[2], {7.02, 7.0, 0.0}, 1e-3);
}

// Weak edges take what strong ones do not.
TEST(StochasticDescent, SharesOutByWhatIsKnown) {
  std::vector<Pose2> poses{Pose2(), {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}};
  Descend({Edge(0, 1, {1.0, 0.0, 0.0}, 0.1), Edge(1, 2, {1.0, 0.0, 0.0}, 0.2),
           Edge(0, 2, {2.6, 0.0, 0.0}, 0.1)},
          &poses);
  // The optimum shares the gap of 0.6 in the ratio of the variances, 1 : 4 : 1. The method is at
  // rest where n W r / (M sum 1 / M) adds up to zero for each difference: with M = 200 and 125 that
  // is 200 a = 2 / 0.013 / 200 * 100 c and 50 b = 2 / 0.013 / 125 * 200 c for the errors a, b, c.
  EXPECT_NEAR(poses[1].x, 1.0690, 0.005);
  EXPECT_NEAR(poses[2].x, 2.5103, 0.005);
}

TEST(StochasticDescent, ComesCloseToTheOptimumOfARing) {
  const Ring ring = MakeRing(0.05);
  std::vector<Pose2> poses = ring.odometry, best = ring.odometry;
  const double before = GraphChi2(ring.edges, poses);
  OptimizePoseGraph(ring.edges, {}, &best);
  Descend(ring.edges, &poses);
  const double optimum = GraphChi2(ring.edges, best), after = GraphChi2(ring.edges, poses);
  EXPECT_GT(before, 10.0 * optimum);
  EXPECT_LT(after, 2.5 * optimum);
  EXPECT_GE(after, optimum * (1.0 - 1e-9));
  EXPECT_EQ(poses[0].x, 0.0);
}

// What the method was made for.
TEST(StochasticDescent, RecoversFromAHopelessStart) {
  const Ring ring = MakeRing(0.05);
  RandomStates random(1);
  std::vector<Pose2> poses = ring.odometry, best = ring.odometry;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    poses[i] = {random.Gaussian(20.0), random.Gaussian(20.0), random.Gaussian(1.0)};
  }
  Descend(ring.edges, &best);
  Descend(ring.edges, &poses);
  EXPECT_LT(GraphChi2(ring.edges, poses), 1.05 * GraphChi2(ring.edges, best));
}

TEST(StochasticDescent, CovariancesAreInTheFrameOfTheFirstPose) {
  // Frame 0 looks along world y. Two measurements of one motion differ along its x, where the first
  // is ten times as sure, and along its y, where the second is.
  RelativePoseConstraint a = Edge(0, 1, {1.0, 0.0, 0.0}), b = Edge(0, 1, {2.0, 1.0, 0.0});
  a.covariance = Eigen::Vector3d(0.01, 0.1, 0.01).asDiagonal();
  b.covariance = Eigen::Vector3d(0.1, 0.01, 0.01).asDiagonal();
  std::vector<Pose2> poses{{0.0, 0.0, kPi / 2.0}, {0.0, 1.0, kPi / 2.0}}, best = poses;
  OptimizePoseGraph({a, b}, {}, &best);
  Descend({a, b}, &poses);
  ExpectNear(poses[1], best[1], 0.02);
  EXPECT_NEAR(best[1].y, 1.0 + 1.0 / 11.0, 1e-6);
}

TEST(StochasticDescent, HoldsTheFixedPoses) {
  std::vector<Pose2> poses{{0.0, 0.0, 0.0}, {0.4, 0.1, 0.0}, {3.0, 0.0, 0.0}};
  Descend({Edge(0, 1, {1.0, 0.0, 0.0}), Edge(1, 2, {1.0, 0.0, 0.0})}, &poses, {0, 2});
  EXPECT_EQ(poses[0].x, 0.0);
  EXPECT_EQ(poses[2].x, 3.0);
  ExpectNear(poses[1], {1.5, 0.0, 0.0}, 0.01);
}

TEST(StochasticDescent, PosesBeforeAndAfterAFixedOneMove) {
  std::vector<Pose2> poses(5, Pose2(2.0, 1.0, 0.0));
  Edges edges;
  for (int i = 0; i < 4; ++i) edges.push_back(Edge(i, i + 1, {1.0, 0.0, 0.0}));
  const PoseGraphResult result = Descend(edges, &poses, {2});
  EXPECT_TRUE(result.converged) << result.stop_reason;
  for (int i = 0; i < 5; ++i) ExpectNear(poses[i], {static_cast<double>(i), 1.0, 0.0}, 1e-4);
  EXPECT_EQ(poses[2].x, 2.0);
}

TEST(StochasticDescent, IslandsHangOnTheirFirstPose) {
  std::vector<Pose2> poses{
      Pose2(), {9.0, 9.0, 1.0}, {5.0, 5.0, kPi / 2.0}, {0.5, 0.0, 0.0}, {5.0, 5.0, 0.0}};
  Descend({Edge(0, 3, {1.0, 0.0, 0.0}), Edge(2, 4, {1.0, 0.0, 0.0})}, &poses);
  ExpectNear(poses[3], {1.0, 0.0, 0.0}, 1e-4);
  EXPECT_EQ(poses[1].yaw, 1.0);  // it has no edge
  EXPECT_EQ(poses[2].x, 5.0);
  ExpectNear(poses[4], {5.0, 6.0, kPi / 2.0}, 1e-4);
}

TEST(StochasticDescent, TakesEdgesInAnyDirectionAndPosesInAnyOrder) {
  const Ring ring = MakeRing(0.05);
  const int last = static_cast<int>(ring.truth.size()) - 1;
  // Every other edge turned round, and every second pose numbered from the end.
  const auto renamed = [&](int pose) { return pose % 2 == 0 ? pose : last - pose + 1; };
  Edges edges = ring.edges;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    edges[e].from = renamed(edges[e].from);
    edges[e].to = renamed(edges[e].to);
    if (e % 2 == 0) continue;
    std::swap(edges[e].from, edges[e].to);
    edges[e].from_from_to = edges[e].from_from_to.Inverse();
  }
  std::vector<Pose2> poses(ring.odometry.size());
  for (int i = 0; i <= last; ++i) poses[renamed(i)] = ring.odometry[i];
  const double before = GraphChi2(edges, poses);
  EXPECT_NEAR(before, GraphChi2(ring.edges, ring.odometry), 0.01 * before);
  Descend(edges, &poses);
  EXPECT_LT(GraphChi2(edges, poses), 0.2 * before);
}

TEST(StochasticDescent, EdgesWithoutAProperCovarianceAreLeftOut) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  Edges edges{Edge(0, 1, {1.0, 0.0, 0.0})};
  for (const double bad : {0.0, -1.0, kNaN}) {
    edges.push_back(Edge(0, 1, {7.0, 0.0, 0.0}));
    edges.back().covariance(1, 1) = bad;
    edges.push_back(edges.back());
    edges.back().to = 2;  // nothing else is known of this pose
  }
  std::vector<Pose2> poses{Pose2(), Pose2(), {3.0, 2.0, 1.0}};
  Descend(edges, &poses);
  EXPECT_NEAR(poses[1].x, 1.0, 1e-6);
  EXPECT_EQ(poses[2].x, 3.0);
}

// From a millimetre to ten kilometres in one chain: what is added up and taken away again must not
// drown the weak edge.
TEST(StochasticDescent, BearsWidelyDifferentCovariances) {
  std::vector<Pose2> poses(4);
  Descend({Edge(0, 1, {1.0, 0.0, 0.0}, 1e-3), Edge(1, 2, {1.0, 0.0, 0.0}, 1e4),
           Edge(2, 3, {1.0, 0.0, 0.0}, 1e-3), Edge(0, 3, {5.0, 0.0, 0.0}, 1e-3)},
          &poses);
  ExpectNear(poses[1], {1.0, 0.0, 0.0}, 0.02);
  ExpectNear(poses[2], {4.0, 0.0, 0.0}, 0.02);
  ExpectNear(poses[3], {5.0, 0.0, 0.0}, 0.02);
}

TEST(StochasticDescent, GivesTheSameBitsEveryTime) {
  const Ring ring = MakeRing(0.1);
  std::vector<Pose2> once = ring.odometry, again = ring.odometry;
  Descend(ring.edges, &once);
  Descend(ring.edges, &again);
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_TRUE(once[i].x == again[i].x && once[i].y == again[i].y && once[i].yaw == again[i].yaw);
  }
}

TEST(StochasticDescent, StopsWhenAskedTo) {
  const Ring ring = MakeRing(0.1);
  std::vector<Pose2> poses = ring.odometry;
  std::vector<int> iterations;
  double last_y = 0.0;
  const auto callback = [&](int iteration, const std::vector<Pose2>& now) {
    iterations.push_back(iteration);
    last_y = now.back().y;
    return iteration < 3;
  };
  const PoseGraphResult result = DescendStochastically(ring.edges, &poses, {0}, callback);
  EXPECT_THAT(iterations, testing::ElementsAre(1, 2, 3));
  EXPECT_EQ(result.iterations, 3);
  EXPECT_FALSE(result.converged);
  EXPECT_THAT(result.stop_reason, HasSubstr("stopped"));
  EXPECT_EQ(poses.back().y, last_y);
}

TEST(StochasticDescent, LeavesAllPosesWhereTheyAreOnOverflow) {
  std::vector<Pose2> poses{Pose2(), {1e308, 0.0, 0.0}, {-1e308, 0.0, 0.0}};
  const PoseGraphResult result =
      Descend({Edge(0, 1, {1.0, 0.0, 0.0}), Edge(1, 2, {1.0, 0.0, 0.0})}, &poses);
  EXPECT_FALSE(result.converged);
  EXPECT_THAT(result.stop_reason, HasSubstr("range of a double"));
  EXPECT_EQ(poses[1].x, 1e308);
}

TEST(StochasticDescent, NothingToDo) {
  std::vector<Pose2> none, one{{1.0, 2.0, 3.0}};
  EXPECT_TRUE(Descend({}, &none).converged);
  EXPECT_TRUE(Descend({}, &one).converged);
  EXPECT_EQ(one[0].y, 2.0);
}

// Olson's own world of 3500 poses, from the raw odometry.
TEST(StochasticDescent, ManhattanWorld) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "set PLUMBLINE_DATASETS to the folder of the logs";
  const std::string name = DatasetsFolder() + "/manhattanOlson3500";
  PoseGraphFile file;
  const Status status = ReadPoseGraphFile(name + ".g2o", &file);
  ASSERT_TRUE(status.ok()) << status.message();
  const Edges& edges = file.graph.relative_poses();
  std::vector<Pose2> poses = PosesOf(file.graph.initial_poses()), truth;
  std::ifstream truth_file(name + ".groundtruth.txt");
  for (Pose2 pose; truth_file >> pose.x >> pose.y >> pose.yaw;) truth.push_back(pose);
  ASSERT_EQ(truth.size(), poses.size());
  const auto mean_error_m = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      sum += (poses[i].translation() - truth[i].translation()).norm();
    }
    return sum / static_cast<double>(truth.size());
  };
  const double given_m = mean_error_m(), given_chi2 = GraphChi2(edges, poses);
  Descend(edges, &poses);
  const double found_m = mean_error_m(), found_chi2 = GraphChi2(edges, poses);
  // The right shape, some way above the optimum, ...
  EXPECT_LT(found_chi2, 0.02 * given_chi2);
  EXPECT_LT(found_chi2, 10.0 * 146.08);
  EXPECT_LT(found_m, 0.25 * given_m);
  EXPECT_LT(found_m, 2.0);
  // ... which Gauss-Newton finds from there at once, but not from the odometry.
  const PoseGraphResult polish = OptimizePoseGraph(edges, {}, &poses);
  EXPECT_NEAR(GraphChi2(edges, poses), 146.08, 0.01);
  EXPECT_LE(polish.iterations, 5);
}

}  // namespace
}  // namespace plumbline
