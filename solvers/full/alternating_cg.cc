#include "plumbline/solvers/full/alternating_cg.h"

#include <cstddef>
#include <sstream>
#include <vector>

#include "plumbline/solvers/full/cg_rows.h"
#include "plumbline/solvers/full/nonlinear_cg.h"
#include "plumbline/solvers/full/partial_objective.h"
#include "plumbline/solvers/full/rounds_solver.h"
#include "plumbline/solvers/full/scan_objective.h"
#include "plumbline/solvers/interface/built_in_solvers.h"

namespace plumbline {
namespace {

// The energy as a function of all poses and points: (x, y, yaw) per pose, then (x, y) per point.
// The step of its preconditioner is a sweep of the alternation.
class JointObjective final : public CgObjective {
 public:
  JointObjective(const Energy& energy, const AlternatingCgOptions& options, const MapState& state)
      : energy_(energy),
        options_(options),
        num_pose_values_(state.poses.size()),
        map_(energy, state_.poses, true),
        poses_(energy, state_.points, true),
        scans_(energy) {}

  static std::vector<double> Join(const MapState& state) {
    std::vector<double> x;
    x.reserve(state.poses.size() + state.points.size());
    x.insert(x.end(), state.poses.begin(), state.poses.end());
    x.insert(x.end(), state.points.begin(), state.points.end());
    return x;
  }
  void Split(const std::vector<double>& x, MapState* state) const {
    const auto first_point = x.begin() + static_cast<std::ptrdiff_t>(num_pose_values_);
    state->poses.assign(x.begin(), first_point);
    state->points.assign(first_point, x.end());
  }

  bool Start(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override {
    return Evaluate(x, cost, gradient);
  }
  bool Evaluate(const std::vector<double>& x, double* cost,
                std::vector<double>* gradient) override {
    Split(x, &state_);
    TermCosts costs;
    EnergyDerivatives derivatives;
    derivatives.pose_gradient = &other_.poses;
    derivatives.point_gradient = &other_.points;
    if (!energy_.Evaluate(state_.poses, state_.points, &costs, derivatives)) return false;
    *cost = costs.Total();
    *gradient = Join(other_);
    return true;
  }
  double Curvature(const std::vector<double>& x, const std::vector<double>& direction) override {
    Split(x, &state_);
    Split(direction, &other_);
    return energy_.Curvature(state_.poses, state_.points, &other_.poses, &other_.points);
  }
  void Precondition(const std::vector<double>& x, const std::vector<double>& /*gradient*/,
                    std::vector<double>* result) override {
    Split(x, &state_);
    Turn(1, &map_, &state_.points);
    Turn(1, &poses_, &state_.poses);
    if (options_.scan_iterations_per_sweep > 0) {
      scans_.AttachPoints(state_);
      Turn(options_.scan_iterations_per_sweep, &scans_, &state_.poses);
      scans_.PlacePoints(state_.poses, &state_.points);
    }
    *result = Join(state_);
    for (std::size_t i = 0; i < x.size(); ++i) (*result)[i] = x[i] - (*result)[i];
  }

 private:
  void Turn(int max_iterations, CgObjective* objective, std::vector<double>* x) {
    NonlinearCgOptions options;
    options.max_iterations = max_iterations;
    options.relative_cost_tolerance = options_.relative_cost_tolerance;
    MinimizeByCg(options, objective, nullptr, energy_.pool(), x);
  }

  const Energy& energy_;
  const AlternatingCgOptions& options_;
  const std::size_t num_pose_values_;
  MapState state_, other_;  // kept, for they are large
  PartialObjective<2> map_;
  PartialObjective<3> poses_;
  ScanObjective scans_;
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
  InnerResult result;
  TermCosts costs;
  if (!energy.Evaluate(state->poses, state->points, &costs)) {
    result.stop_reason = "the energy is not finite at the given state";
    return result;
  }
  result.usable = true;
  result.initial_cost = costs.Total();
  NonlinearCgOptions cg_options;
  cg_options.max_iterations = options.max_sweeps;
  cg_options.relative_cost_tolerance = options.relative_cost_tolerance;
  JointObjective objective(energy, options, *state);
  std::vector<double> x = JointObjective::Join(*state);
  double change = 0.0;
  CgRows rows("joint", report);
  const CgResult cg = MinimizeByCg(
      cg_options, &objective,
      [&](const CgIteration& iteration) {
        change = iteration.cost_change;
        objective.Split(x, state);  // what the callback is shown
        return rows.Add(iteration);
      },
      energy.pool(), &x);
  objective.Split(x, state);
  result.final_cost = cg.cost;
  result.iterations = cg.iterations;
  result.stopped = cg.termination == CgTermination::kStopped;
  result.converged = cg.termination == CgTermination::kCostConverged ||
                     cg.termination == CgTermination::kGradientConverged;
  std::ostringstream reason;
  switch (cg.termination) {
    case CgTermination::kStopped:
      reason << "stopped by the callback";
      break;
    case CgTermination::kMaxIterations:
      reason << "max_sweeps = " << options.max_sweeps << " reached";
      break;
    case CgTermination::kCostConverged:
      reason << "a sweep lowered the cost of " << cg.cost + change << " by " << change
             << ", a fraction <= " << options.relative_cost_tolerance;
      break;
    case CgTermination::kGradientConverged:
      reason << "the gradient is zero";
      break;
    case CgTermination::kNoDescent:
    case CgTermination::kFailure:
      reason << "no step along a sweep lowers the cost of " << cg.cost;
      break;
  }
  result.stop_reason = reason.str();
  return result;
}

}  // namespace plumbline
