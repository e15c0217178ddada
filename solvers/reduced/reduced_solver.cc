#include "plumbline/solvers/reduced/reduced_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <utility>

#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/pose_terms.h"
#include "plumbline/solvers/reduced/patch_sightings.h"
#include "plumbline/solvers/reduced/pose_preconditioner.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/reduced/surface_patches.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What a step came to.
struct StepOutcome {
  double gain = 0.0;           // of the cost
  double moved_squared = 0.0;  // dx^T B dx: sum of squares of how far returns moved, in sigmas
};

class PatchMinimizer {
 public:
  PatchMinimizer(const MeasuredSurface& surface, const FactorOptions& factors,
                 const ReducedOptions& options, const ProgressCallback& report, ThreadPool* pool,
                 SlamGraph* graph)
      : surface_(surface),
        factors_(factors),
        options_(options),
        report_(report),
        pool_(pool),
        graph_(graph),
        terms_(*graph, factors),
        compressor_(*graph, surface, NoiseOf(factors), pool) {}

  ReducedResult Run() {
    for (int round = 0; round < options_.max_rounds && !result_.converged && !result_.stopped;
         ++round) {
      // Wide gates first: where the seed has a wall twice, both sides have to pull.
      const double gate_factor = round == 0 ? options_.first_gate_factor : 1.0;
      RunRound(gate_factor * factors_.manifold.robust_gate_sigmas, round == 0);
    }
    return std::move(result_);
  }

 private:
  void RunRound(double gate_sigmas, bool first) {
    CutPatches();
    const auto start = Clock::now();
    PatchRoundSummary row;
    row.gate_sigmas = gate_sigmas;
    row.num_patches = patches_.size();
    row.num_sightings = sightings_.sightings.size();
    const GemanMcClure loss = GemanMcClure::FromGate(gate_sigmas);
    StepOutcome sum;
    while (row.steps < options_.steps_per_round && !result_.stopped) {
      step_start_ = Clock::now();
      frames_ = FramesOf(graph_->poses());
      compressor_.Weigh(patches_, frames_, loss, &sightings_);
      cost_ = Cost(graph_->poses(), frames_);
      if (row.steps == 0) row.initial_cost = cost_;
      const StepOutcome outcome = Step();
      sum.gain += outcome.gain;
      sum.moved_squared += outcome.moved_squared;
      ++row.steps;
      if (outcome.gain <= options_.relative_tolerance * cost_) break;
    }
    row.final_cost = cost_;
    row.moved_sigmas = MovedSigmas(sum.moved_squared);
    Judge(sum.gain, first, row);
    result_.rounds.push_back(row);
    result_.minimization_time_s += SecondsSince(start);
  }

  void CutPatches() {
    const auto start = Clock::now();
    SurfacePatchOptions options;
    options.noise_m = NoiseOf(factors_).StandardDeviation();
    SurfacePatches cut = CutIntoPatches(*graph_, surface_, options, pool_);
    patches_ = std::move(cut.patches);
    sightings_ = compressor_.LayOut(patches_.size(), std::move(cut.patch_of_return));
    result_.cutting_time_s += SecondsSince(start);
  }

  // Refits the lines.
  double Cost(const std::vector<double>& poses, const std::vector<PoseFrame>& frames) {
    return FitPatchLines(sightings_, frames, pool_, &patches_) + terms_.Cost(poses);
  }

  StepOutcome Step() {
    system_.Linearize(sightings_, patches_, terms_, graph_->poses(), frames_, pool_);
    const PosePreconditioner preconditioner(system_, sightings_, frames_, pool_);
    Eigen::VectorXd step;
    const int cg_iterations =
        SolvePoseSystem(system_, sightings_, preconditioner, options_.cg_tolerance,
                        options_.max_cg_iterations, pool_, &step);
    StepOutcome outcome;
    constexpr int kMaxHalvings = 4;
    double length = 1.0;
    std::vector<double> poses(graph_->poses().size());
    for (int attempt = 0; attempt <= kMaxHalvings; ++attempt, length *= 0.5) {
      for (std::size_t i = 0; i < poses.size(); ++i) {
        poses[i] = graph_->poses()[i] + length * step[static_cast<Eigen::Index>(i)];
      }
      const double cost = Cost(poses, FramesOf(poses));
      if (!(cost < cost_)) continue;
      outcome.gain = cost_ - cost;
      outcome.moved_squared = length * length * MovedSquared(step);
      cost_ = cost;
      graph_->poses() = poses;
      break;
    }
    // The lines still are those of the last attempt.
    if (outcome.gain <= 0.0) Cost(graph_->poses(), frames_);
    Report(outcome, step, length, cg_iterations);
    return outcome;
  }

  double MovedSquared(const Eigen::VectorXd& step) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < system_.diagonal.size(); ++i) {
      const Eigen::Vector3d block = step.segment<3>(3 * static_cast<Eigen::Index>(i));
      sum += block.dot(system_.diagonal[i] * block);
    }
    return sum;
  }

  void Report(const StepOutcome& outcome, const Eigen::VectorXd& step, double length,
              int cg_iterations) {
    IterationSummary iteration;
    iteration.round = static_cast<int>(result_.rounds.size()) + 1;
    iteration.phase = "poses";
    iteration.cost = cost_;
    iteration.cost_change = outcome.gain;
    iteration.gradient_max_norm = system_.gradient.cwiseAbs().maxCoeff();
    iteration.step_norm = outcome.gain > 0.0 ? length * step.norm() : 0.0;
    iteration.step_size = outcome.gain > 0.0 ? length : 0.0;
    iteration.evaluations = cg_iterations;
    iteration.iteration_time_s = SecondsSince(step_start_);
    result_.stopped = report_ && !report_(iteration);
  }

  double MovedSigmas(double moved_squared) const {
    double total_weight = 0.0;
    for (const PatchSighting& sighting : sightings_.sightings) total_weight += sighting.weight;
    const double noise_m = NoiseOf(factors_).StandardDeviation();
    return std::sqrt(moved_squared / std::max(total_weight * noise_m * noise_m, 1.0));
  }

  void Judge(double gain, bool first, const PatchRoundSummary& round) {
    std::ostringstream reason;
    reason << "a round lowered the cost of " << round.initial_cost << " by " << gain
           << " and moved returns by " << round.moved_sigmas << " sigmas";
    result_.converged = !first && gain <= options_.relative_tolerance * round.initial_cost &&
                        round.moved_sigmas <= options_.move_tolerance_sigmas;
    reason << (result_.converged ? ": within the tolerances" : "");
    result_.stop_reason = result_.stopped ? "stopped by the callback" : reason.str();
  }

  const MeasuredSurface& surface_;
  const FactorOptions& factors_;
  const ReducedOptions& options_;
  const ProgressCallback& report_;
  ThreadPool* pool_;
  SlamGraph* graph_;
  const PoseTerms terms_;
  ReturnCompressor compressor_;
  std::vector<SurfacePatch> patches_;
  PatchSightings sightings_;
  std::vector<PoseFrame> frames_;
  PoseSystem system_;
  double cost_ = 0.0;
  Clock::time_point step_start_;
  ReducedResult result_;
};

}  // namespace

ReducedResult MinimizeOverPatches(const MeasuredSurface& surface, const FactorOptions& factors,
                                  const ReducedOptions& options, const ProgressCallback& report,
                                  ThreadPool* pool, SlamGraph* graph) {
  return PatchMinimizer(surface, factors, options, report, pool, graph).Run();
}

}  // namespace plumbline
