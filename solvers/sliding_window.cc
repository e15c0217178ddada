#include "plumbline/solvers/sliding_window.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "plumbline/core/copy_factor.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/solver_input.h"
#include "plumbline/solvers/window_context.h"

namespace plumbline {
namespace {

constexpr int kOutside = -1;

Status CheckPose(const MapState& state, int pose) {
  const double* block = state.poses.data() + 3 * pose;
  if (std::all_of(block, block + 3, IsWithinReach)) return Status::Ok();
  return Status::InvalidArgument("pose " + std::to_string(pose) +
                                 " of the state is not finite, or beyond 1e8 m or rad");
}

Status CheckPoints(const SlamGraph& graph, const MapState& state, int scan_id) {
  const ScanEntry& scan = graph.scan(scan_id);
  const auto first = state.points.begin() + 2 * scan.first_return;
  if (std::all_of(first, first + 2 * scan.num_returns, IsWithinReach)) return Status::Ok();
  return Status::InvalidArgument("a point of scan " + std::to_string(scan_id) +
                                 " is not finite, or beyond 1e8 m");
}

Status CheckFreePoses(const std::vector<int>& free_poses, const SlamGraph& graph,
                      const MapState& state) {
  if (free_poses.empty()) return Status::InvalidArgument("there are no free poses to solve for");
  std::vector<char> seen(graph.num_poses());
  for (const int pose : free_poses) {
    const std::string name = "free pose " + std::to_string(pose);
    if (pose < 0 || pose >= graph.num_poses()) {
      return Status::InvalidArgument(name + ": the graph has " + std::to_string(graph.num_poses()) +
                                     " poses");
    }
    if (seen[pose]) return Status::InvalidArgument(name + " is named twice");
    seen[pose] = true;
    PLUMBLINE_RETURN_IF_ERROR(CheckPose(state, pose));
  }
  return Status::Ok();
}

// The free poses of a graph and those that hold the map around them, as a graph of their own. Poses
// and scans keep their order.
class Window {
 public:
  Window(const SlamGraph& graph, const std::vector<int>& free_poses,
         const std::vector<int>& fixed_poses)
      : is_free_(graph.num_poses()), part_of_pose_(graph.num_poses(), kOutside) {
    for (const int pose : free_poses) is_free_[pose] = true;
    poses_.resize(free_poses.size() + fixed_poses.size());
    std::copy(free_poses.begin(), free_poses.end(), poses_.begin());
    std::copy(fixed_poses.begin(), fixed_poses.end(), poses_.begin() + free_poses.size());
    std::sort(poses_.begin(), poses_.end());
  }

  Status Extract(const SlamGraph& graph, const MapState& state) {
    for (const int pose : poses_) {
      PLUMBLINE_RETURN_IF_ERROR(CheckPose(state, pose));
      part_of_pose_[pose] = part_.AddPose(state.WorldFromRobot(pose), graph.timestamp_s(pose));
    }
    FixPoses(graph);
    PLUMBLINE_RETURN_IF_ERROR(AddScans(graph, state));
    AddConstraints(graph);
    return part_.status();
  }

  // What is known of the surfaces of the part.
  MeasuredSurface SurfaceOfPart(const MeasuredSurface& surface, const SlamGraph& graph) const {
    MeasuredSurface of_part;
    of_part.normals.reserve(part_.num_returns());
    for (const int s : scans_) {
      const auto first = surface.normals.begin() + graph.scan(s).first_return;
      of_part.normals.insert(of_part.normals.end(), first, first + graph.scan(s).num_returns);
    }
    return of_part;
  }

  const SlamGraph& part() const { return part_; }
  MapState* state() { return &state_; }

  // The options with the ids of the part. Edges are not tested: a window has few, and has to be
  // quick.
  SolverOptions OptionsOfPart(const SolverOptions& options, const SlamGraph& graph) const {
    SolverOptions of_part = options;
    of_part.test_edges = false;
    for (DownweightedStep& step : of_part.factors.downweighted_steps) {
      step.step = IndexInPart(graph.odometry(), step.step);
    }
    for (std::size_t& edge : of_part.factors.ignored_relative_poses) {
      edge = IndexInPart(graph.relative_poses(), edge);
    }
    return of_part;
  }

  // Takes over what has become of the free poses and of their points.
  void WriteBack(const SlamGraph& graph, MapState* state) const {
    for (const int pose : poses_) {
      if (is_free_[pose]) state->SetPose(pose, state_.WorldFromRobot(part_of_pose_[pose]));
    }
    for (int s = 0; s < part_.num_scans(); ++s) {
      const ScanEntry& to = graph.scan(scans_[s]);
      if (is_free_[to.pose]) CopyPoints(part_.scan(s), state_.points, to, &state->points);
    }
  }

 private:
  static void CopyPoints(const ScanEntry& from, const std::vector<double>& from_points,
                         const ScanEntry& to, std::vector<double>* to_points) {
    std::copy_n(from_points.begin() + 2 * from.first_return, 2 * from.num_returns,
                to_points->begin() + 2 * to.first_return);
  }

  // Free poses that the graph holds somewhere are held there, the others where they are.
  void FixPoses(const SlamGraph& graph) {
    for (const int pose : poses_) {
      if (!is_free_[pose]) part_.FixPose(part_of_pose_[pose]);
    }
    for (const FixedPose& fixed : graph.fixed_poses()) {
      if (!is_free_[fixed.pose]) continue;
      part_.FixPose(part_of_pose_[fixed.pose], fixed.world_from_robot);
    }
  }

  Status AddScans(const SlamGraph& graph, const MapState& state) {
    state_.poses = part_.initial_poses();
    for (int s = 0; s < graph.num_scans(); ++s) {
      const ScanEntry& from = graph.scan(s);
      const int pose = part_of_pose_[from.pose];
      if (pose == kOutside) continue;
      PLUMBLINE_RETURN_IF_ERROR(CheckPoints(graph, state, s));
      part_.AddScanOf(graph, s, pose);
      state_.points.resize(2 * part_.num_returns());
      CopyPoints(from, state.points, part_.scan(static_cast<int>(scans_.size())), &state_.points);
      scans_.push_back(s);
    }
    return Status::Ok();
  }

  // What joins fixed poses says nothing of the free ones.
  bool Joins(int from, int to) const {
    return part_of_pose_[from] != kOutside && part_of_pose_[to] != kOutside &&
           (is_free_[from] || is_free_[to]);
  }

  // Beyond all indices if it is not in the part.
  template <typename Constraint>
  std::size_t IndexInPart(const std::vector<Constraint>& constraints, std::size_t index) const {
    const auto joins = [this](const Constraint& c) { return Joins(c.from, c.to); };
    if (index >= constraints.size() || !joins(constraints[index])) return constraints.size();
    return std::count_if(constraints.begin(),
                         constraints.begin() + static_cast<std::ptrdiff_t>(index), joins);
  }

  void AddConstraints(const SlamGraph& graph) {
    const auto add = [this](auto constraint, auto method) {
      if (!Joins(constraint.from, constraint.to)) return;
      constraint.from = part_of_pose_[constraint.from];
      constraint.to = part_of_pose_[constraint.to];
      (part_.*method)(constraint);
    };
    for (const OdometryConstraint& c : graph.odometry()) add(c, &SlamGraph::AddOdometry);
    for (const RelativePoseConstraint& c : graph.relative_poses()) {
      add(c, &SlamGraph::AddRelativePose);
    }
    const auto pose_there = [this](int pose) { return part_of_pose_[pose]; };
    const auto scan_there = [this](int scan) {
      const auto found = std::lower_bound(scans_.begin(), scans_.end(), scan);
      const bool is_there = found != scans_.end() && *found == scan;
      return is_there ? static_cast<int>(found - scans_.begin()) : kOutside;
    };
    for (const CustomFactor& factor : graph.factors()) {
      if (SeesFree(graph, factor)) CopyFactor(graph, factor, pose_there, scan_there, &part_);
    }
  }

  bool SeesFree(const SlamGraph& graph, const CustomFactor& factor) const {
    const auto is_free = [&](int pose) { return is_free_[pose] != 0; };
    return std::any_of(factor.poses.begin(), factor.poses.end(), is_free) ||
           std::any_of(factor.points.begin(), factor.points.end(), [&](std::size_t point) {
             return is_free(graph.scan(graph.ScanOfReturn(point)).pose);
           });
  }

  std::vector<char> is_free_;      // per pose of the graph
  std::vector<int> part_of_pose_;  // likewise: its id in the part
  std::vector<int> poses_;         // per pose of the part: its id in the graph
  std::vector<int> scans_;         // likewise per scan
  SlamGraph part_;
  MapState state_;  // of the part
};

// surface: null if it has yet to be measured.
SolverSummary SolveChecked(const SolverOptions& options, const WindowOptions& window,
                           const std::vector<int>& free_poses, const MeasuredSurface* surface,
                           const SlamGraph& graph, MapState* state) {
  std::string error;
  if (!window.Check(&error))
    return SolverFailure(options, Status::InvalidArgument("window." + error));
  Status status = graph.status();
  if (status.ok()) status = CheckStateSize(graph, *state);
  if (status.ok() && !options.Check(&error)) status = Status::InvalidArgument(error);
  if (status.ok()) status = CheckFreePoses(free_poses, graph, *state);
  if (status.ok() && surface != nullptr) status = CheckSurfaceSize(graph, *surface);
  if (!status.ok()) return SolverFailure(options, status);
  const std::vector<int> fixed_poses = ChooseFixedPoses(window, graph, *state, free_poses);
  Window part(graph, free_poses, fixed_poses);
  status = part.Extract(graph, *state);
  if (!status.ok()) return SolverFailure(options, status);
  const SolverOptions options_of_part = part.OptionsOfPart(options, graph);
  SolverSummary summary = surface == nullptr
                              ? RefineState(options_of_part, part.part(), part.state())
                              : RefineState(options_of_part, part.SurfaceOfPart(*surface, graph),
                                            part.part(), part.state());
  if (summary.IsSolutionUsable()) part.WriteBack(graph, state);
  return summary;
}

SolverSummary SolveNewest(const SolverOptions& options, const WindowOptions& window,
                          const MeasuredSurface* surface, const SlamGraph& graph, MapState* state) {
  const DefaultFloatEnvironment float_environment;
  return CatchFailures(options, [&] {
    std::vector<int> newest(std::clamp(window.num_free_poses, 0, graph.num_poses()));
    std::iota(newest.begin(), newest.end(), graph.num_poses() - static_cast<int>(newest.size()));
    return SolveChecked(options, window, newest, surface, graph, state);
  });
}

}  // namespace

bool WindowOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(num_free_poses, >, 0);
  PLUMBLINE_CHECK_OPTION(max_fixed_poses, >=, 0);
  return true;
}

SolverSummary SolveWindow(const SolverOptions& options, const WindowOptions& window,
                          const SlamGraph& graph, MapState* state) {
  return SolveNewest(options, window, nullptr, graph, state);
}

SolverSummary SolveWindow(const SolverOptions& options, const WindowOptions& window,
                          const MeasuredSurface& surface, const SlamGraph& graph, MapState* state) {
  return SolveNewest(options, window, &surface, graph, state);
}

SolverSummary SolvePoses(const SolverOptions& options, const WindowOptions& window,
                         const std::vector<int>& free_poses, const SlamGraph& graph,
                         MapState* state) {
  const DefaultFloatEnvironment float_environment;
  return CatchFailures(
      options, [&] { return SolveChecked(options, window, free_poses, nullptr, graph, state); });
}

Status MeasureNewScans(const SolverOptions& options, const SlamGraph& graph,
                       MeasuredSurface* surface) {
  const DefaultFloatEnvironment float_environment;
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  const std::size_t num_measured = surface->normals.size();
  if (num_measured >= graph.num_returns()) return CheckSurfaceSize(graph, *surface);
  ThreadPool pool(options.num_threads);
  ExtendSurface(graph, graph.ScanOfReturn(num_measured), NormalOptionsFor(options.factors.beam),
                &pool, surface);
  return Status::Ok();
}

}  // namespace plumbline
