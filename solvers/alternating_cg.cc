#include "plumbline/solvers/alternating_cg.h"

#include <chrono>
#include <sstream>
#include <vector>

#include "plumbline/solvers/block_jacobi.h"
#include "plumbline/solvers/nonlinear_cg.h"
#include "plumbline/solvers/scan_objective.h"

namespace plumbline {
namespace {

// The energy as a function of the points, at fixed poses.
class MapObjective final : public CgObjective {
 public:
  MapObjective(const Energy& energy, const std::vector<double>& poses)
      : energy_(energy), poses_(poses) {}

  bool Start(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override {
    std::vector<double> blocks;
    if (!Evaluate(x, cost, gradient, &blocks)) return false;
    preconditioner_.Set(blocks);
    return true;
  }
  bool Evaluate(const std::vector<double>& x, double* cost,
                std::vector<double>* gradient) override {
    return Evaluate(x, cost, gradient, nullptr);
  }
  double Curvature(const std::vector<double>& x, const std::vector<double>& d) override {
    return energy_.Curvature(poses_, x, nullptr, &d);
  }
  void Precondition(const std::vector<double>& gradient, std::vector<double>* result) override {
    preconditioner_.Apply(gradient, result);
  }

 private:
  bool Evaluate(const std::vector<double>& x, double* cost, std::vector<double>* gradient,
                std::vector<double>* blocks) const {
    TermCosts costs;
    EnergyDerivatives derivatives;
    derivatives.point_gradient = gradient;
    derivatives.point_blocks = blocks;
    const bool ok = energy_.Evaluate(poses_, x, &costs, derivatives);
    *cost = costs.Total();
    return ok;
  }

  const Energy& energy_;
  const std::vector<double>& poses_;
  BlockJacobi<2> preconditioner_;
};

// The energy as a function of the poses, at fixed points.
class PoseObjective final : public CgObjective {
 public:
  PoseObjective(const Energy& energy, const std::vector<double>& points)
      : energy_(energy), points_(points) {}

  bool Start(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override {
    std::vector<double> blocks;
    if (!Evaluate(x, cost, gradient, &blocks)) return false;
    preconditioner_.Set(blocks);
    return true;
  }
  bool Evaluate(const std::vector<double>& x, double* cost,
                std::vector<double>* gradient) override {
    return Evaluate(x, cost, gradient, nullptr);
  }
  double Curvature(const std::vector<double>& x, const std::vector<double>& d) override {
    return energy_.Curvature(x, points_, &d, nullptr);
  }
  void Precondition(const std::vector<double>& gradient, std::vector<double>* result) override {
    preconditioner_.Apply(gradient, result);
  }

 private:
  bool Evaluate(const std::vector<double>& x, double* cost, std::vector<double>* gradient,
                std::vector<double>* blocks) const {
    TermCosts costs;
    EnergyDerivatives derivatives;
    derivatives.pose_gradient = gradient;
    derivatives.pose_blocks = blocks;
    const bool ok = energy_.Evaluate(x, points_, &costs, derivatives);
    *cost = costs.Total();
    return ok;
  }

  const Energy& energy_;
  const std::vector<double>& points_;
  BlockJacobi<3> preconditioner_;
};

class Alternation {
 public:
  Alternation(const Energy& energy, const AlternatingCgOptions& options,
              const ProgressCallback& report, SlamGraph* graph)
      : options_(options),
        report_(report),
        graph_(graph),
        map_(energy, graph->poses()),
        poses_(energy, graph->points()),
        scans_(energy, graph) {}

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
        reason << "a sweep lowered the cost by a fraction of " << change / before
               << " <= " << options_.relative_cost_tolerance;
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
    Phase("map", options_.map_iterations_per_sweep, &map_, &graph_->points());
    if (result_.stopped) return;
    Phase("poses", options_.pose_iterations_per_sweep, &poses_, &graph_->poses());
    if (result_.stopped || options_.scan_iterations_per_sweep == 0) return;
    scans_.AttachPoints();
    Phase("scans", options_.scan_iterations_per_sweep, &scans_, &graph_->poses());
    scans_.PlacePoints(graph_->poses(), &graph_->points());
  }

  void Phase(const char* phase, int max_iterations, CgObjective* objective,
             std::vector<double>* state) {
    NonlinearCgOptions cg_options;
    cg_options.max_iterations = max_iterations;
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
    const CgResult cg = MinimizeByCg(cg_options, objective, on_iteration, state);
    if (cg.termination == CgTermination::kFailure) return;
    result_.final_cost = cg.cost;
    result_.iterations += cg.iterations;
  }

  const AlternatingCgOptions& options_;
  const ProgressCallback& report_;
  SlamGraph* graph_;
  MapObjective map_;
  PoseObjective poses_;
  ScanObjective scans_;
  InnerResult result_;
};

}  // namespace

InnerResult SolveByAlternatingCg(const Energy& energy, const AlternatingCgOptions& options,
                                 const ProgressCallback& report, SlamGraph* graph) {
  TermCosts costs;
  if (!energy.Evaluate(graph->poses(), graph->points(), &costs)) {
    InnerResult failure;
    failure.stop_reason = "the energy is not finite at the given state";
    return failure;
  }
  return Alternation(energy, options, report, graph).Run(costs.Total());
}

}  // namespace plumbline
