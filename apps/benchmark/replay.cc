#include "plumbline/apps/benchmark/replay.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/marginal_energy.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Maps a drive as it comes in.
class Host {
 public:
  Host(const SolverOptions& solver, const ReplayOptions& options, const SlamGraph& drive,
       const SeedingReport& report)
      : solver_(solver),
        options_(options),
        drive_(drive),
        sequential_poses_(report.sequential_poses),
        steps_(report.pose_graph.begin(), report.pose_graph.begin() + drive.num_poses() - 1),
        closures_(report.pose_graph.begin() + drive.num_poses() - 1, report.pose_graph.end()),
        incremental_(solver, options.incremental) {}

  bool HasArrived() const { return graph_.num_poses() == drive_.num_poses(); }

  // The next batch: poses, scans, constraints.
  Status Receive() {
    const int first = graph_.num_poses();
    const int end = std::min(first + options_.batch_poses, drive_.num_poses());
    for (int pose = first; pose < end; ++pose) AddPose(pose);
    for (const OdometryConstraint& c : drive_.odometry()) {
      if (ArrivesIn(first, end, c)) graph_.AddOdometry(c);
    }
    for (const RelativePoseConstraint& c : drive_.relative_poses()) {
      if (ArrivesIn(first, end, c)) graph_.AddRelativePose(c);
    }
    const std::vector<Pose2> poses = PosesOf(state_.poses);
    num_news_ = 0;
    for (const RelativePoseConstraint& c : closures_) {
      if (!ArrivesIn(first, end, c)) continue;
      arrived_closures_.push_back(c);
      if (IsIncremental()) graph_.AddRelativePose(c);
      if (EdgeChi2(c, poses) > options_.max_closure_chi2) ++num_news_;
    }
    ++batch_;
    return graph_.status();
  }

  // What the batch asks for.
  Status Refine(ReplayStep* step) {
    return num_news_ > 0 ? Run(ReplayedSolve::kLoops, step) : Run(ReplayedSolve::kWindow, step);
  }
  Status Finish(ReplayStep* step) {
    num_news_ = 0;
    return Run(ReplayedSolve::kFinal, step);
  }

  const SlamGraph& graph() const { return graph_; }
  const MapState& state() const { return state_; }

 private:
  template <typename Constraint>
  static bool ArrivesIn(int first, int end, const Constraint& constraint) {
    const int later = std::max(constraint.from, constraint.to);
    return later >= first && later < end;
  }

  void AddPose(int pose) {
    Pose2 world_from_robot = drive_.InitialPose(0);
    if (pose > 0) {
      world_from_robot = state_.WorldFromRobot(pose - 1) *
                         Between(sequential_poses_[pose - 1], sequential_poses_[pose]);
    }
    const int id = graph_.AddPose(world_from_robot, drive_.timestamp_s(pose));
    for (int& scan = next_scan_; scan < drive_.num_scans() && drive_.scan(scan).pose == pose;
         ++scan) {
      graph_.AddScanOf(drive_, scan, id);
    }
    graph_.ExtendState(&state_);
  }

  bool IsIncremental() const { return options_.online_solver == OnlineSolver::kIncremental; }

  Status Run(ReplayedSolve solve, ReplayStep* step) {
    *step = {batch_, graph_.num_poses(), solve, static_cast<int>(arrived_closures_.size()),
             num_news_};
    const auto start = Clock::now();
    Status status =
        solve != ReplayedSolve::kFinal && IsIncremental() ? Update(step) : SolveOnce(solve, step);
    step->time_s = SecondsSince(start);
    if (status.ok()) return status;
    return Status::InvalidArgument("batch " + std::to_string(batch_) + ": " + status.message());
  }

  Status Update(ReplayStep* step) {
    IncrementalSummary summary;
    PLUMBLINE_RETURN_IF_ERROR(
        incremental_.Update(graph_, UpdateScope::kAutomatic, &state_.poses, &summary));
    step->num_placed = summary.num_placed_poses;
    step->initial_energy = summary.initial_cost;
    step->final_energy = summary.final_cost;
    return Status::Ok();
  }

  Status SolveOnce(ReplayedSolve solve, ReplayStep* step) {
    SolverSummary summary;
    PLUMBLINE_RETURN_IF_ERROR(MeasureNewScans(solver_, graph_, &surface_));
    if (solve == ReplayedSolve::kWindow) {
      summary = SolveWindow(solver_, options_.window, surface_, graph_, &state_);
    } else {
      if (solve == ReplayedSolve::kLoops) CloseLoops();
      // The whole drive once it is there: without closures, like the solution of all at once.
      const SlamGraph& graph = HasArrived() ? drive_ : graph_;
      state_.points = graph.MeasuredMap(state_.poses);
      summary = RefineState(solver_, surface_, graph, &state_);
    }
    step->initial_energy = summary.acceptance.seed_energy;
    step->final_energy = summary.acceptance.final_energy;
    return summary.IsSolutionUsable() ? Status::Ok() : Status::Unavailable(summary.message);
  }

  // The shape that the map has by now, with the uncertainty of its steps, under all closures.
  void CloseLoops() {
    std::vector<Pose2> poses = PosesOf(state_.poses);
    std::vector<RelativePoseConstraint> steps(steps_.begin(), steps_.begin() + poses.size() - 1);
    for (RelativePoseConstraint& step : steps) {
      step.from_from_to = Between(poses[step.from], poses[step.to]);
    }
    OptimizePoseGraph(steps, arrived_closures_, &poses);
    state_.poses = PoseArray(poses);
  }

  const SolverOptions& solver_;
  const ReplayOptions& options_;
  const SlamGraph& drive_;
  const std::vector<Pose2>& sequential_poses_;
  const std::vector<RelativePoseConstraint> steps_;     // from each pose to the next
  const std::vector<RelativePoseConstraint> closures_;  // of the whole drive
  SlamGraph graph_;
  MapState state_;
  MeasuredSurface surface_;
  IncrementalSolver incremental_;
  std::vector<RelativePoseConstraint> arrived_closures_;
  int next_scan_ = 0;
  int batch_ = 0;
  int num_news_ = 0;  // closures of this batch that the poses contradict
};

Status CheckInput(const SlamGraph& drive, const SeedingReport& report) {
  const std::size_t num_poses = drive.num_poses();
  for (int scan = 1; scan < drive.num_scans(); ++scan) {
    if (drive.scan(scan).pose >= drive.scan(scan - 1).pose) continue;
    return Status::InvalidArgument("a replay needs scans in the order of their poses, but scan " +
                                   std::to_string(scan) + " is not");
  }
  if (num_poses > 0 && report.sequential_poses.size() == num_poses &&
      report.pose_graph.size() + 1 >= num_poses) {
    return Status::Ok();
  }
  return Status::InvalidArgument("a replay needs the report of its own seed: the graph has " +
                                 std::to_string(num_poses) + " poses, the report " +
                                 std::to_string(report.sequential_poses.size()));
}

double EnergyOf(const SlamGraph& graph, const MapState& state, const SolverOptions& solver) {
  ThreadPool pool(solver.num_threads);
  const MeasuredSurface surface =
      MeasureSurface(graph, NormalOptionsFor(solver.factors.beam), &pool);
  return MarginalEnergy(graph, state.poses, surface, solver, &pool);
}

Status SolveBatch(const SolverOptions& solver, const SlamGraph& graph, MapState* state,
                  Replay* replay) {
  const auto start = Clock::now();
  const SolverSummary summary = RefineState(solver, graph, state);
  replay->batch_time_s = SecondsSince(start);
  replay->batch_energy = EnergyOf(graph, *state, solver);
  return summary.IsSolutionUsable() ? Status::Ok() : Status::InvalidArgument(summary.message);
}

}  // namespace

PoseDifferences ComparePoses(const std::vector<Pose2>& poses, const std::vector<Pose2>& batch) {
  PoseDifferences differences;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const double distance_m = (poses[i].translation() - batch[i].translation()).norm();
    differences.mean_m += distance_m / batch.size();
    differences.max_m = std::max(differences.max_m, distance_m);
    if (i == 0) continue;
    const double turn_rad =
        NormalizeAngle(Between(poses[i - 1], poses[i]).yaw - Between(batch[i - 1], batch[i]).yaw);
    differences.max_turn_rad = std::max(differences.max_turn_rad, std::abs(turn_rad));
  }
  return differences;
}

bool FromString(const std::string& name, OnlineSolver* solver) {
  if (name == "incremental") *solver = OnlineSolver::kIncremental;
  if (name == "window") *solver = OnlineSolver::kWindow;
  return name == "incremental" || name == "window";
}

const char* ToString(ReplayedSolve solve) {
  switch (solve) {
    case ReplayedSolve::kWindow:
      return "window";
    case ReplayedSolve::kLoops:
      return "loops";
    case ReplayedSolve::kFinal:
      return "final";
  }
  return "?";
}

bool ReplayOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(batch_poses, >, 0);
  PLUMBLINE_CHECK_FINITE_OPTION(max_closure_chi2, >, 0.0);
  PLUMBLINE_CHECK_NESTED_OPTIONS(incremental);
  PLUMBLINE_CHECK_NESTED_OPTIONS(window);
  return true;
}

Status RunReplay(const SolverOptions& solver, const ReplayOptions& options, const SlamGraph& drive,
                 const MapState& seed, const SeedingReport& report,
                 const std::function<void(const ReplayStep&)>& done, Replay* replay) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  PLUMBLINE_RETURN_IF_ERROR(CheckInput(drive, report));
  Replay result;
  Host host(solver, options, drive, report);
  ReplayStep step;
  const auto keep = [&] {
    result.steps.push_back(step);
    if (done) done(step);
  };
  while (!host.HasArrived()) {
    PLUMBLINE_RETURN_IF_ERROR(host.Receive());
    PLUMBLINE_RETURN_IF_ERROR(host.Refine(&step));
    keep();
  }
  result.world_from_robot = PosesOf(host.state().poses);
  result.online_energy = EnergyOf(drive, host.state(), solver);
  PLUMBLINE_RETURN_IF_ERROR(host.Finish(&step));
  keep();
  result.final_energy = EnergyOf(drive, host.state(), solver);
  MapState batch = seed;
  PLUMBLINE_RETURN_IF_ERROR(SolveBatch(solver, drive, &batch, &result));
  const std::vector<Pose2> batch_poses = PosesOf(batch.poses);
  result.online_difference = ComparePoses(result.world_from_robot, batch_poses);
  result.final_difference = ComparePoses(PosesOf(host.state().poses), batch_poses);
  *replay = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
