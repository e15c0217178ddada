#include "plumbline/solvers/landmarks/landmark_energy.h"

#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

void SettleLines(const ReturnCompressor& compressor, const std::vector<PoseFrame>& frames,
                 double gate_sigmas, ThreadPool* pool, LineObservations* observations,
                 std::vector<LineLandmark>* landmarks) {
  // The lines at hand may be those of other poses: all returns pull at first, and then those near
  // the lines.
  compressor.WeighEqually(observations);
  FitLandmarkLines(*observations, frames, pool, landmarks);
  compressor.Weigh(*landmarks, frames, GemanMcClure::FromGate(gate_sigmas), observations);
  FitLandmarkLines(*observations, frames, pool, landmarks);
}

std::vector<double> LandmarkEnergies(const SlamGraph& graph, const FactorOptions& factors,
                                     const LineLandmarks& cut, const ReturnSelection& selection,
                                     const std::vector<const std::vector<double>*>& states,
                                     ThreadPool* pool,
                                     std::vector<std::vector<LineLandmark>>* lines) {
  ReturnCompressor compressor(graph, NoiseOf(factors), pool);
  LineObservations observations =
      compressor.LayOut(cut.landmarks.size(), cut.landmark_of_return, cut.shared, selection);
  std::vector<std::vector<LineLandmark>> lines_of_state(states.size(), cut.landmarks);
  std::vector<std::vector<PoseFrame>> frames_of_state;
  // As SettleLines does, but returns weigh the same in all states at first.
  compressor.WeighEqually(&observations);
  for (std::size_t i = 0; i < states.size(); ++i) {
    frames_of_state.push_back(FramesOf(*states[i]));
    FitLandmarkLines(observations, frames_of_state[i], pool, &lines_of_state[i]);
  }
  const PoseTerms terms(graph, factors);
  const GemanMcClure loss = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
  std::vector<double> energies;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const std::vector<PoseFrame>& frames = frames_of_state[i];
    compressor.Weigh(lines_of_state[i], frames, loss, &observations);
    FitLandmarkLines(observations, frames, pool, &lines_of_state[i]);
    const double cost =
        SumOverPeers(graph.peers(), compressor.Cost(lines_of_state[i], frames, loss));
    energies.push_back(cost + terms.Cost(*states[i]) + FactorPointCost(graph, *states[i]));
  }
  if (lines != nullptr) *lines = std::move(lines_of_state);
  return energies;
}

}  // namespace plumbline
