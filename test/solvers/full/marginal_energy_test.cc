#include "plumbline/solvers/full/marginal_energy.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "plumbline/factors/manifold_factor.h"
#include "plumbline/factors/range_beam_factor.h"
#include "plumbline/solvers/terms/pose_terms.h"
#include "plumbline/test/core/initial_guesses.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr double kRadius_m = 0.2;

double MarginalEnergyOf(const SlamGraph& graph, const std::vector<double>& poses,
                        const FactorOptions& factors = FactorOptions(), int num_threads = 2) {
  ThreadPool pool(num_threads);
  const MeasuredSurface surface = SurfaceOf(graph);
  return MarginalEnergy(
      graph, poses, LinesFromRadius(graph, poses, surface, AssociationOptions(), kRadius_m, &pool),
      factors, &pool);
}

TEST(MarginalEnergyTest, DoesNotLookAtInitialGuesses) {
  const NoisyRoom room = MakeNoisyRoom();
  std::vector<Pose2> guesses = room.truth;
  for (std::size_t i = 1; i < guesses.size(); ++i) guesses[i].x += 0.1;
  const SlamGraph other = WithInitialPoses(room.graph, guesses);
  EXPECT_EQ(MarginalEnergyOf(other, room.state.poses),
            MarginalEnergyOf(room.graph, room.state.poses));
}

TEST(MarginalEnergyTest, IsTheMinimumOverEachPoint) {
  // The minimum over m of beam and manifold term by a search of its own: a Gauss-Newton step from
  // the beam's end solves the linearised problem, which these small residuals are close to. A gate
  // of 1000 sigmas makes the loss quadratic.
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.003, room.graph, &room.state);
  const SlamGraph& graph = room.graph;
  const std::vector<double>& poses = room.state.poses;
  FactorOptions factors;
  factors.manifold.robust_gate_sigmas = 1000.0;
  ThreadPool pool(1);
  const TangentLines lines =
      LinesFromRadius(graph, poses, SurfaceOf(graph), AssociationOptions(), kRadius_m, &pool);
  double expected = PoseTerms(graph, factors).Cost(poses);
  for (std::size_t r = 0; r < graph.num_returns(); ++r) {
    if (!lines.HasLine(r)) {
      expected += 0.5 * 16.0;  // clutter
      continue;
    }
    const Pose2 laser = graph.WorldFromLaser(graph.ScanOfReturn(r), poses);
    const BeamFrame frame =
        MakeBeamFrame(&poses[3 * graph.scan(graph.ScanOfReturn(r)).pose],
                      graph.LaserOfScan(graph.ScanOfReturn(r)).robot_from_laser);
    EXPECT_NEAR(frame.x, laser.x, 1e-12);
    Eigen::Vector2d point = MapPoint(room.state, r);
    double cost = 0.0;
    for (int iteration = 0; iteration < 5; ++iteration) {
      Eigen::Vector3d residuals;
      Eigen::Matrix<double, 3, 2, Eigen::RowMajor> jacobian;
      const Eigen::Vector2d beam(std::cos(graph.Bearing(r)), std::sin(graph.Bearing(r)));
      EvaluateRangeBeam(frame, point.data(), graph.returns().range_m[r], beam,
                        1.0 / factors.beam.sigma_range_m, 1.0 / factors.beam.sigma_bearing_rad,
                        residuals.data(), nullptr, jacobian.data());
      EvaluateManifold(lines[r], point.data(), 1.0 / factors.manifold.sigma_m, &residuals[2],
                       jacobian.data() + 4);
      cost = 0.5 * residuals.squaredNorm();
      point -= (jacobian.transpose() * jacobian).ldlt().solve(jacobian.transpose() * residuals);
    }
    expected += std::min(cost, 0.5 * 16.0);
  }
  EXPECT_NEAR(MarginalEnergyOf(graph, poses, factors), expected, 1e-3 * expected);
}

TEST(MarginalEnergyTest, AReturnWithoutALineCostsWhatAnOutlierCosts) {
  // Two scans from one place of nothing but 3 returns each make no line.
  SyntheticScene scene;
  scene.faces = {{{1, -3}, {1, 3}}, {{1, 3}, {-3, 3}}, {{-3, 3}, {-3, -3}}, {{-3, -3}, {1, -3}}};
  scene.laser = PanoramicLaser(3);
  scene.poses = {{0, 0, 0.2}, {0, 0, 0.2}};
  const SlamGraph graph = MakeGraph(scene);
  ASSERT_EQ(graph.num_returns(), 6u);
  FactorOptions factors;
  factors.manifold.robust_gate_sigmas = 2.0;
  EXPECT_DOUBLE_EQ(MarginalEnergyOf(graph, graph.initial_poses(), factors), 6 * 0.5 * 4.0);
}

TEST(MarginalEnergyTest, TellsGoodPosesFromBad) {
  const NoisyRoom room = MakeNoisyRoom();
  double previous = MarginalEnergyOf(room.graph, room.state.poses);
  for (const double sigma : {0.02, 0.05}) {
    NoisyRoom worse = MakeNoisyRoom();
    DisturbPoses(sigma, worse.graph, &worse.state);
    const double energy = MarginalEnergyOf(worse.graph, worse.state.poses);
    EXPECT_GT(energy, previous);
    previous = energy;
  }
}

TEST(MarginalEnergyTest, AnyNumberOfThreadsGivesTheSameBits) {
  NoisyRoomOptions options;
  options.num_poses = 60;
  options.num_beams = 60;
  const NoisyRoom room = MakeNoisyRoom(options);
  const double one = MarginalEnergyOf(room.graph, room.state.poses, FactorOptions(), 1);
  for (const int num_threads : {2, 3, 8}) {
    EXPECT_EQ(MarginalEnergyOf(room.graph, room.state.poses, FactorOptions(), num_threads), one);
  }
}

}  // namespace
}  // namespace plumbline
