#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <utility>
#include <vector>

#include "plumbline/core/fixed_poses.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/sqrt_information.h"
#include "plumbline/solvers/interface/built_in_solvers.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/pose_graph/refine_pose_graph.h"
#include "plumbline/solvers/pose_graph/stochastic_descent.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Sum of the squared whitened errors of a graph's relative poses: GraphChi2 for many states, with
// the covariances factored once.
class EdgeErrors {
 public:
  explicit EdgeErrors(const std::vector<RelativePoseConstraint>& edges) {
    for (const RelativePoseConstraint& edge : edges) {
      RelativePoseResidual residual;
      residual.a_from_b = edge.from_from_to;
      if (!SqrtInformation(edge.covariance, &residual.sqrt_information)) continue;
      edges_.push_back({edge.from, edge.to, residual});
    }
  }

  double Chi2(const std::vector<Pose2>& poses) const {
    double sum = 0.0;
    for (const Edge& edge : edges_) {
      const Pose2 &a = poses[edge.from], &b = poses[edge.to];
      const double block_a[] = {a.x, a.y, a.yaw}, block_b[] = {b.x, b.y, b.yaw};
      Eigen::Vector3d error;
      edge.residual.Evaluate(block_a, block_b, error.data(), nullptr, nullptr);
      sum += error.squaredNorm();
    }
    return sum;
  }

 private:
  struct Edge {
    int from;
    int to;
    RelativePoseResidual residual;
  };
  std::vector<Edge> edges_;
};

class PoseOnlyRun {
 public:
  PoseOnlyRun(const char* solver_name, bool by_sgd, const SolverProblem& problem,
              const MapState& seed)
      : by_sgd_(by_sgd),
        options_(problem.options),
        graph_(problem.graph),
        errors_(graph_.relative_poses()),
        seed_(seed),
        state_(seed),
        last_poses_(seed.poses) {
    summary_.solver = solver_name;
    summary_.num_poses = graph_.num_poses();
    summary_.num_points = graph_.num_returns();
    summary_.num_relative_poses = graph_.relative_poses().size();
  }

  SolverSummary Run() {
    summary_.seed_chi2 = Chi2();
    last_cost_ = 0.5 * summary_.seed_chi2;
    result_ = by_sgd_ ? Descend() : Optimize();
    summary_.final_chi2 = Chi2();
    const bool improved = summary_.final_chi2 < summary_.seed_chi2;
    state_.points = seed_.points;
    if (improved) {
      CarryPoints(graph_, seed_.poses, &state_);
    } else {
      state_.poses = seed_.poses;
    }
    Conclude(improved);
    return std::move(summary_);
  }

  MapState TakeState() { return std::move(state_); }

 private:
  double Chi2() const { return errors_.Chi2(PosesOf(state_.poses)); }

  PoseGraphResult Descend() {
    std::vector<int> fixed;
    for (const FixedPose& pose : graph_.fixed_poses()) fixed.push_back(pose.pose);
    std::vector<Pose2> poses = PosesOf(state_.poses);
    const auto report = [this](int /*iteration*/, const std::vector<Pose2>& now) {
      stopped_ = !Report(0.5 * errors_.Chi2(now), PoseArray(now));
      return !stopped_;
    };
    PoseGraphResult result = DescendStochastically(graph_.relative_poses(), &poses, fixed, report);
    state_.poses = PoseArray(poses);
    return result;
  }

  PoseGraphResult Optimize() {
    const auto report = [this](double cost, const std::vector<Pose2>& now) {
      return Report(cost, PoseArray(now));
    };
    PoseGraphResult result = RefinePoseGraph(graph_, &state_, report).optimization;
    stopped_ = result.stopped;
    return result;
  }

  // Keeps an iteration and hands it on; false asks to stop.
  bool Report(double cost, const std::vector<double>& poses) {
    double squared_step = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      squared_step += std::pow(poses[i] - last_poses_[i], 2);
    }
    IterationSummary row;
    row.iteration = static_cast<int>(summary_.iterations.size()) + 1;
    row.round = 1;
    row.phase = "poses";
    row.cost = cost;
    row.cost_change = last_cost_ - cost;
    row.step_norm = std::sqrt(squared_step);
    row.evaluations = 1;
    row.total_time_s = SecondsSince(start_);
    row.iteration_time_s =
        row.total_time_s -
        (summary_.iterations.empty() ? 0.0 : summary_.iterations.back().total_time_s);
    last_cost_ = cost;
    last_poses_ = poses;
    summary_.iterations.push_back(row);
    row.poses = &poses;
    return !options_.callback || options_.callback(row);
  }

  void Conclude(bool improved) {
    std::ostringstream message;
    message << "chi2 " << summary_.seed_chi2 << " -> " << summary_.final_chi2;
    if (!improved) message << ", not lower: the given poses are returned as they were";
    message << " (" << result_.iterations << " iterations; " << result_.stop_reason << ")";
    summary_.message = message.str();
    if (!improved) summary_.final_chi2 = summary_.seed_chi2;
    summary_.termination = stopped_            ? TerminationType::kUserStopped
                           : !improved         ? TerminationType::kNoImprovement
                           : result_.converged ? TerminationType::kConverged
                                               : TerminationType::kMaxIterations;
    summary_.solve_time_s = summary_.total_time_s = SecondsSince(start_);
  }

  const bool by_sgd_;
  const SolverOptions& options_;
  const SlamGraph& graph_;
  const EdgeErrors errors_;
  const MapState& seed_;
  MapState state_;
  const Clock::time_point start_ = Clock::now();
  SolverSummary summary_;
  PoseGraphResult result_;
  double last_cost_ = 0.0;
  std::vector<double> last_poses_;
  bool stopped_ = false;
};

class PoseOnlySolver final : public Solver {
 public:
  PoseOnlySolver(const char* name, bool by_sgd) : name_(name), by_sgd_(by_sgd) {}

  const char* name() const override { return name_; }
  bool MovesPosesOnly() const override { return true; }
  SolverSummary Solve(const SolverProblem& problem, MapState* state) const override {
    PoseOnlyRun run(name_, by_sgd_, problem, *state);
    SolverSummary summary = run.Run();
    *state = run.TakeState();
    return summary;
  }

 private:
  const char* name_;
  bool by_sgd_;
};

}  // namespace

const Solver& PoseGraphSolver() {
  static const PoseOnlySolver solver("pose_graph", false);
  return solver;
}

const Solver& SgdSolver() {
  static const PoseOnlySolver solver("sgd", true);
  return solver;
}

}  // namespace plumbline
