#ifndef PLUMBLINE_SOLVERS_INTERFACE_SOLVER_SUMMARY_H_
#define PLUMBLINE_SOLVERS_INTERFACE_SOLVER_SUMMARY_H_

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/acceptance.h"

namespace plumbline {

/// How a solve ended. What is said of the state compared with the seed does not hold for
/// kPublished, which returns what it comes to.
enum class TerminationType {
  /// Bad input, an energy that cannot be evaluated, or an exception (memory, a callback): the state
  /// is unchanged.
  kFailure,
  kNoImprovement,  ///< The seed was the best state seen; it is returned as it was.
  kUserStopped,    ///< The callback asked to stop; the state is the best so far.
  kMaxIterations,  ///< The state is better than the seed, and could still improve.
  kConverged,      ///< The state is better than the seed, and more rounds would hardly help.
};
/// A word or two for reports.
const char* ToString(TerminationType type);

/// One iteration of any solver, in one format for all.
struct IterationSummary {
  int iteration = 0;         ///< counts through all rounds
  int round = 0;             ///< round of associations, from 1
  std::string phase;         ///< what moved: "map", "poses", "joint", or "sensors" (calibration)
  double cost = 0.0;         ///< after it
  double cost_change = 0.0;  ///< positive: the cost fell
  double gradient_max_norm = 0.0;    ///< largest absolute component before it
  double step_norm = 0.0;            ///< length of the step in all parameters [m and rad]
  double step_size = 0.0;            ///< line searches: length along the direction
  double beta = 0.0;                 ///< conjugate gradients: share of the previous direction
  double trust_region_ratio = 0.0;   ///< Ceres: actual over expected decrease
  double trust_region_radius = 0.0;  ///< Ceres: inverse of the damping
  int evaluations = 0;               ///< of the cost, or iterations of the linear solver
  double iteration_time_s = 0.0;     ///< of this iteration
  double total_time_s = 0.0;         ///< since the solver was called
  /// The poses after it, (x, y, yaw) each, while a callback is called; null elsewhere, and in phase
  /// "sensors". Solvers in rounds may show a single fixed pose a little off its place: they move
  /// the map back as a whole at the end of a round.
  const std::vector<double>* poses = nullptr;
};

/// The heading for ProgressRow().
std::string ProgressHeader();
/// One line of text, without a line end.
std::string ProgressRow(const IterationSummary& iteration);

/// One outer round: associations rebuilt, then an inner solve with them fixed.
struct RoundSummary {
  double radius_m = 0.0;            ///< smallest neighbourhood
  double gate_sigmas = 0.0;         ///< robust gate of the map terms; infinite: Gaussian
  std::size_t num_lines = 0;        ///< returns with a tangent line
  std::size_t num_shape_pairs = 0;  ///< terms of the shape potential
  double initial_cost = 0.0;        ///< of the joint energy
  double final_cost = 0.0;          ///< of the same associations
  /// Of the poses after this round, comparable between rounds. 0: not measured (kPublished, but for
  /// the last pass).
  double marginal_energy = 0.0;
  bool kept = false;        ///< false: it did not lower the marginal energy and was undone
  int iterations = 0;       ///< of the inner solve
  std::string stop_reason;  ///< of the inner solve
};

/// One round of the reduced solver: surfaces cut into landmarks anew, then Gauss-Newton steps.
struct LandmarkRoundSummary {
  double gate_sigmas = 0.0;          ///< robust gate of the manifold term
  std::size_t num_landmarks = 0;     ///< pieces of surface, one line each
  std::size_t num_observations = 0;  ///< pairs of a pose and a landmark that it saw
  double initial_cost = 0.0;         ///< of poses and lines, points eliminated, weights fixed
  double final_cost = 0.0;           ///< the same, after the step
  /// Root mean square of how far returns moved across their surfaces, relative to those of the pose
  /// before, in standard deviations of a return.
  double moved_sigmas = 0.0;
};

/// How well the poses explain the scans at one moment of a solve.
struct RoundEnergy {
  int round = 0;                 ///< that has just ended; 0: the given state
  int iteration = 0;             ///< the last one of the round
  double total_time_s = 0.0;     ///< since the solver was called
  double marginal_energy = 0.0;  ///< of poses and surfaces, with the points eliminated
};

/// Sizes, costs and residuals of one term.
struct TermSummary {
  std::string name;             ///< "motion", "range beam", ..., or that of custom factors
  std::size_t count = 0;        ///< residual blocks
  double initial_cost = 0.0;    ///< one half of the squared whitened residuals, robust
  double final_cost = 0.0;      ///< the same at the end
  int residuals_per_block = 0;  ///< scalars
  double sigma = 0.0;  ///< of one residual, in `unit`; 0 where the residuals have several units
  std::string unit;    ///< for reports

  /// Root mean square of the whitened residuals at the end; 0 without any.
  double WhitenedRms() const;
};

/// How far points were moved from the measured ends of their beams.
struct PointDisplacements {
  double mean_m = 0.0;  ///< over all points, those without a line included
  double max_m = 0.0;   ///< the largest of all points
  /// Largest length in standard deviations of the point's own beam, sqrt(u^T C^-1 u).
  double max_beam_sigmas = 0.0;

  /// Points per bin of that length, each kSigmasPerBin wide; the last one has no upper end.
  static constexpr double kSigmasPerBin = 0.25;
  static constexpr int kNumSigmaBins = 17;                ///< number of bins
  std::array<std::size_t, kNumSigmaBins> sigma_counts{};  ///< points per bin

  /// Points per bin of distance: below kFirstOctaveM, then up to twice that and so on, so that the
  /// bins suit any sensor; the last one has no upper end.
  static constexpr double kFirstOctaveM = 0.25e-3;
  static constexpr int kNumOctaves = 12;                 ///< number of bins
  std::array<std::size_t, kNumOctaves> octave_counts{};  ///< points per bin
};

/// What a solve did, and what came of it.
struct SolverSummary {
  TerminationType termination = TerminationType::kFailure;  ///< how it ended
  std::string message = "Solve was not called";             ///< why, with the numbers
  std::string solver;                                       ///< its name

  std::size_t num_poses = 0;                          ///< of the graph
  std::size_t num_points = 0;                         ///< of the graph
  std::vector<RoundSummary> rounds;                   ///< in order
  std::vector<LandmarkRoundSummary> landmark_rounds;  ///< reduced solver: instead of rounds
  std::vector<IterationSummary> iterations;           ///< of all rounds, as the callback saw them

  /// Terms of the last associations: at the state that the last round started from (reduced solver:
  /// at the seed), and at the end.
  std::vector<TermSummary> terms;

  /// How well the resulting poses explain the map: energy with every point eliminated, under the
  /// tangent lines that these poses give, which makes results of different solvers comparable.
  /// See marginal_energy.h.
  double final_marginal_energy = 0.0;

  /// With SolverOptions::measure_rounds: the same energy of the given state and after every round,
  /// undone ones included. One measure for all rounds and solvers, where costs compare only under
  /// the associations of one round.
  std::vector<RoundEnergy> round_energies;

  /// Solvers that move the poses only: how many relative poses they went by, and the sum of their
  /// squared whitened errors. They have neither rounds nor terms, and marginal energies only if
  /// these are asked for; all their iterations count as one round.
  std::size_t num_relative_poses = 0;
  double seed_chi2 = 0.0;   ///< of the poses given
  double final_chi2 = 0.0;  ///< of the result

  /// The given poses contradicted odometry and relative poses, and the solver started from where
  /// these put the poses; see constraint_start.h.
  bool started_from_constraints = false;

  /// What decides whether the result is better than the seed. Of the poses found without the
  /// held-out returns, also if they were refused.
  AcceptanceTest acceptance;

  /// Stretches of the drive that the solver had made clearly worse, put back to the seed's shape
  /// between their neighbours; with the errors before that. See acceptance/candidate.h.
  std::vector<WorseStretch> put_back;

  /// Steps of the odometry that the seed flatly contradicts and that tore poses from the map, or
  /// that what the solver found contradicted, too: it began again with these downweighted, see
  /// contradicted_steps.h.
  std::vector<DownweightedStep> downweighted_steps;

  /// Relative poses that their own scans contradict: they did not count, see contradicted_edges.h.
  /// In order of the edges.
  std::vector<IgnoredEdge> ignored_edges;

  /// How far the points are from the measured ends of their beams.
  PointDisplacements displacements;

  double association_time_s = 0.0;  ///< finding lines and landmarks, testing relative poses
  double setup_time_s = 0.0;        ///< building problems
  double solve_time_s = 0.0;        ///< minimising
  double total_time_s = 0.0;        ///< all of it

  /// True if the state is at least as good as the one given.
  bool IsSolutionUsable() const { return termination != TerminationType::kFailure; }
  /// The ignored edges that the result is farthest off, in standard deviations; at most so many.
  std::vector<IgnoredEdge> FarthestIgnoredEdges(std::size_t max_number) const;
  std::string BriefReport() const;  ///< one line
  std::string RoundTable() const;   ///< a row per round
  /// A line per stretch put back and per downweighted step, and the worst of the ignored edges.
  std::string LocalReport() const;
  std::string FullReport() const;  ///< terms, rounds, times, and why it stopped
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_SOLVER_SUMMARY_H_
