#include "plumbline/solvers/landmarks/landmark_energy.h"

#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/terms/own_terms.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

void SettleLines(const ReturnCompressor& compressor, const std::vector<PoseFrame>& frames,
                 double gate_sigmas, ThreadPool* pool, LineObservations* observations,
                 std::vector<LineLandmark>* landmarks) {
  // The lines at hand may be those of other poses: all returns pull at first, and then those near
  // the lines.
  for (const double gate : {1e3, gate_sigmas}) {
    compressor.Weigh(*landmarks, frames, GemanMcClure::FromGate(gate), observations);
    FitLandmarkLines(*observations, frames, pool, landmarks);
  }
}

std::vector<double> LandmarkEnergies(const SlamGraph& graph, const FactorOptions& factors,
                                     LineLandmarks cut,
                                     const std::vector<const std::vector<double>*>& states,
                                     ThreadPool* pool,
                                     std::vector<std::vector<LineLandmark>>* lines) {
  ReturnCompressor compressor(graph, NoiseOf(factors), pool);
  LineObservations observations = compressor.LayOut(
      cut.landmarks.size(), std::move(cut.landmark_of_return), std::move(cut.shared));
  const PoseTerms terms(graph, factors);
  const double gate_sigmas = factors.manifold.robust_gate_sigmas;
  std::vector<double> energies;
  for (const std::vector<double>* poses : states) {
    const std::vector<PoseFrame> frames = FramesOf(*poses);
    std::vector<LineLandmark> landmarks = cut.landmarks;
    SettleLines(compressor, frames, gate_sigmas, pool, &observations, &landmarks);
    const GemanMcClure loss = GemanMcClure::FromGate(gate_sigmas);
    const double cost =
        SumOverPeers(graph.peers(), compressor.Cost(landmarks, frames, loss, observations));
    energies.push_back(cost + terms.Cost(*poses) + OwnPointCost(factors, graph, *poses));
    if (lines != nullptr) lines->push_back(std::move(landmarks));
  }
  return energies;
}

}  // namespace plumbline
