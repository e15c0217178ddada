#include "plumbline/solvers/acceptance/compare_with_seed.h"

#include <cmath>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/association/held_out_returns.h"
#include "plumbline/solvers/landmarks/landmark_energy.h"
#include "plumbline/solvers/landmarks/return_residual.h"

namespace plumbline {
namespace {

class SeedComparison {
 public:
  SeedComparison(const SlamGraph& graph, const MeasuredSurface& surface,
                 const FactorOptions& factors, ThreadPool* pool)
      : graph_(graph),
        surface_(surface),
        factors_(factors),
        noise_(NoiseOf(factors)),
        loss_(GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas)),
        pool_(pool),
        first_of_scan_(graph.num_scans()) {
    std::size_t num_held_out = 0;
    for (int s = 0; s < graph.num_scans(); ++s) {
      first_of_scan_[s] = num_held_out;
      num_held_out += HeldOutReturns::CountOf(graph, s);
    }
    held_out_.resize(num_held_out);
  }

  // Adds the energies of both states and the errors of their held-out returns under these
  // landmarks.
  void AddSurfaces(const LineLandmarks& cut, const std::vector<double>& seed,
                   const std::vector<double>& state) {
    std::vector<std::vector<LineLandmark>> lines;
    const std::vector<double> energies =
        LandmarkEnergies(graph_, factors_, cut, {true, &surface_}, {&seed, &state}, pool_, &lines);
    seed_energy_ += energies[0];
    state_energy_ += energies[1];
    ++num_cuts_;
    AddErrors(cut.landmark_of_return, lines, seed, state);
  }

  AcceptanceTest Result() const {
    AcceptanceTest acceptance;
    acceptance.with_other_constraints =
        !graph_.relative_poses().empty() || !graph_.factors().empty();
    acceptance.seed_energy = seed_energy_ / num_cuts_;
    acceptance.final_energy = state_energy_ / num_cuts_;
    const Peers* peers = graph_.peers();
    const double num_returns = SumOverPeers(peers, static_cast<double>(graph_.num_returns()));
    acceptance.energy_rounding = AcceptanceTest::kRounding * (acceptance.seed_energy + num_returns);
    PoseChange sum;
    double num_held_out = 0.0;
    for (const PoseChange& held_out : held_out_) {
      if (held_out.num_residuals > 0) ++num_held_out;
      sum += held_out;
    }
    const double num_residuals = SumOverPeers(peers, static_cast<double>(sum.num_residuals));
    acceptance.num_held_out = static_cast<std::size_t>(SumOverPeers(peers, num_held_out));
    acceptance.seed_held_out_error = SumOverPeers(peers, sum.seed_error);
    acceptance.final_held_out_error = SumOverPeers(peers, sum.state_error);
    if (acceptance.num_held_out == 0) return acceptance;
    const double change =
        (acceptance.final_held_out_error - acceptance.seed_held_out_error) / num_residuals;
    double squares = 0.0;
    for (const PoseChange& held_out : held_out_) {
      const double expected = held_out.num_residuals * change;
      squares += std::pow(held_out.state_error - held_out.seed_error - expected, 2);
    }
    acceptance.seed_held_out_error /= num_residuals;
    acceptance.final_held_out_error /= num_residuals;
    acceptance.held_out_noise = std::sqrt(SumOverPeers(peers, squares)) / num_residuals;
    return acceptance;
  }

  std::vector<PoseChange> ChangesOfPoses() const {
    std::vector<PoseChange> changes(graph_.num_poses());
    for (int s = 0; s < graph_.num_scans(); ++s) {
      PoseChange& change = changes[graph_.scan(s).pose];
      for (std::size_t i = 0; i < HeldOutReturns::CountOf(graph_, s); ++i) {
        PoseChange held_out = held_out_[first_of_scan_[s] + i];
        held_out.squares = std::pow(held_out.state_error - held_out.seed_error, 2);
        change += held_out;
      }
    }
    if (graph_.peers() == nullptr) return changes;
    std::vector<std::pair<int, PoseChange>> own;  // all returns of a pose are in one process
    for (int s = 0; s < graph_.num_scans(); ++s) {
      const int pose = graph_.scan(s).pose;
      own.emplace_back(pose, changes[pose]);
    }
    for (const auto& [pose, change] : JoinOverPeers(graph_.peers(), std::move(own))) {
      changes[pose] = change;
    }
    return changes;
  }

 private:
  // lines: of the landmarks, at the seed and at the state.
  void AddErrors(const std::vector<int>& landmark_of_return,
                 const std::vector<std::vector<LineLandmark>>& lines,
                 const std::vector<double>& seed, const std::vector<double>& state) {
    constexpr std::size_t kScansPerChunk = 16;
    pool_->ForEach(graph_.num_scans(), kScansPerChunk, [&](std::size_t s) {
      const int scan = static_cast<int>(s), pose = graph_.scan(scan).pose;
      AddErrorsOfScan(scan, landmark_of_return, {PoseFrame(&seed[3 * pose]), lines[0]},
                      {PoseFrame(&state[3 * pose]), lines[1]});
    });
  }

  // Where a state has a robot and the lines.
  struct Placed {
    PoseFrame frame;
    const std::vector<LineLandmark>& lines;
  };

  void AddErrorsOfScan(int scan_id, const std::vector<int>& landmark_of_return, const Placed& seed,
                       const Placed& state) {
    const ScanReturns returns = graph_.ReturnsOfScan(scan_id);
    PoseChange* held_out = held_out_.data() + first_of_scan_[scan_id];
    HeldOutReturns::ForEachOf(graph_, scan_id, [&](std::size_t r) {
      PoseChange& of_return = *held_out++;
      const int landmark = landmark_of_return[r];
      if (landmark == LineLandmarks::kNone || surface_.normals[r].IsNone()) return;
      ++of_return.num_residuals;
      of_return.seed_error += Error(returns, r, seed.frame, seed.lines[landmark]);
      of_return.state_error += Error(returns, r, state.frame, state.lines[landmark]);
    });
  }

  double Error(const ScanReturns& returns, std::size_t r, const PoseFrame& frame,
               const LineLandmark& landmark) const {
    const ReturnResidual residual(returns, r, LineInRobot(landmark, frame), noise_);
    return loss_.Rho(residual.distance * residual.distance / residual.variance);
  }

  const SlamGraph& graph_;
  const MeasuredSurface& surface_;
  const FactorOptions& factors_;
  const SurfaceNoise noise_;
  const GemanMcClure loss_;
  ThreadPool* pool_;
  int num_cuts_ = 0;
  double seed_energy_ = 0.0, state_energy_ = 0.0;
  std::vector<std::size_t> first_of_scan_;  // into held_out_
  std::vector<PoseChange> held_out_;        // one per held-out return, in order of scans
};

}  // namespace

AcceptanceTest CompareWithSeed(const SlamGraph& graph, const MeasuredSurface& surface,
                               const FactorOptions& factors, const ComparedState& seed,
                               const ComparedState& state, ThreadPool* pool,
                               std::vector<PoseChange>* changes) {
  SeedComparison comparison(graph, surface, factors, pool);
  comparison.AddSurfaces(seed.landmarks, seed.poses, state.poses);
  comparison.AddSurfaces(state.landmarks, seed.poses, state.poses);
  if (changes != nullptr) *changes = comparison.ChangesOfPoses();
  return comparison.Result();
}

}  // namespace plumbline
