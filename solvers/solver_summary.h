#ifndef PLUMBLINE_SOLVERS_SOLVER_SUMMARY_H_
#define PLUMBLINE_SOLVERS_SOLVER_SUMMARY_H_

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/solvers/energy.h"
#include "plumbline/solvers/point_recovery.h"

namespace plumbline {

enum class TerminationType {
  kFailure,        ///< The energy could not be evaluated; the graph is unchanged.
  kNoImprovement,  ///< The seed was the best state seen; the graph is unchanged.
  kUserStopped,    ///< The callback asked to stop; the graph holds the best state so far.
  kMaxIterations,  ///< The graph is better than the seed, and could still improve.
  kConverged,
};
const char* ToString(TerminationType type);

/// One iteration of any solver, in one format for all.
struct IterationSummary {
  int iteration = 0;  ///< counts through all rounds
  int round = 0;      ///< round of associations, from 1
  std::string phase;  ///< what moved: "map", "poses", "scans" or "joint"
  double cost = 0.0;
  double cost_change = 0.0;  ///< positive: the cost fell
  double gradient_max_norm = 0.0;
  double step_norm = 0.0;
  double step_size = 0.0;  ///< line searches: length along the direction
  double beta = 0.0;       ///< conjugate gradients: share of the previous direction
  double trust_region_ratio = 0.0;
  double trust_region_radius = 0.0;
  int evaluations = 0;  ///< of the cost, or iterations of the linear solver
  double iteration_time_s = 0.0;
  double total_time_s = 0.0;
};

/// The heading for ProgressRow().
std::string ProgressHeader();
std::string ProgressRow(const IterationSummary& iteration);

/// One outer round: associations rebuilt, then an inner solve with them fixed.
struct RoundSummary {
  double radius_m = 0.0;     ///< smallest neighbourhood
  double gate_sigmas = 0.0;  ///< robust gate of the map terms
  std::size_t num_lines = 0;
  std::size_t num_shape_pairs = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;       ///< of the same associations
  double marginal_energy = 0.0;  ///< of the poses after this round, comparable between rounds
  bool kept = false;             ///< false: it did not lower the marginal energy and was undone
  int iterations = 0;
  std::string stop_reason;
};

/// One round of the reduced solver: surfaces cut into patches anew, then Gauss-Newton steps.
struct PatchRoundSummary {
  double gate_sigmas = 0.0;       ///< robust gate of the manifold term
  std::size_t num_patches = 0;    ///< pieces of surface, one line each
  std::size_t num_sightings = 0;  ///< pairs of a pose and a patch that it saw
  double initial_cost = 0.0;      ///< of poses and lines, points eliminated, weights fixed
  double final_cost = 0.0;        ///< the same; weights of the last step
  /// Root mean square of how far returns moved across their surfaces, relative to those of the pose
  /// before, in standard deviations of a return.
  double moved_sigmas = 0.0;
  int steps = 0;
};

/// Sizes, costs and residuals of one term.
struct TermSummary {
  std::size_t count = 0;  ///< residual blocks
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int residuals_per_block = 0;
  double sigma = 0.0;  ///< of one residual, in `unit`; 0 where the residuals have several units
  std::string unit;

  /// Root mean square of the whitened residuals at the end; 0 without any.
  double WhitenedRms() const;
};

struct SolverSummary {
  TerminationType termination = TerminationType::kFailure;
  std::string message = "Solve was not called";
  std::string solver;

  std::size_t num_poses = 0;
  std::size_t num_points = 0;
  std::vector<RoundSummary> rounds;
  std::vector<PatchRoundSummary> patch_rounds;  ///< reduced solver: instead of rounds
  std::vector<IterationSummary> iterations;

  /// Terms of the last associations: at the state that the last round started from (reduced solver:
  /// at the seed), and at the end.
  std::array<TermSummary, kNumTerms> terms;

  /// How well the poses explain the map: energy with every point eliminated, each state under
  /// associations of its own, which makes states of different rounds comparable. See
  /// marginal_energy.h.
  double seed_marginal_energy = 0.0;
  double final_marginal_energy = 0.0;

  /// Solvers that move the poses only: how many relative poses they went by, and the sum of their
  /// squared whitened errors. They have neither rounds nor terms nor marginal energies.
  std::size_t num_relative_poses = 0;
  double seed_chi2 = 0.0;
  double final_chi2 = 0.0;

  /// Reduced solver: what decides whether the result is better than the seed, see PatchEnergies.
  double seed_patch_energy = 0.0;
  double final_patch_energy = 0.0;

  /// How far the points are from the measured ends of their beams.
  PointDisplacements displacements;

  double association_time_s = 0.0;
  double setup_time_s = 0.0;  ///< building problems
  double solve_time_s = 0.0;
  double total_time_s = 0.0;

  /// True if the graph holds a state at least as good as the one given.
  bool IsSolutionUsable() const { return termination != TerminationType::kFailure; }
  std::string BriefReport() const;
  std::string RoundTable() const;
  std::string FullReport() const;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SOLVER_SUMMARY_H_
