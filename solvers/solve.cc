#include "plumbline/solvers/solve.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <utility>

#include "plumbline/solvers/alternating_cg.h"
#include "plumbline/solvers/ceres_solver.h"
#include "plumbline/solvers/energy.h"
#include "plumbline/solvers/marginal_energy.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool AllFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// Position of a round between first (0) and last (1).
double Progress(const RoundOptions& rounds, int round) {
  return rounds.num_rounds > 1 ? static_cast<double>(round) / (rounds.num_rounds - 1) : 1.0;
}

class JointSolver {
 public:
  JointSolver(const SolverOptions& options, SlamGraph* graph)
      : options_(options), graph_(graph), pool_(options.num_threads) {
    summary_.solver = ToString(options.type);
    summary_.num_poses = graph->num_poses();
    summary_.num_points = graph->num_returns();
    DescribeTerms();
  }

  SolverSummary Run() {
    normals_ = EstimateReturnNormals(*graph_, NormalOptionsFor(options_.factors.beam), &pool_);
    best_poses_ = graph_->poses();
    best_points_ = graph_->points();
    summary_.seed_marginal_energy = best_energy_ = CurrentMarginalEnergy();
    InnerResult inner;
    for (int round = 0; round < options_.rounds.num_rounds && !inner.stopped; ++round) {
      inner = RunRound(round);
      if (!inner.usable) {
        summary_.message = "round " + std::to_string(round + 1) + ": " + inner.stop_reason;
        break;
      }
      KeepIfBest();
    }
    graph_->poses() = best_poses_;
    graph_->points() = best_points_;
    Conclude(inner);
    return std::move(summary_);
  }

 private:
  double CurrentMarginalEnergy() {
    return MarginalEnergy(graph_->poses(), normals_, options_.factors, options_.association,
                          options_.rounds.last_radius_m, &pool_, graph_);
  }

  void KeepIfBest() {
    const double energy = CurrentMarginalEnergy();
    summary_.rounds.back().marginal_energy = energy;
    if (!(energy < best_energy_)) return;
    best_energy_ = energy;
    best_round_ = static_cast<int>(summary_.rounds.size());
    best_poses_ = graph_->poses();
    best_points_ = graph_->points();
  }

  InnerResult RunRound(int round) {
    const double progress = Progress(options_.rounds, round);
    RoundSummary row;
    row.radius_m =
        options_.rounds.first_radius_m *
        std::pow(options_.rounds.last_radius_m / options_.rounds.first_radius_m, progress);
    FactorOptions factors = options_.factors;
    const double gate_factor = std::pow(options_.rounds.first_gate_factor, 1.0 - progress);
    factors.manifold.robust_gate_sigmas *= gate_factor;
    factors.shape.robust_gate_sigmas *= gate_factor;
    row.gate_sigmas = factors.manifold.robust_gate_sigmas;

    auto start = Clock::now();
    const Associations associations =
        BuildAssociations(*graph_, normals_, options_.association, row.radius_m, &pool_);
    summary_.association_time_s += SecondsSince(start);
    row.num_lines = associations.CountLines();
    row.num_shape_pairs = associations.shape_pairs.size();

    start = Clock::now();
    const Energy energy(*graph_, associations, factors, &pool_);
    RecordTerms(energy, &TermSummary::initial_cost);
    const InnerResult inner = SolveInner(energy, associations, factors, round);
    RecordTerms(energy, &TermSummary::final_cost);
    summary_.setup_time_s += inner.setup_time_s;
    summary_.solve_time_s += SecondsSince(start) - inner.setup_time_s;
    row.initial_cost = inner.initial_cost;
    row.final_cost = inner.final_cost;
    row.iterations = inner.iterations;
    row.stop_reason = inner.stop_reason;
    summary_.rounds.push_back(row);
    return inner;
  }

  InnerResult SolveInner(const Energy& energy, const Associations& associations,
                         const FactorOptions& factors, int round) {
    const ProgressCallback report = [this, round](const IterationSummary& from) {
      IterationSummary iteration = from;
      iteration.iteration = static_cast<int>(summary_.iterations.size()) + 1;
      iteration.round = round + 1;
      iteration.total_time_s = SecondsSince(start_);
      summary_.iterations.push_back(iteration);
      return !options_.callback || options_.callback(iteration);
    };
    switch (options_.type) {
      case SolverType::kAlternatingCg:
        return SolveByAlternatingCg(energy, options_.alternating_cg, report, graph_);
      case SolverType::kCeres:
        return SolveWithCeres(associations, factors, options_.ceres, options_.num_threads, report,
                              graph_);
    }
    return InnerResult();
  }

  void RecordTerms(const Energy& energy, double TermSummary::*cost) {
    TermCosts costs;
    if (!energy.Evaluate(graph_->poses(), graph_->points(), &costs)) return;
    const auto counts = energy.CountTerms();
    for (int t = 0; t < kNumTerms; ++t) {
      summary_.terms[t].count = counts[t];
      summary_.terms[t].*cost = costs.cost[t];
    }
  }

  // Sizes and units that turn the costs of the terms into errors in metres and radians.
  void DescribeTerms() {
    constexpr int kResiduals[kNumTerms] = {3, 3, 3, 2, 1, 2};
    for (int t = 0; t < kNumTerms; ++t) summary_.terms[t].residuals_per_block = kResiduals[t];
    const auto describe = [this](Term term, double sigma, const char* unit) {
      summary_.terms[static_cast<int>(term)].sigma = sigma;
      summary_.terms[static_cast<int>(term)].unit = unit;
    };
    describe(Term::kRangeBeam, options_.factors.beam.sigma_range_m, "m (as range)");
    describe(Term::kManifold, options_.factors.manifold.sigma_m, "m (robust)");
    describe(Term::kShape, options_.factors.shape.sigma_rad, "rad (robust)");
  }

  void Conclude(const InnerResult& last) {
    summary_.final_marginal_energy = best_energy_;
    summary_.total_time_s = SecondsSince(start_);
    std::ostringstream message;
    message << "marginal energy " << summary_.seed_marginal_energy << " -> " << best_energy_;
    if (!last.usable) return;
    if (best_round_ == 0) {
      summary_.termination = TerminationType::kNoImprovement;
      message << ": no round improved on the seed, which is returned as it was";
    } else {
      summary_.termination = last.stopped     ? TerminationType::kUserStopped
                             : last.converged ? TerminationType::kConverged
                                              : TerminationType::kMaxIterations;
      message << ", best in round " << best_round_ << " of " << summary_.rounds.size()
              << "; last round: " << last.stop_reason;
    }
    summary_.message = message.str();
  }

  const SolverOptions& options_;
  SlamGraph* graph_;
  ThreadPool pool_;
  const Clock::time_point start_ = Clock::now();
  std::vector<Eigen::Vector2f> normals_;
  SolverSummary summary_;
  double best_energy_ = 0.0;
  int best_round_ = 0;  // 0: the seed
  std::vector<double> best_poses_;
  std::vector<double> best_points_;
};

}  // namespace

ReturnNormalOptions NormalOptionsFor(const RangeBeamOptions& beam) {
  ReturnNormalOptions options;
  options.half_window_m = std::max(0.06, 6.0 * beam.sigma_range_m);
  return options;
}

SolverSummary Solve(const SolverOptions& options, SlamGraph* graph) {
  SolverSummary failure;
  failure.solver = ToString(options.type);
  if (!options.Check(&failure.message)) return failure;
  if (options.type == SolverType::kCeres) {
    const Status status = CheckCeresOptions(options.ceres);
    if (!status.ok()) {
      failure.message = status.message();
      return failure;
    }
  }
  if (!AllFinite(graph->poses()) || !AllFinite(graph->points())) {
    failure.message = "the graph's poses or points are not all finite";
    return failure;
  }
  if (graph->num_returns() == 0) {
    failure.message = "the graph has no laser returns: nothing to build a map of";
    return failure;
  }
  return JointSolver(options, graph).Run();
}

}  // namespace plumbline
