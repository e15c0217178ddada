#include "plumbline/solvers/full/scan_objective.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using Vector = std::vector<double>;

struct Fixture {
  Fixture() {
    DisturbPoses(0.02, room.graph, &room.state);
    DisturbPoints(0.005, &room.state);
    associations = AssociationsOf(room.graph, room.state);
  }

  NoisyRoom room = MakeNoisyRoom();
  FactorOptions factors = EveryTerm();
  Associations associations;
  ThreadPool pool{2};
};

Vector RandomVector(std::size_t size, double sigma) {
  RandomStates random(21);
  Vector v(size);
  for (double& entry : v) entry = random.Gaussian(sigma);
  return v;
}

Vector Plus(Vector x, const Vector& d, double step) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += step * d[i];
  return x;
}

double Dot(const Vector& a, const Vector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

TEST(ScanObjectiveTest, PointsStayWhereTheirRobotSeesThem) {
  Fixture f;
  const SlamGraph& graph = f.room.graph;
  const MapState& state = f.room.state;
  const Energy energy(graph, f.associations, f.factors, &f.pool);
  ScanObjective objective(energy);
  objective.AttachPoints(state);
  Vector placed;
  objective.PlacePoints(state.poses, &placed);
  for (std::size_t i = 0; i < placed.size(); ++i) EXPECT_NEAR(placed[i], state.points[i], 1e-14);

  const Vector moved = Plus(state.poses, RandomVector(state.poses.size(), 1.0), 1.0);
  objective.PlacePoints(moved, &placed);
  for (std::size_t r = 0; r < graph.num_returns(); ++r) {
    const int pose = graph.scan(graph.ScanOfReturn(r)).pose;
    const Eigen::Vector2d before = state.WorldFromRobot(pose).Inverse() * MapPoint(state, r);
    const Eigen::Vector2d after =
        Pose2(&moved[3 * pose]).Inverse() * Eigen::Vector2d(placed[2 * r], placed[2 * r + 1]);
    EXPECT_NEAR((after - before).norm(), 0.0, 1e-12);
  }
}

TEST(ScanObjectiveTest, CostIsTheJointEnergyOfThePlacedPoints) {
  Fixture f;
  const SlamGraph& graph = f.room.graph;
  const MapState& state = f.room.state;
  const Energy energy(graph, f.associations, f.factors, &f.pool);
  ScanObjective objective(energy);
  objective.AttachPoints(state);
  double cost = 0.0;
  Vector gradient, placed;
  ASSERT_TRUE(objective.Start(state.poses, &cost, &gradient));
  const Vector moved = Plus(state.poses, RandomVector(state.poses.size(), 0.05), 1.0);
  for (const Vector& x : {state.poses, moved}) {
    ASSERT_TRUE(objective.Evaluate(x, &cost, &gradient));
    objective.PlacePoints(x, &placed);
    TermCosts costs;
    ASSERT_TRUE(energy.Evaluate(x, placed, &costs));
    EXPECT_NEAR(cost, costs.Total(), 1e-9 * cost);
  }
}

TEST(ScanObjectiveTest, GradientAgreesWithDifferences) {
  Fixture f;
  // A second scan on a pose adds to the same entries.
  f.room.graph.AddScan(3, 0, Vector(180, 1.1));
  f.room.graph.ExtendState(&f.room.state);
  f.associations = AssociationsOf(f.room.graph, f.room.state);
  const SlamGraph& graph = f.room.graph;
  const MapState& state = f.room.state;
  const Energy energy(graph, f.associations, f.factors, &f.pool);
  ScanObjective objective(energy);
  objective.AttachPoints(state);
  double cost = 0.0;
  Vector gradient, ignored;
  ASSERT_TRUE(objective.Start(state.poses, &cost, &gradient));
  ASSERT_EQ(gradient.size(), state.poses.size());
  double norm = std::sqrt(Dot(gradient, gradient));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(gradient[i], 0.0) << "the first pose is fixed";
  for (std::size_t i = 3; i < gradient.size(); ++i) {
    constexpr double kStep = 1e-6;
    Vector x = state.poses;
    double ahead = 0.0, behind = 0.0;
    x[i] += kStep;
    ASSERT_TRUE(objective.Evaluate(x, &ahead, &ignored));
    x[i] -= 2.0 * kStep;
    ASSERT_TRUE(objective.Evaluate(x, &behind, &ignored));
    EXPECT_NEAR(gradient[i], (ahead - behind) / (2.0 * kStep), 1e-6 * norm) << i;
  }
}

TEST(ScanObjectiveTest, PreconditionerIsTheDiagonalOfTheCurvature) {
  // For unit vectors of one pose: e^T P e = curvature, with P from P^-1's action. The shape terms
  // are left out of P, so they are switched off here.
  Fixture f;
  f.factors.shape = false;
  const SlamGraph& graph = f.room.graph;
  const MapState& state = f.room.state;
  const Energy energy(graph, f.associations, f.factors, &f.pool);
  ScanObjective objective(energy);
  objective.AttachPoints(state);
  double cost = 0.0;
  Vector gradient;
  const Vector& x = state.poses;
  ASSERT_TRUE(objective.Start(x, &cost, &gradient));
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    // H of the block by polarisation, then P^-1 H = 1.
    const auto unit = [&](int i, int j) {
      Vector d(x.size(), 0.0);
      d[3 * pose + i] += 1.0;
      if (j >= 0) d[3 * pose + j] += 1.0;
      return objective.Curvature(x, d);
    };
    for (int j = 0; j < 3; ++j) {
      Vector column(x.size(), 0.0), result;
      for (int i = 0; i < 3; ++i) {
        column[3 * pose + i] =
            i == j ? unit(i, -1) : 0.5 * (unit(i, j) - unit(i, -1) - unit(j, -1));
      }
      objective.Precondition(x, column, &result);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(result[3 * pose + i], i == j ? 1.0 : 0.0, 1e-6);
    }
  }
}

TEST(ScanObjectiveTest, CurvatureIsThatOfTheEnergyAlongTheMotion) {
  Fixture f;
  const SlamGraph& graph = f.room.graph;
  const MapState& state = f.room.state;
  const Energy energy(graph, f.associations, f.factors, &f.pool);
  ScanObjective objective(energy);
  objective.AttachPoints(state);
  double cost = 0.0;
  Vector gradient;
  ASSERT_TRUE(objective.Start(state.poses, &cost, &gradient));
  const Vector d = RandomVector(state.poses.size(), 1.0);
  // How the points move, by differences. The beam terms feel nothing of it.
  Vector ahead, behind;
  constexpr double kStep = 1e-6;
  objective.PlacePoints(Plus(state.poses, d, kStep), &ahead);
  objective.PlacePoints(Plus(state.poses, d, -kStep), &behind);
  for (std::size_t i = 0; i < ahead.size(); ++i) ahead[i] = (ahead[i] - behind[i]) / (2.0 * kStep);
  const double expected = energy.Curvature(state.poses, state.points, &d, &ahead);
  EXPECT_NEAR(objective.Curvature(state.poses, d), expected, 1e-6 * expected);
}

}  // namespace
}  // namespace plumbline
