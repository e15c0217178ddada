#include "plumbline/solvers/full/alternating_cg.h"

#include <chrono>
#include <sstream>
#include <vector>

#include "plumbline/solvers/full/block_jacobi.h"
#include "plumbline/solvers/full/nonlinear_cg.h"
#include "plumbline/solvers/full/rounds_solver.h"
#include "plumbline/solvers/full/scan_objective.h"
#include "plumbline/solvers/interface/built_in_solvers.h"

namespace plumbline {
namespace {

// The energy as a function of the points (N = 2) at fixed poses, or of the poses (N = 3) at fixed
// points.
template <int N>
class PartialObjective final : public CgObjective {
 public:
  PartialObjective(const Energy& energy, const std::vector<double>& fixed)
      : energy_(energy), fixed_(fixed) {}

  bool Start(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override {
    TermCosts costs;
    std::vector<double> blocks;
    const auto fixed = [](const Term& term) { return !Moves(term); };
    if (!energy_.Evaluate(Poses(x), Points(x), &costs, {}, fixed)) return false;
    fixed_cost_ = costs.Total();
    if (!Evaluate(x, cost, gradient, &blocks)) return false;
    preconditioner_.Set(blocks, energy_.pool());
    return true;
  }
  bool Evaluate(const std::vector<double>& x, double* cost,
                std::vector<double>* gradient) override {
    return Evaluate(x, cost, gradient, nullptr);
  }
  double Curvature(const std::vector<double>& x, const std::vector<double>& d) override {
    return energy_.Curvature(Poses(x), Points(x), kPoints ? nullptr : &d, kPoints ? &d : nullptr,
                             Moves);
  }
  void Precondition(const std::vector<double>& gradient, std::vector<double>* result) override {
    preconditioner_.Apply(gradient, energy_.pool(), result);
  }

 private:
  static constexpr bool kPoints = N == 2;

  // Whether a term depends on what moves.
  static bool Moves(const Term& term) { return kPoints ? term.SeesPoints() : term.SeesPoses(); }
  const std::vector<double>& Poses(const std::vector<double>& x) const {
    return kPoints ? fixed_ : x;
  }
  const std::vector<double>& Points(const std::vector<double>& x) const {
    return kPoints ? x : fixed_;
  }
  bool Evaluate(const std::vector<double>& x, double* cost, std::vector<double>* gradient,
                std::vector<double>* blocks) const {
    TermCosts costs;
    EnergyDerivatives derivatives;
    (kPoints ? derivatives.point_gradient : derivatives.pose_gradient) = gradient;
    (kPoints ? derivatives.point_blocks : derivatives.pose_blocks) = blocks;
    const bool ok = energy_.Evaluate(Poses(x), Points(x), &costs, derivatives, Moves);
    *cost = fixed_cost_ + costs.Total();
    return ok;
  }

  const Energy& energy_;
  const std::vector<double>& fixed_;
  double fixed_cost_ = 0.0;
  BlockJacobi<N> preconditioner_;
};

class Alternation {
 public:
  Alternation(const Energy& energy, const AlternatingCgOptions& options,
              const ProgressCallback& report, MapState* state)
      : energy_(energy),
        options_(options),
        report_(report),
        state_(state),
        map_(energy, state->poses),
        poses_(energy, state->points),
        scans_(energy) {}

  InnerResult Run(double initial_cost) {
    result_.usable = true;
    result_.initial_cost = result_.final_cost = initial_cost;
    std::ostringstream reason;
    for (int sweep = 0; sweep < options_.max_sweeps; ++sweep) {
      const double before = result_.final_cost;
      Sweep();
      if (result_.stopped) {
        result_.stop_reason = "stopped by the callback";
        return result_;
      }
      const double change = before - result_.final_cost;
      if (change <= options_.relative_cost_tolerance * before) {
        reason << "a sweep lowered the cost of " << before << " by " << change
               << ", a fraction <= " << options_.relative_cost_tolerance;
        result_.converged = true;
        result_.stop_reason = reason.str();
        return result_;
      }
    }
    reason << "max_sweeps = " << options_.max_sweeps << " reached";
    result_.stop_reason = reason.str();
    return result_;
  }

 private:
  void Sweep() {
    Phase("map", options_.map_iterations_per_sweep, &map_, &state_->points);
    if (result_.stopped) return;
    Phase("poses", options_.pose_iterations_per_sweep, &poses_, &state_->poses);
    if (result_.stopped || options_.scan_iterations_per_sweep == 0) return;
    scans_.AttachPoints(*state_);
    Phase("scans", options_.scan_iterations_per_sweep, &scans_, &state_->poses);
    scans_.PlacePoints(state_->poses, &state_->points);
  }

  void Phase(const char* phase, int max_iterations, CgObjective* objective,
             std::vector<double>* state) {
    NonlinearCgOptions cg_options;
    cg_options.max_iterations = max_iterations;
    cg_options.relative_cost_tolerance = options_.relative_cost_tolerance;
    auto start = std::chrono::steady_clock::now();
    const auto on_iteration = [&](const CgIteration& cg) {
      IterationSummary iteration;
      iteration.phase = phase;
      iteration.cost = cg.cost;
      iteration.cost_change = cg.cost_change;
      iteration.gradient_max_norm = cg.gradient_max_norm;
      iteration.step_norm = cg.step_norm;
      iteration.step_size = cg.step_size;
      iteration.beta = cg.beta;
      iteration.evaluations = cg.evaluations;
      const auto now = std::chrono::steady_clock::now();
      iteration.iteration_time_s = std::chrono::duration<double>(now - start).count();
      start = now;
      result_.stopped = report_ && !report_(iteration);
      return !result_.stopped;
    };
    const CgResult cg = MinimizeByCg(cg_options, objective, on_iteration, energy_.pool(), state);
    if (cg.termination == CgTermination::kFailure) return;
    result_.final_cost = cg.cost;
    result_.iterations += cg.iterations;
  }

  const Energy& energy_;
  const AlternatingCgOptions& options_;
  const ProgressCallback& report_;
  MapState* state_;
  PartialObjective<2> map_;
  PartialObjective<3> poses_;
  ScanObjective scans_;
  InnerResult result_;
};

class AlternatingCg final : public RoundsSolver {
 public:
  const char* name() const override { return "alternating_cg"; }
  InnerResult Minimize(const RoundProblem& problem, const ProgressCallback& report,
                       MapState* state) const override {
    return SolveByAlternatingCg(problem.energy, problem.options.alternating_cg, report, state);
  }
};

}  // namespace

const Solver& AlternatingCgSolver() {
  static const AlternatingCg solver;
  return solver;
}

InnerResult SolveByAlternatingCg(const Energy& energy, const AlternatingCgOptions& options,
                                 const ProgressCallback& report, MapState* state) {
  TermCosts costs;
  if (!energy.Evaluate(state->poses, state->points, &costs)) {
    InnerResult failure;
    failure.stop_reason = "the energy is not finite at the given state";
    return failure;
  }
  return Alternation(energy, options, report, state).Run(costs.Total());
}

}  // namespace plumbline
