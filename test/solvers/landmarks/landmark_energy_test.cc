#include "plumbline/solvers/landmarks/landmark_energy.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/solvers/terms/pose_terms.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

// Under the landmarks that `poses` give.
std::vector<double> EnergiesOf(const SlamGraph& graph, const std::vector<double>& poses,
                               const std::vector<const std::vector<double>*>& states,
                               int num_threads = 2) {
  ThreadPool pool(num_threads);
  const MeasuredSurface surface = SurfaceOf(graph);
  const FactorOptions factors;
  return LandmarkEnergies(
      graph, factors,
      CutIntoLandmarks(graph, poses, surface, LandmarkOptionsFor(factors, AssociationOptions()),
                       &pool),
      {}, states, &pool);
}

TEST(LandmarkEnergyTest, TheTruthIsBetterThanADisturbedStateUnderTheLandmarksOfEither) {
  const NoisyRoom room = MakeNoisyRoom();
  for (const double sigma : {0.003, 0.01, 0.03}) {
    NoisyRoom disturbed = MakeNoisyRoom();
    DisturbPoses(sigma, disturbed.graph, &disturbed.state);
    const std::vector<double>& truth = room.state.poses;
    for (const std::vector<double>& poses : {truth, disturbed.state.poses}) {
      const std::vector<double> energies =
          EnergiesOf(room.graph, poses, {&truth, &disturbed.state.poses});
      EXPECT_LT(energies[0], energies[1]) << sigma;
    }
  }
}

TEST(LandmarkEnergyTest, StatesDoNotInfluenceEachOther) {
  const NoisyRoom room = MakeNoisyRoom();
  NoisyRoom disturbed = MakeNoisyRoom();
  DisturbPoses(0.02, disturbed.graph, &disturbed.state);
  const std::vector<double>& a = room.state.poses;
  const std::vector<double>& b = disturbed.state.poses;
  const std::vector<double> energies = EnergiesOf(room.graph, a, {&a, &b, &a}, 1);
  EXPECT_EQ(energies[0], energies[2]);
  EXPECT_EQ(EnergiesOf(room.graph, a, {&b}, 3)[0], energies[1]);
}

TEST(LandmarkEnergyTest, AMapMovedAsAWholeCostsNoMore) {
  const NoisyRoom room = MakeNoisyRoom();
  const std::vector<double>& poses = room.state.poses;
  std::vector<double> moved = poses;
  for (std::size_t i = 0; i < moved.size(); i += 3) {
    moved[i] += 0.05;
    moved[i + 1] -= 0.03;
  }
  const std::vector<double> energies = EnergiesOf(room.graph, poses, {&poses, &moved});
  EXPECT_NEAR(energies[1], energies[0], 1e-6 * energies[0]);
}

TEST(LandmarkEnergyTest, IsWhatTheReturnsCostAtTheLines) {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.02, room.graph, &room.state);
  const std::vector<double>& poses = room.state.poses;
  ThreadPool pool(2);
  const FactorOptions factors;
  const LineLandmarks cut = CutIntoLandmarks(room.graph, poses, SurfaceOf(room.graph),
                                             LandmarkOptionsFor(factors, {}), &pool);
  std::vector<std::vector<LineLandmark>> lines;
  const double energy = LandmarkEnergies(room.graph, factors, cut, {}, {&poses}, &pool, &lines)[0];
  ReturnCompressor compressor(room.graph, NoiseOf(factors), &pool);
  compressor.LayOut(cut.landmarks.size(), cut.landmark_of_return);
  const double cost = compressor.Cost(lines[0], FramesOf(poses),
                                      GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas));
  EXPECT_DOUBLE_EQ(energy, cost + PoseTerms(room.graph, factors).Cost(poses));
}

}  // namespace
}  // namespace plumbline
