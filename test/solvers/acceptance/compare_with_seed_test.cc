#include "plumbline/solvers/acceptance/compare_with_seed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "plumbline/solvers/association/held_out_returns.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

AcceptanceTest Figures(double final_energy, double final_error) {
  AcceptanceTest acceptance;
  acceptance.seed_energy = 100.0;
  acceptance.final_energy = final_energy;
  acceptance.num_held_out = 50;
  acceptance.seed_held_out_error = 1.0;
  acceptance.final_held_out_error = final_error;
  acceptance.held_out_noise = 0.05;
  return acceptance;
}

AcceptanceTest Compare(const SlamGraph& graph, const std::vector<double>& seed,
                       const std::vector<double>& poses, int num_threads = 2) {
  ThreadPool pool(num_threads);
  const FactorOptions factors;
  const MeasuredSurface surface = SurfaceOf(graph);
  LineLandmarkOptions options = LandmarkOptionsFor(factors, AssociationOptions());
  options.hold_out = true;
  const auto cut = [&](const std::vector<double>& at) {
    return CutIntoLandmarks(graph, at, surface, options, &pool);
  };
  return CompareWithSeed(graph, surface, factors, {seed, cut(seed)}, {poses, cut(poses)}, &pool);
}

NoisyRoom LargeRoom() {
  NoisyRoomOptions options;
  options.num_poses = 48;
  return MakeNoisyRoom(options);
}

TEST(CompareWithSeedTest, BothYardsticksHaveToAgree) {
  EXPECT_TRUE(Figures(90.0, 0.9).IsBetter());
  EXPECT_FALSE(Figures(110.0, 0.9).IsBetter());
  EXPECT_FALSE(Figures(90.0, 1.2).IsBetter());
  EXPECT_FALSE(Figures(100.0, 0.9).IsBetter());
  // Up to twice what chance does.
  EXPECT_TRUE(Figures(90.0, 1.09).IsBetter());
  EXPECT_FALSE(Figures(90.0, 1.11).IsBetter());
}

TEST(CompareWithSeedTest, WithRelativePosesTheEnergyDecidesUnlessTheMapFallsApart) {
  AcceptanceTest acceptance = Figures(90.0, 1.9);
  acceptance.with_other_constraints = true;
  EXPECT_TRUE(acceptance.IsBetter());
  EXPECT_THAT(acceptance.Text(), Not(HasSubstr(";")));
  acceptance.final_held_out_error = 2.1;
  EXPECT_FALSE(acceptance.IsBetter());
  EXPECT_THAT(acceptance.Text(), HasSubstr("beyond the 2 allowed"));
  acceptance.held_out_noise = 0.6;  // chance may do more
  EXPECT_TRUE(acceptance.IsBetter());
  acceptance.final_energy = 110.0;
  EXPECT_FALSE(acceptance.IsBetter());
}

TEST(CompareWithSeedTest, WithoutHeldOutReturnsTheEnergyDecides) {
  AcceptanceTest acceptance = Figures(90.0, 0.0);
  acceptance.num_held_out = 0;
  acceptance.seed_held_out_error = acceptance.held_out_noise = 0.0;
  EXPECT_TRUE(acceptance.IsBetter());
}

TEST(CompareWithSeedTest, TextNamesWhatSpeaksAgainstTheState) {
  EXPECT_THAT(Figures(90.0, 0.9).Text(), HasSubstr("100 -> 90, 50 held-out returns"));
  EXPECT_THAT(Figures(90.0, 0.9).Text(), Not(HasSubstr(";")));
  EXPECT_THAT(Figures(110.0, 0.9).Text(), HasSubstr("; the energy is not lower"));
  EXPECT_THAT(Figures(90.0, 1.2).Text(), HasSubstr("; the held-out returns fit worse"));
}

TEST(CompareWithSeedTest, TheTruthBeatsADisturbedSeedAndNotTheOtherWayRound) {
  const NoisyRoom room = LargeRoom();
  NoisyRoom disturbed = LargeRoom();
  DisturbPoses(0.02, disturbed.graph, &disturbed.state);
  const AcceptanceTest better = Compare(room.graph, disturbed.state.poses, room.state.poses);
  EXPECT_TRUE(better.IsBetter()) << better.Text();
  EXPECT_LT(better.final_held_out_error, better.seed_held_out_error - 3.0 * better.held_out_noise);
  const AcceptanceTest worse = Compare(room.graph, room.state.poses, disturbed.state.poses);
  EXPECT_FALSE(worse.LowersEnergy());
  EXPECT_FALSE(worse.KeepsHeldOutError());
}

TEST(CompareWithSeedTest, WhatContradictsTheScansDoesNotBribeTheHeldOutReturns) {
  // One edge far more certain than all returns together: following it lowers the energy.
  NoisyRoom room = LargeRoom();
  const Eigen::Matrix3d covariance = 1e-12 * Eigen::Matrix3d::Identity();
  std::vector<double> followed = room.state.poses;
  followed[3 * 20] += 0.3;
  room.graph.AddRelativePose(
      {0, 20, Between(Pose2(&followed[0]), Pose2(&followed[3 * 20])), covariance});
  AcceptanceTest acceptance = Compare(room.graph, room.state.poses, followed);
  EXPECT_TRUE(acceptance.LowersEnergy());
  EXPECT_TRUE(acceptance.IsBetter());  // a relative pose is to be believed: the map holds together
  acceptance.with_other_constraints = false;  // odometry is not
  EXPECT_FALSE(acceptance.KeepsHeldOutError()) << acceptance.Text();
  EXPECT_FALSE(acceptance.IsBetter());
}

TEST(CompareWithSeedTest, WhatIsHeldOutHasNoSayInTheLinesItIsHeldAgainst) {
  // Held-out returns that are 2 cm short keep that distance; lines that they had a say in would
  // come to meet them.
  SyntheticScene scene;
  scene.faces = {{{2, -3}, {2, 3}}};
  for (int i = 0; i < 8; ++i) scene.poses.emplace_back(0.0, 0.03 * i, 0.0);
  SlamGraph graph = MakeGraph(scene);
  const std::vector<float>& measured_m = graph.returns().range_m;
  std::vector<double> ranges_m(measured_m.begin(), measured_m.end());
  for (int s = 0; s < graph.num_scans(); ++s) {
    HeldOutReturns::ForEachOf(
        graph, s, [&](std::size_t r) { ranges_m[r] -= 0.02 / std::cos(graph.Bearing(r)); });
  }
  graph = std::move(graph).Corrected({{}, {}, ranges_m, {}, {}});
  std::vector<double> shifted = graph.initial_poses();
  for (std::size_t i = 0; i < shifted.size(); i += 3) shifted[i] += 1e-3;
  const AcceptanceTest acceptance = Compare(graph, graph.initial_poses(), shifted);
  const FactorOptions factors;
  const double variance = std::pow(NoiseOf(factors).StandardDeviation(), 2);
  EXPECT_GT(acceptance.num_held_out, 50u);
  EXPECT_NEAR(acceptance.seed_held_out_error, 0.02 * 0.02 / variance, 0.6);
  // All poses moved, and their lines with them.
  EXPECT_NEAR(acceptance.final_held_out_error, acceptance.seed_held_out_error, 1e-6);
}

TEST(CompareWithSeedTest, AnyNumberOfThreadsGivesTheSameBits) {
  const NoisyRoom room = LargeRoom();
  NoisyRoom disturbed = LargeRoom();
  DisturbPoses(0.01, disturbed.graph, &disturbed.state);
  const AcceptanceTest one = Compare(room.graph, disturbed.state.poses, room.state.poses, 1);
  const AcceptanceTest many = Compare(room.graph, disturbed.state.poses, room.state.poses, 5);
  EXPECT_EQ(one.seed_energy, many.seed_energy);
  EXPECT_EQ(one.final_energy, many.final_energy);
  EXPECT_EQ(one.seed_held_out_error, many.seed_held_out_error);
  EXPECT_EQ(one.final_held_out_error, many.final_held_out_error);
  EXPECT_EQ(one.held_out_noise, many.held_out_noise);
}

}  // namespace
}  // namespace plumbline
