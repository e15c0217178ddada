#include "plumbline/solvers/full/ceres_solver.h"

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "plumbline/solvers/full/problem_builder.h"
#include "plumbline/solvers/full/rounds_solver.h"
#include "plumbline/solvers/interface/built_in_solvers.h"
#include "plumbline/solvers/interface/quiet_ceres.h"

namespace plumbline {
namespace {

// Hands Ceres' iterations on in the common format.
class ReportCallback final : public ceres::IterationCallback {
 public:
  explicit ReportCallback(const ProgressCallback& report) : report_(report) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& from) override {
    IterationSummary to;
    to.phase = "joint";
    to.cost = from.cost;
    to.cost_change = from.cost_change;
    to.gradient_max_norm = from.gradient_max_norm;
    to.step_norm = from.step_norm;
    to.step_size = from.step_size;
    to.trust_region_ratio = from.relative_decrease;
    to.trust_region_radius = from.trust_region_radius;
    to.evaluations = from.line_search_function_evaluations + from.linear_solver_iterations;
    to.iteration_time_s = from.iteration_time_in_seconds;
    const bool go_on = from.iteration == 0 || !report_ || report_(to);
    return go_on ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const ProgressCallback& report_;
};

ceres::Solver::Options OptionsFor(const JointProblem& joint, const CeresOptions& options) {
  ceres::Solver::Options result = options;
  if (ceres::IsSchurType(options.linear_solver_type)) {
    result.linear_solver_ordering = joint.ordering;
  }
  return result;
}

ceres::Solver::Options OptionsFor(const LandmarkProblem& landmarks, const CeresOptions& options) {
  ceres::Solver::Options result = options;
  if (ceres::IsSchurType(options.linear_solver_type)) {
    result.linear_solver_ordering = landmarks.ordering;
  }
  // The line of a short landmark can turn so far that a linear step overshoots, and one such
  // line has the steps of all poses refused. So the lines are refitted after each step.
  result.use_inner_iterations = landmarks.lines_ordering->NumElements() > 0;
  result.inner_iteration_ordering = landmarks.lines_ordering;
  return result;
}

InnerResult Minimize(ceres::Solver::Options ceres_options, int num_threads,
                     const ProgressCallback& report, ceres::Problem* problem) {
  ceres_options.num_threads = num_threads;
  ceres_options.update_state_every_iteration = true;  // for the callback
  ReportCallback callback(report);
  ceres_options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  SolveQuietly(std::move(ceres_options), problem, &summary);

  InnerResult result;
  result.usable = summary.IsSolutionUsable();
  result.stopped = summary.termination_type == ceres::USER_SUCCESS;
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  // The first entry is the starting point; there is none if that could not be evaluated.
  result.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  result.stop_reason = summary.message;
  return result;
}

// build() gives a JointProblem or a LandmarkProblem.
template <typename Build>
InnerResult BuildAndMinimize(const Build& build, const CeresOptions& options, int num_threads,
                             const ProgressCallback& report) {
  const auto start = std::chrono::steady_clock::now();
  const auto built = build();
  const double setup_time_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  InnerResult result =
      Minimize(OptionsFor(built, options), num_threads, report, built.problem.get());
  result.setup_time_s = setup_time_s;
  return result;
}

class JointCeresSolver final : public RoundsSolver {
 public:
  const char* name() const override { return "ceres"; }
  InnerResult Minimize(const RoundProblem& problem, const ProgressCallback& report,
                       MapState* state) const override {
    return SolveWithCeres(problem.graph, problem.associations, problem.factors,
                          *problem.options.ceres, problem.options.num_threads, report, state,
                          &problem.energy.constants());
  }
};

}  // namespace

const Solver& CeresSolver() {
  static const JointCeresSolver solver;
  return solver;
}

InnerResult SolveWithCeres(const SlamGraph& graph, const Associations& associations,
                           const FactorOptions& factors, const CeresOptions& options,
                           int num_threads, const ProgressCallback& report, MapState* state,
                           const std::vector<FixedPose>* constants) {
  return BuildAndMinimize(
      [&] { return BuildJointProblem(graph, associations, factors, state, constants); }, options,
      num_threads, report);
}

InnerResult SolveLandmarksWithCeres(const LineObservations& observations,
                                    const std::vector<LineLandmark>& landmarks,
                                    const PoseTerms& terms, const CeresOptions& options,
                                    int num_threads, const ProgressCallback& report,
                                    std::vector<double>* poses) {
  return BuildAndMinimize(
      [&] { return BuildLandmarkProblem(observations, landmarks, terms, poses); }, options,
      num_threads, report);
}

}  // namespace plumbline
