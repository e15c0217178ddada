#include "plumbline/solvers/full/round_energies.h"

#include "plumbline/core/fixed_poses.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/full/marginal_energy.h"

namespace plumbline {
namespace {

// Where the end of a round puts them: the callback sees a map that is still to be moved back to a
// single fixed pose.
std::vector<double> InPlace(const SlamGraph& graph, const std::vector<double>& poses) {
  MapState state{poses, {}};
  if (IsAtFixedPoses(graph, state)) return poses;
  PutAtFixedPoses(graph, &state);
  return state.poses;
}

}  // namespace

RoundEnergyMeter::RoundEnergyMeter(const SolverOptions& options, const SlamGraph& graph,
                                   const MeasuredSurface& surface, const MapState& given)
    : graph_(graph), surface_(surface), options_(options), moments_{{RoundEnergy(), given.poses}} {
  options_.callback = [this, report = options.callback](const IterationSummary& iteration) {
    if (iteration.poses != nullptr) {
      if (moments_.back().row.round != iteration.round) moments_.emplace_back();
      moments_.back() = {{iteration.round, iteration.iteration, iteration.total_time_s, 0.0},
                         *iteration.poses};
    }
    return !report || report(iteration);
  };
}

void RoundEnergyMeter::Measure(const MapState& result, SolverSummary* summary) const {
  SolverOptions options = options_;
  FactorOptions& factors = options.factors;
  for (const IgnoredEdge& edge : summary->ignored_edges) {
    factors.ignored_relative_poses.push_back(edge.edge);
  }
  factors.downweighted_steps.insert(factors.downweighted_steps.end(),
                                    summary->downweighted_steps.begin(),
                                    summary->downweighted_steps.end());
  ThreadPool pool(options.num_threads);
  const auto energy = [&](const std::vector<double>& poses) {
    return MarginalEnergy(graph_, poses, surface_, options, &pool);
  };
  if (options.MovesPosesOnly()) summary->final_marginal_energy = energy(result.poses);
  for (const Moment& moment : moments_) {
    const std::vector<double> poses = InPlace(graph_, moment.poses);
    summary->round_energies.push_back(moment.row);
    summary->round_energies.back().marginal_energy =
        poses == result.poses ? summary->final_marginal_energy : energy(poses);
  }
}

}  // namespace plumbline
