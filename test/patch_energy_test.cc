#include "plumbline/solvers/reduced/patch_energy.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/solvers/pose_terms.h"
#include "plumbline/test/noisy_room.h"

namespace plumbline {
namespace {

std::vector<double> EnergiesOf(const SlamGraph& graph,
                               const std::vector<const std::vector<double>*>& states,
                               int num_threads = 2) {
  ThreadPool pool(num_threads);
  const MeasuredSurface surface = SurfaceOf(graph);
  const FactorOptions factors;
  return PatchEnergies(
      graph, surface, factors,
      CutIntoPatches(graph, surface, PatchOptionsFor(factors, AssociationOptions()), &pool), states,
      &pool);
}

TEST(PatchEnergyTest, TheTruthIsBetterThanADisturbedStateUnderThePatchesOfEither) {
  const NoisyRoom room = MakeNoisyRoom();
  for (const double sigma : {0.003, 0.01, 0.03}) {
    NoisyRoom disturbed = MakeNoisyRoom();
    DisturbPoses(sigma, &disturbed.graph);
    for (const SlamGraph* graph : {&room.graph, static_cast<const SlamGraph*>(&disturbed.graph)}) {
      const std::vector<double> energies =
          EnergiesOf(*graph, {&room.graph.poses(), &disturbed.graph.poses()});
      EXPECT_LT(energies[0], energies[1]) << sigma;
    }
  }
}

TEST(PatchEnergyTest, StatesDoNotInfluenceEachOther) {
  const NoisyRoom room = MakeNoisyRoom();
  NoisyRoom disturbed = MakeNoisyRoom();
  DisturbPoses(0.02, &disturbed.graph);
  const std::vector<double>& a = room.graph.poses();
  const std::vector<double>& b = disturbed.graph.poses();
  const std::vector<double> energies = EnergiesOf(room.graph, {&a, &b, &a}, 1);
  EXPECT_EQ(energies[0], energies[2]);
  EXPECT_EQ(EnergiesOf(room.graph, {&b}, 3)[0], energies[1]);
}

TEST(PatchEnergyTest, AMapMovedAsAWholeCostsNoMoreButForThePrior) {
  const NoisyRoom room = MakeNoisyRoom();
  std::vector<double> moved = room.graph.poses();
  for (std::size_t i = 0; i < moved.size(); i += 3) {
    moved[i] += 0.05;
    moved[i + 1] -= 0.03;
  }
  const std::vector<double> energies = EnergiesOf(room.graph, {&room.graph.poses(), &moved});
  const PoseTerms terms(room.graph, FactorOptions());
  const double by_poses = terms.Cost(moved) - terms.Cost(room.graph.poses());
  EXPECT_GT(by_poses, 1e5);
  EXPECT_NEAR(energies[1] - energies[0], by_poses, 1e-6 * energies[0]);
}

}  // namespace
}  // namespace plumbline
