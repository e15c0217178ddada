#include "plumbline/solvers/full/point_recovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "plumbline/factors/robust_loss.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

/// The noisy room, its points at the measured ends of the beams, and for each a line that misses it
/// by up to `reach_m`. Every eighth point has none.
struct LinedRoom {
  NoisyRoom room = MakeNoisyRoom();
  TangentLines lines;

  explicit LinedRoom(double reach_m) {
    RandomStates random(9);
    lines = TangentLines(room.graph.num_returns());
    for (std::size_t r = 0; r < room.graph.num_returns(); ++r) {
      const Eigen::Vector2d normal = random.Direction();
      const double offset = normal.dot(MapPoint(room.state, r)) + random.Uniform(-reach_m, reach_m);
      const int line = lines.Add({normal.x(), normal.y(), offset});
      lines.Assign(r, r % 8 == 5 ? TangentLines::kNone : line);
    }
  }

  PointDisplacements Recover(const FactorOptions& factors, int num_threads = 2) {
    ThreadPool pool(num_threads);
    room.state.points = RecoverPoints(room.graph, room.state.poses, lines, factors, &pool);
    return MeasureDisplacements(room.graph, room.state, factors, &pool);
  }

  /// Covariance of the beam, world frame.
  Eigen::Matrix2d Covariance(std::size_t r, const FactorOptions& factors) const {
    const SlamGraph& graph = room.graph;
    const double bearing =
        graph.WorldFromLaser(graph.ScanOfReturn(r), room.state.poses).yaw + graph.Bearing(r);
    Eigen::Matrix2d axes;
    axes << std::cos(bearing), -std::sin(bearing), std::sin(bearing), std::cos(bearing);
    const Eigen::Vector2d sigmas(factors.beam.sigma_range_m,
                                 factors.beam.sigma_bearing_rad * graph.returns().range_m[r]);
    return axes * sigmas.cwiseAbs2().asDiagonal() * axes.transpose();
  }

  /// Twice the beam and manifold term of a point at `point`, the beam's ends linearised.
  double Cost(std::size_t r, const Eigen::Vector2d& point, const FactorOptions& factors) const {
    const Eigen::Vector2d moved = point - Measured(r);
    const double distance =
        (Eigen::Vector2d(lines[r].normal_x, lines[r].normal_y).dot(point) - lines[r].offset) /
        factors.manifold.sigma_m;
    return moved.dot(Covariance(r, factors).inverse() * moved) +
           GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas).Rho(distance * distance);
  }

  /// The least of Cost on a way from the measured end, sampled. Plain numbers: Eigen's expressions
  /// take twenty times as long without optimisation.
  double LeastCost(std::size_t r, const Eigen::Vector2d& way, const FactorOptions& factors) const {
    const Eigen::Matrix2d precision = Covariance(r, factors).inverse();
    const double xx = precision(0, 0), xy = precision(0, 1), yy = precision(1, 1);
    const double end_x = Measured(r).x(), end_y = Measured(r).y(), way_x = way.x(), way_y = way.y();
    const double sigma_m = factors.manifold.sigma_m;
    const GemanMcClure robust = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
    const TangentLine line = lines[r];
    double least = std::numeric_limits<double>::infinity();
    for (double share = 0.0; share <= 1.0; share += 1e-3) {
      const double x = share * way_x, y = share * way_y;
      const double distance =
          (line.normal_x * (end_x + x) + line.normal_y * (end_y + y) - line.offset) / sigma_m;
      const double cost =
          x * (xx * x + xy * y) + y * (xy * x + yy * y) + robust.Rho(distance * distance);
      if (cost < least) least = cost;
    }
    return least;
  }

  Eigen::Vector2d Measured(std::size_t r) const {
    return room.state.WorldFromRobot(room.graph.scan(room.graph.ScanOfReturn(r)).pose) *
           room.graph.PointInRobot(r);
  }
  Eigen::Vector2d Moved(std::size_t r) const { return MapPoint(room.state, r) - Measured(r); }
};

// Single precision of the measured ends.
constexpr double kRounding_m = 2e-6;

TEST(PointRecoveryTest, PointsWithoutALineEndWhereTheirBeamsDo) {
  LinedRoom lined(0.1);
  lined.Recover(FactorOptions());
  for (std::size_t r = 5; r < lined.lines.size(); r += 8) {
    EXPECT_LT(lined.Moved(r).norm(), kRounding_m);
  }
}

TEST(PointRecoveryTest, WithoutOutliersItIsTheClosedForm) {
  LinedRoom lined(0.05);
  FactorOptions factors;
  factors.manifold.robust_gate_sigmas = 1e4;
  lined.Recover(factors);
  for (std::size_t r = 0; r < lined.lines.size(); ++r) {
    if (!lined.lines.HasLine(r)) continue;
    const Eigen::Vector2d normal(lined.lines[r].normal_x, lined.lines[r].normal_y);
    const Eigen::Matrix2d covariance = lined.Covariance(r, factors);
    const double variance = std::pow(factors.manifold.sigma_m, 2) + normal.dot(covariance * normal);
    const double distance = normal.dot(lined.Measured(r)) - lined.lines[r].offset;
    EXPECT_LT((lined.Moved(r) + covariance * normal * (distance / variance)).norm(), kRounding_m);
  }
}

TEST(PointRecoveryTest, EachPointIsAtTheMinimumOfItsTerms) {
  LinedRoom lined(0.12);
  const FactorOptions factors;
  lined.Recover(factors);
  int num_on_line = 0, num_outliers = 0;
  for (std::size_t r = 0; r < lined.lines.size(); ++r) {
    if (!lined.lines.HasLine(r)) continue;
    const double cost = lined.Cost(r, MapPoint(lined.room.state, r), factors);
    // Along the way that costs least per distance, C n: all minima lie on it.
    const Eigen::Vector2d normal(lined.lines[r].normal_x, lined.lines[r].normal_y);
    const Eigen::Vector2d way =
        lined.Covariance(r, factors) * normal / (normal.dot(lined.Covariance(r, factors) * normal));
    const double distance = normal.dot(lined.Measured(r)) - lined.lines[r].offset;
    EXPECT_LE(cost, lined.LeastCost(r, -distance * way, factors) + 1e-3) << r << ": " << distance;
    const double share = -normal.dot(lined.Moved(r)) / distance;
    (share < 0.2 ? num_outliers : num_on_line) += 1;
  }
  EXPECT_GT(num_on_line, 300);
  EXPECT_GT(num_outliers, 300);
}

TEST(PointRecoveryTest, NoPointMovesBeyondTheGate) {
  for (const double gate : {0.5, 2.0, 4.0}) {
    LinedRoom lined(0.5);
    FactorOptions factors;
    // So thin that a line holds whom it has caught, even where leaving would cost less.
    factors.manifold.sigma_m = 0.001;
    factors.manifold.robust_gate_sigmas = gate;
    const PointDisplacements displacements = lined.Recover(factors);
    double sum_m = 0.0, max_m = 0.0, max_sigmas = 0.0;
    for (std::size_t r = 0; r < lined.lines.size(); ++r) {
      const Eigen::Vector2d moved = lined.Moved(r);
      const double sigmas = std::sqrt(moved.dot(lined.Covariance(r, factors).inverse() * moved));
      EXPECT_LE(sigmas, gate);
      sum_m += moved.norm();
      max_m = std::max(max_m, moved.norm());
      max_sigmas = std::max(max_sigmas, sigmas);
    }
    EXPECT_GT(max_sigmas, 0.2 * gate);
    EXPECT_NEAR(displacements.mean_m, sum_m / lined.lines.size(), kRounding_m);
    EXPECT_NEAR(displacements.max_m, max_m, kRounding_m);
    EXPECT_NEAR(displacements.max_beam_sigmas, max_sigmas, 1e-3);
  }
}

TEST(PointRecoveryTest, EveryPointIsInOneBinOfEitherHistogram) {
  LinedRoom lined(0.08);
  const FactorOptions factors;
  const PointDisplacements displacements = lined.Recover(factors);
  PointDisplacements expected;
  for (std::size_t r = 0; r < lined.lines.size(); ++r) {
    const Eigen::Vector2d moved = lined.Moved(r);
    const double sigmas = std::sqrt(moved.dot(lined.Covariance(r, factors).inverse() * moved));
    ++expected.sigma_counts[std::min(16, static_cast<int>(sigmas / 0.25))];
    int octave = 0;
    for (double upper_m = 0.25e-3; octave < 11 && moved.norm() >= upper_m; upper_m *= 2.0) ++octave;
    ++expected.octave_counts[octave];
  }
  // Single precision may carry a point or two across an edge.
  std::size_t sum = 0, num_filled = 0;
  for (int i = 0; i < PointDisplacements::kNumSigmaBins; ++i) {
    EXPECT_NEAR(displacements.sigma_counts[i], expected.sigma_counts[i], 2.0) << i;
    sum += displacements.sigma_counts[i];
    num_filled += displacements.sigma_counts[i] > 0;
  }
  EXPECT_EQ(sum, lined.lines.size());
  EXPECT_GT(num_filled, 5u);
  sum = 0;
  for (int i = 0; i < PointDisplacements::kNumOctaves; ++i) {
    EXPECT_NEAR(displacements.octave_counts[i], expected.octave_counts[i], 2.0) << i;
    sum += displacements.octave_counts[i];
  }
  EXPECT_EQ(sum, lined.lines.size());
}

TEST(PointRecoveryTest, LengthsBeyondAllBinsAreInTheLast) {
  LinedRoom lined(0.0);
  for (double& coordinate : lined.room.state.points) coordinate += 50.0;
  ThreadPool pool(2);
  const PointDisplacements displacements =
      MeasureDisplacements(lined.room.graph, lined.room.state, FactorOptions(), &pool);
  EXPECT_EQ(displacements.sigma_counts.back(), lined.lines.size());
  EXPECT_EQ(displacements.octave_counts.back(), lined.lines.size());
}

TEST(PointRecoveryTest, DistantLinesMoveNothing) {
  LinedRoom lined(0.0);
  TangentLines distant(lined.lines.size());
  for (std::size_t r = 0; r < distant.size(); ++r) {
    if (!lined.lines.HasLine(r)) continue;
    TangentLine line = lined.lines[r];
    line.offset += 3.0;
    distant.Assign(r, distant.Add(line));
  }
  lined.lines = distant;
  lined.Recover(FactorOptions());
  for (std::size_t r = 0; r < lined.lines.size(); ++r) {
    EXPECT_LT(lined.Moved(r).norm(), 1e-4);
  }
}

TEST(PointRecoveryTest, AnyNumberOfThreadsGivesTheSameBits) {
  LinedRoom one(0.1);
  const PointDisplacements expected = one.Recover(FactorOptions(), 1);
  for (const int num_threads : {2, 5}) {
    LinedRoom many(0.1);
    const PointDisplacements displacements = many.Recover(FactorOptions(), num_threads);
    EXPECT_EQ(many.room.state.points, one.room.state.points);
    EXPECT_EQ(displacements.mean_m, expected.mean_m);
    EXPECT_EQ(displacements.max_m, expected.max_m);
    EXPECT_EQ(displacements.sigma_counts, expected.sigma_counts);
    EXPECT_EQ(displacements.octave_counts, expected.octave_counts);
  }
}

TEST(PointRecoveryTest, AGraphWithoutReturnsHasNoPoints) {
  SlamGraph graph;
  graph.AddPose({1, 2, 3}, 0.0);
  ThreadPool pool(2);
  const MapState state = graph.InitialState();
  EXPECT_TRUE(RecoverPoints(graph, state.poses, {}, FactorOptions(), &pool).empty());
  const PointDisplacements displacements =
      MeasureDisplacements(graph, state, FactorOptions(), &pool);
  EXPECT_EQ(displacements.mean_m, 0.0);
  EXPECT_EQ(displacements.max_m, 0.0);
}

}  // namespace
}  // namespace plumbline
