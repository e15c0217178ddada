#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/sqrt_information.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/energy.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/solvers/terms/terms.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

double CostOf(const SolverSummary& summary, const std::string& term) {
  return TermOfSummary(summary, term).final_cost;
}

template <typename Vector>
double HalfSquares(const std::vector<Vector>& residuals) {
  double sum = 0.0;
  for (const Vector& residual : residuals) sum += 0.5 * residual.squaredNorm();
  return sum;
}

double RobustCost(const std::vector<double>& surfaces, const ManifoldOptions& options) {
  const GemanMcClure loss = GemanMcClure::FromGate(options.robust_gate_sigmas);
  double sum = 0.0;
  for (const double residual : surfaces) {
    if (!std::isnan(residual)) sum += 0.5 * loss.Rho(residual * residual);
  }
  return sum;
}

std::size_t Count(const std::vector<double>& surfaces) {
  std::size_t count = 0;
  for (const double residual : surfaces) count += !std::isnan(residual);
  return count;
}

class ResidualsOf : public testing::TestWithParam<SolverType> {};
INSTANTIATE_TEST_SUITE_P(JointSolvers, ResidualsOf,
                         testing::Values(SolverType::kReduced, SolverType::kAlternatingCg),
                         [](const auto& info) { return std::string(ToString(info.param)); });

TEST_P(ResidualsOf, AddUpToTheCostsOfTheSummary) {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.02, room.graph, &room.state);
  SolverOptions options;
  options.type = GetParam();
  options.rounds.max_coarse_rounds = options.rounds.max_fine_rounds = 1;
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  ASSERT_TRUE(summary.rounds.empty() || summary.rounds.back().kept);
  Residuals residuals;
  ASSERT_TRUE(EvaluateResiduals(options, room.graph, room.state, &residuals).ok());
  ASSERT_EQ(residuals.odometry.size(), room.graph.odometry().size());
  ASSERT_EQ(residuals.relative_poses.size(), room.graph.relative_poses().size());
  ASSERT_EQ(residuals.beams.size(), room.graph.num_returns());
  ASSERT_EQ(residuals.surfaces.size(), room.graph.num_returns());
  const auto expect_sum = [&](double sum, const std::string& term) {
    EXPECT_GT(sum, 0.0) << term;
    EXPECT_NEAR(sum, CostOf(summary, term), 1e-9 * sum) << term;
  };
  expect_sum(HalfSquares(residuals.odometry), kMotionTerm);
  expect_sum(HalfSquares(residuals.relative_poses), kRelativePoseTerm);
  expect_sum(HalfSquares(residuals.beams), kRangeBeamTerm);
  // The lines of the last round are those of poses that still moved in it.
  EXPECT_NEAR(RobustCost(residuals.surfaces, options.factors.manifold),
              CostOf(summary, kManifoldTerm), 0.15 * CostOf(summary, kManifoldTerm));
  EXPECT_NEAR(Count(residuals.surfaces), TermOfSummary(summary, kManifoldTerm).count,
              0.01 * room.graph.num_returns());
}

TEST(ResidualsTest, SurfacesGoByTheLinesOfTheSolver) {
  NoisyRoom room = MakeNoisyRoom();
  SolverOptions options;
  options.type = SolverType::kAlternatingCg;  // no landmarks: lines from radii alone
  Residuals residuals;
  ASSERT_TRUE(EvaluateResiduals(options, room.graph, room.state, &residuals).ok());
  ThreadPool pool(1);
  const MeasuredSurface surface =
      MeasureSurface(room.graph, NormalOptionsFor(options.factors.beam), &pool);
  Associations associations;
  associations.lines = LinesFromRadius(room.graph, room.state.poses, surface, options.association,
                                       FineRadius(options), &pool);
  TermCosts costs;
  const Energy energy(room.graph, associations, options.factors, &pool);
  ASSERT_TRUE(energy.Evaluate(room.state.poses, room.state.points, &costs));
  EXPECT_NEAR(RobustCost(residuals.surfaces, options.factors.manifold), costs.cost[3],
              1e-9 * costs.cost[3]);
  EXPECT_EQ(Count(residuals.surfaces), associations.lines.CountReturns());
}

TEST(ResidualsTest, AWrongClosureStandsOut) {
  NoisyRoom room = MakeNoisyRoom();
  RelativePoseConstraint wrong{2, 7, Between(room.truth[2], room.truth[7])};
  wrong.from_from_to.x += 0.5;
  wrong.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  room.graph.AddRelativePose(wrong);
  Residuals residuals;
  ASSERT_TRUE(EvaluateResiduals(SolverOptions(), room.graph, room.state, &residuals).ok());
  ASSERT_EQ(residuals.relative_poses.size(), 3u);
  EXPECT_LT(residuals.relative_poses[0].squaredNorm(), 16.3);
  EXPECT_LT(residuals.relative_poses[1].squaredNorm(), 16.3);
  // 0.5 m against 0.01 m.
  EXPECT_NEAR(residuals.relative_poses[2].x(), -50.0, 1e-6);
  EXPECT_NEAR(residuals.relative_poses[2].squaredNorm(), 2500.0, 1e-3);
}

TEST(ResidualsTest, BeamsAreWhitenedRangesAndBearings) {
  NoisyRoom room = MakeNoisyRoom();
  SolverOptions options;
  const std::size_t r = 100;
  const Pose2 world_from_laser =
      room.graph.WorldFromLaser(room.graph.ScanOfReturn(r), room.state.poses);
  // Three sigmas too far, two to the left.
  const Eigen::Vector2d moved =
      world_from_laser *
      BeamEnd(room.graph.returns().range_m[r] + 3.0 * options.factors.beam.sigma_range_m,
              room.graph.Bearing(r) + 2.0 * options.factors.beam.sigma_bearing_rad);
  room.state.points[2 * r] = moved.x();
  room.state.points[2 * r + 1] = moved.y();
  Residuals residuals;
  ASSERT_TRUE(EvaluateResiduals(options, room.graph, room.state, &residuals).ok());
  EXPECT_NEAR(residuals.beams[r].x(), 3.0, 1e-9);
  EXPECT_NEAR(residuals.beams[r].y(), 2.0, 1e-9);
  EXPECT_NEAR(residuals.beams[r + 1].norm(), 0.0, 1e-9);
}

TEST(ResidualsTest, TheNumberOfThreadsDoesNotMatter) {
  const NoisyRoom room = MakeNoisyRoom();
  SolverOptions options;
  Residuals one, many;
  options.num_threads = 1;
  ASSERT_TRUE(EvaluateResiduals(options, room.graph, room.state, &one).ok());
  options.num_threads = 3;
  ASSERT_TRUE(EvaluateResiduals(options, room.graph, room.state, &many).ok());
  EXPECT_EQ(one.odometry, many.odometry);
  EXPECT_EQ(one.beams, many.beams);
  for (std::size_t r = 0; r < one.surfaces.size(); ++r) {
    EXPECT_TRUE(one.surfaces[r] == many.surfaces[r] ||
                (std::isnan(one.surfaces[r]) && std::isnan(many.surfaces[r])));
  }
}

TEST(ResidualsTest, APoseGraphWithoutReturnsHasEdgesOnly) {
  SlamGraph graph;
  graph.AddPose({0, 0, 0}, 0.0);
  graph.AddPose({2, 0, 0}, 1.0);
  graph.AddRelativePose({0, 1, {1, 0, 0}, Eigen::Matrix3d::Identity()});
  SolverOptions options;
  options.type = SolverType::kPoseGraph;
  Residuals residuals;
  ASSERT_TRUE(EvaluateResiduals(options, graph, graph.InitialState(), &residuals).ok());
  ASSERT_EQ(residuals.relative_poses.size(), 1u);
  EXPECT_NEAR(residuals.relative_poses[0].squaredNorm(), 1.0, 1e-12);
  EXPECT_TRUE(residuals.odometry.empty());
  EXPECT_TRUE(residuals.beams.empty());
}

TEST(ResidualsTest, BadInputIsNamedAndChangesNothing) {
  NoisyRoom room = MakeNoisyRoom();
  Residuals residuals;
  residuals.surfaces = {7.0};
  SolverOptions options;
  options.factors.manifold.sigma_m = 0.0;
  EXPECT_THAT(EvaluateResiduals(options, room.graph, room.state, &residuals).message(),
              HasSubstr("manifold.sigma_m"));
  const Pose2 laser = room.graph.WorldFromLaser(0, room.state.poses);
  room.state.points[10] = laser.x;
  room.state.points[11] = laser.y;
  EXPECT_THAT(EvaluateResiduals(SolverOptions(), room.graph, room.state, &residuals).message(),
              HasSubstr("point 5 "));
  room.state.points[10] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(EvaluateResiduals(SolverOptions(), room.graph, room.state, &residuals).message(),
              HasSubstr("point 5 "));
  room.state.points.pop_back();
  EXPECT_THAT(EvaluateResiduals(SolverOptions(), room.graph, room.state, &residuals).message(),
              HasSubstr("but the state has 36 and"));
  EXPECT_EQ(residuals.surfaces, std::vector<double>{7.0});
}

}  // namespace
}  // namespace plumbline
