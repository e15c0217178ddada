#include "plumbline/solvers/pose_only_solve.h"

#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <utility>
#include <vector>

#include "plumbline/core/graph_poses.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/sqrt_information.h"
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

class PoseOnlySolver {
 public:
  PoseOnlySolver(const SolverOptions& options, SlamGraph* graph)
      : options_(options),
        graph_(graph),
        errors_(graph->relative_poses()),
        seed_poses_(graph->poses()),
        seed_points_(graph->points()) {
    summary_.solver = ToString(options.type);
    summary_.num_poses = graph->num_poses();
    summary_.num_points = graph->num_returns();
    summary_.num_relative_poses = graph->relative_poses().size();
  }

  SolverSummary Run() {
    for (const FixedPose& fixed : graph_->fixed_poses()) {
      graph_->SetPose(fixed.pose, fixed.world_from_robot);
    }
    const std::vector<double> start = graph_->poses();
    summary_.seed_chi2 = Chi2();
    last_cost_ = 0.5 * summary_.seed_chi2;
    result_ = options_.type == SolverType::kSgd ? Descend() : Optimize();
    summary_.final_chi2 = Chi2();
    const bool improved = summary_.final_chi2 < summary_.seed_chi2;
    if (improved) {
      CarryPoints();
    } else {
      graph_->poses() = start;
      graph_->points() = seed_points_;
    }
    Conclude(improved);
    return std::move(summary_);
  }

 private:
  double Chi2() const { return errors_.Chi2(PosesOf(*graph_)); }

  PoseGraphResult Descend() {
    std::vector<int> fixed;
    for (const FixedPose& pose : graph_->fixed_poses()) fixed.push_back(pose.pose);
    std::vector<Pose2> poses = PosesOf(*graph_), before = poses;
    StochasticDescentOptions sgd = options_.sgd;
    sgd.callback = [&](int iteration, const std::vector<Pose2>& now) {
      double squared_step = 0.0;
      for (std::size_t i = 0; i < now.size(); ++i) {
        squared_step += std::pow(now[i].x - before[i].x, 2) + std::pow(now[i].y - before[i].y, 2) +
                        std::pow(now[i].yaw - before[i].yaw, 2);
      }
      before = now;
      const bool go_on = Report(0.5 * errors_.Chi2(now), squared_step) &&
                         (!options_.sgd.callback || options_.sgd.callback(iteration, now));
      stopped_ = !go_on;
      return go_on;
    };
    PoseGraphResult result = DescendStochastically(graph_->relative_poses(), sgd, &poses, fixed);
    for (int i = 0; i < graph_->num_poses(); ++i) graph_->SetPose(i, poses[i]);
    return result;
  }

  PoseGraphResult Optimize() {
    PoseGraphResult result =
        RefinePoseGraph(graph_, [this](double cost) { return Report(cost, 0.0); }).optimization;
    stopped_ = result.stopped;
    return result;
  }

  // Keeps an iteration and hands it on; false asks to stop.
  bool Report(double cost, double squared_step) {
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
    summary_.iterations.push_back(row);
    return !options_.callback || options_.callback(row);
  }

  // Every point keeps its place in the frame of its robot.
  void CarryPoints() {
    graph_->points() = seed_points_;
    for (int s = 0; s < graph_->num_scans(); ++s) {
      const ScanEntry& scan = graph_->scan(s);
      const Pose2 now_from_before =
          graph_->WorldFromRobot(scan.pose) * Pose2(&seed_poses_[3 * scan.pose]).Inverse();
      for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
        Eigen::Map<Eigen::Vector2d> point(&graph_->points()[2 * r]);
        point = now_from_before * Eigen::Vector2d(point);
      }
    }
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

  const SolverOptions& options_;
  SlamGraph* graph_;
  const EdgeErrors errors_;
  const std::vector<double> seed_poses_, seed_points_;
  const Clock::time_point start_ = Clock::now();
  SolverSummary summary_;
  PoseGraphResult result_;
  double last_cost_ = 0.0;
  bool stopped_ = false;
};

}  // namespace

SolverSummary SolvePosesOnly(const SolverOptions& options, SlamGraph* graph) {
  return PoseOnlySolver(options, graph).Run();
}

}  // namespace plumbline
