#ifndef PLUMBLINE_SOLVERS_FULL_ROUND_ENERGIES_H_
#define PLUMBLINE_SOLVERS_FULL_ROUND_ENERGIES_H_

#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

/// Fills in SolverSummary::round_energies for any solver. It keeps the poses that the callback is
/// shown last in each round, and measures their marginal energies once the solve is done.
class RoundEnergyMeter {
 public:
  /// Keeps references to the graph and its surface.
  RoundEnergyMeter(const SolverOptions& options, const SlamGraph& graph,
                   const MeasuredSurface& surface, const MapState& given);
  RoundEnergyMeter(const RoundEnergyMeter&) = delete;
  RoundEnergyMeter& operator=(const RoundEnergyMeter&) = delete;

  /// What to solve with: the given options, with a callback that keeps poses as well.
  const SolverOptions& options() const { return options_; }

  /// Adds the energies to the summary of that solve. All are measured without the relative poses
  /// that it ignored, and with the odometry steps downweighted that it downweighted. A solver that
  /// moves poses only gets its final_marginal_energy here. result: what the solve came to.
  void Measure(const MapState& result, SolverSummary* summary) const;

 private:
  struct Moment {
    RoundEnergy row;
    std::vector<double> poses;
  };

  const SlamGraph& graph_;
  const MeasuredSurface& surface_;
  SolverOptions options_;
  std::vector<Moment> moments_;  // the given state, and the last one of each round so far
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_ROUND_ENERGIES_H_
