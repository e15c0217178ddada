#include "plumbline/solvers/incremental_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/core/sort_unique.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/solvers/acceptance/contradicted_edges.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/association/tangent_lines.h"
#include "plumbline/solvers/full/point_recovery.h"
#include "plumbline/solvers/incremental/active_problem.h"
#include "plumbline/solvers/incremental/drive_graph.h"
#include "plumbline/solvers/incremental/edges_by_pose.h"
#include "plumbline/solvers/incremental/landmark_store.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/reduced/gauss_newton_step.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/reduced/unanchored_components.h"
#include "plumbline/solvers/solver_input.h"
#include "plumbline/solvers/terms/align_to_factors.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

Status CheckOptions(const SolverOptions& solver, const IncrementalOptions& options) {
  std::string error;
  if (!solver.Check(&error)) return Status::InvalidArgument(error);
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  const auto refuse = [](const char* what) {
    return Status::InvalidArgument(std::string("the incremental solver takes no ") + what);
  };
  if (solver.type != SolverType::kReduced || solver.own_solver) return refuse("other solver type");
  if (solver.factors.shape) return refuse("shape terms");
  if (!solver.factors.downweighted_steps.empty()) return refuse("down-weighted steps");
  if (!solver.factors.ignored_relative_poses.empty()) return refuse("ignored relative poses");
  return Status::Ok();
}

Status MovedFrom() { return Status::InvalidArgument("the incremental solver has been moved from"); }

// Squared Mahalanobis length that one of a thousand edges has that the poses agree with (three
// degrees of freedom).
constexpr double kMaxAgreeingChi2 = 16.27;
// The map as a whole moves for custom factors only if they are surer than this of the motion.
constexpr double kLeastGainOfMove = 0.5 * kMaxAgreeingChi2;

// Share of a mapper's closures that are usually false. By slam_toolbox's mapper it is 2.7 % on
// intel and aces, where the map is right, and 10 % on mit-killian, where the map is wrong.
constexpr double kUsuallyFalse = 0.05;
// Number of closures that may be false in any drive.
constexpr std::size_t kAlwaysFalse = 2;

// An edge that closes a loop and agrees frees all poses if there are this many times as many as
// when they were free last: the newest poses, held by a place that they have come back to, may have
// taken up all that the drive was off. So the work per pose stays bounded.
constexpr double kGrowth = 1.1;

// How far the returns of a pose are from where they would be at another [m], at most.
double LargestMove(const PoseFrame& from, const PoseFrame& to, double reach_m) {
  const double turn = std::hypot(to.c - from.c, to.s - from.s);
  return (to.translation() - from.translation()).norm() + turn * reach_m;
}

}  // namespace

bool IncrementalOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(num_free_poses, >, 0);
  PLUMBLINE_CHECK_OPTION(max_rounds, >, 0);
  return true;
}

class IncrementalSolver::Impl {
 public:
  Impl(const SolverOptions& solver, const IncrementalOptions& options)
      : solver_(solver),
        options_(options),
        landmark_options_(LandmarkOptionsFor(solver.factors, solver.association)),
        drive_(solver.factors.motion) {
    Forget();
  }

  Status Update(const SlamGraph& graph, UpdateScope scope, std::vector<double>* poses,
                IncrementalSummary* summary) {
    const auto begin = Clock::now();
    if (poses == nullptr) return Status::InvalidArgument("there are no poses to update: null");
    PLUMBLINE_RETURN_IF_ERROR(CheckOptions(solver_, options_));
    PLUMBLINE_RETURN_IF_ERROR(CheckInput(graph, *poses));
    IncrementalSummary result;
    std::vector<double> refined;
    Status status = CatchExceptions([&] {
      if (pool_ == nullptr) pool_ = std::make_unique<ThreadPool>(solver_.num_threads);
      refined = *poses;
      Run(graph, scope, &refined, &result);
      poses_ = refined;
      return Status::Ok();
    });
    if (!status.ok()) {
      Forget();
      return status;
    }
    *poses = std::move(refined);
    result.total_time_s = SecondsSince(begin);
    if (summary != nullptr) *summary = std::move(result);
    return Status::Ok();
  }

  Status GetState(const SlamGraph& graph, MapState* state) const {
    if (state == nullptr) return Status::InvalidArgument("there is no state to fill: null");
    if (3 * static_cast<std::size_t>(graph.num_poses()) != poses_.size() ||
        graph.num_returns() != surface_.normals.size()) {
      return Status::InvalidArgument("the graph is not the one of the last update");
    }
    return CatchExceptions([&] {
      if (pool_ == nullptr) pool_ = std::make_unique<ThreadPool>(solver_.num_threads);
      TangentLines lines(graph.num_returns());
      AddLandmarkLines(Landmarks(), pool_.get(), &lines);
      *state = {poses_, RecoverPoints(graph, poses_, lines, solver_.factors, pool_.get())};
      return Status::Ok();
    });
  }

 private:
  void Forget() {
    store_ = std::make_unique<LandmarkStore>(landmark_options_);
    edges_ = EdgesByPose();
    drive_ = DriveGraph(solver_.factors.motion);
    tests_ = std::make_unique<EdgeTests>(solver_.factors.beam);
    contradicted_.clear();
    surface_ = MeasuredSurface();
    poses_.clear();
    frames_.clear();
    num_scans_ = num_scans_at_reset_ = num_poses_at_last_loop_ = 0;
    is_laid_ = false;
  }

  int NumKnownPoses() const { return static_cast<int>(poses_.size() / 3); }

  Status CheckInput(const SlamGraph& graph, const std::vector<double>& poses) const {
    PLUMBLINE_RETURN_IF_ERROR(graph.status());
    if (poses.size() != 3 * static_cast<std::size_t>(graph.num_poses())) {
      return Status::InvalidArgument("the graph has " + std::to_string(graph.num_poses()) +
                                     " poses, but there are " + std::to_string(poses.size()) +
                                     " numbers for them, not three each");
    }
    if (graph.num_poses() < NumKnownPoses() || graph.num_scans() < num_scans_ ||
        graph.num_returns() < surface_.normals.size() ||
        graph.odometry().size() < edges_.motions().size() ||
        graph.relative_poses().size() < edges_.relative_poses().size() ||
        graph.factors().size() < edges_.factors().size()) {
      return Status::InvalidArgument("the graph has lost something since the last update");
    }
    if (graph.num_returns() > std::numeric_limits<std::uint32_t>::max()) {
      return Status::InvalidArgument("the graph has more returns than 32 bits can count");
    }
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (IsWithinReach(poses[i])) continue;
      return Status::InvalidArgument("pose " + std::to_string(i / 3) +
                                     " is not finite, or beyond 1e8 m or rad");
    }
    PLUMBLINE_RETURN_IF_ERROR(CheckFactorsFit(graph, ReducedSolver()));
    return CheckFactors(graph, {poses, {}}, edges_.factors().size());
  }

  void Run(const SlamGraph& graph, UpdateScope scope, std::vector<double>* poses,
           IncrementalSummary* summary) {
    if (graph.num_poses() == 0) return;
    PlaceInWorld(graph, poses);
    const auto begin = Clock::now();
    const bool is_moved = IsMovedByCaller(*poses);
    const News news{num_scans_, edges_.relative_poses().size()};
    Extend(graph);
    drive_.Extend(graph, surface_);
    if (is_moved) drive_.Restart(*poses);
    const std::vector<std::size_t> revised = TestEdges(graph, news.first_edge);
    const bool all = scope == UpdateScope::kAll || is_moved || !revised.empty();
    const std::vector<int> active = ActivePoses(graph, all, news, *poses);
    if (static_cast<int>(active.size()) == graph.num_poses()) {
      num_poses_at_last_loop_ = graph.num_poses();
      const bool has_new_edges = news.first_edge < graph.relative_poses().size();
      if (has_new_edges || !revised.empty()) CloseLoops(graph, poses);
    }
    TakeFrames(active, *poses);
    summary->num_free_poses = static_cast<int>(active.size());
    summary->association_time_s += SecondsSince(begin);
    if (graph.num_returns() == 0) return;
    for (int round = 0; round < options_.max_rounds; ++round) {
      const std::vector<int> to_place = PosesToPlace(graph, active, *poses);
      if (round > 0 && to_place.empty()) break;
      RunRound(graph, active, to_place, round == 0, poses, summary);
    }
    drive_.Measure(graph.num_poses(), *poses);
    summary->ignored_edges = DescribeIgnored(contradicted_, graph, *poses);
    CheckClosures(graph, *poses, summary);
  }

  // The map as a whole, where it is fixed somewhere else or new factors hold it.
  void PlaceInWorld(const SlamGraph& graph, std::vector<double>* poses) const {
    if (!graph.fixed_poses().empty()) {
      MoveToFirstFixed(graph.fixed_poses().front(), poses);
      PutAtFixedPoses(graph, poses);
    } else if (graph.factors().size() > edges_.factors().size()) {
      MapState state{*poses, {}};
      AlignToFactors(graph, &state, kLeastGainOfMove);
      *poses = std::move(state.poses);
    }
  }

  static void MoveToFirstFixed(const FixedPose& fixed, std::vector<double>* poses) {
    const Pose2 given(&(*poses)[3 * fixed.pose]), to = fixed.world_from_robot;
    if (given.x == to.x && given.y == to.y && given.yaw == to.yaw) return;
    const Pose2 motion = to * given.Inverse();
    std::vector<Pose2> moved = PosesOf(*poses);
    for (Pose2& pose : moved) pose = motion * pose;
    *poses = PoseArray(moved);
  }

  static void PutAtFixedPoses(const SlamGraph& graph, std::vector<double>* poses) {
    for (const FixedPose& fixed : graph.fixed_poses()) {
      const std::vector<double> block = PoseArray({fixed.world_from_robot});
      std::copy(block.begin(), block.end(), &(*poses)[3 * fixed.pose]);
    }
  }

  bool IsMovedByCaller(const std::vector<double>& poses) const {
    return !std::equal(poses_.begin(), poses_.end(), poses.begin());
  }

  // What of the graph is new.
  struct News {
    int first_scan;
    std::size_t first_edge;  // of the relative poses
  };

  // Ascending.
  std::vector<int> ActivePoses(const SlamGraph& graph, bool all, const News& news,
                               const std::vector<double>& poses) const {
    const int num_poses = graph.num_poses();
    int first = std::min(NumKnownPoses(), std::max(0, num_poses - options_.num_free_poses));
    for (int s = news.first_scan; s < graph.num_scans(); ++s) {
      first = std::min(first, graph.scan(s).pose);
    }
    const bool is_due = num_poses >= kGrowth * num_poses_at_last_loop_;
    for (std::size_t i = news.first_edge; i < graph.relative_poses().size(); ++i) {
      const RelativePoseConstraint& edge = graph.relative_poses()[i];
      if (std::min(edge.from, edge.to) >= first || FindContradicted(i) != nullptr) continue;
      const Pose2 from(&poses[3 * edge.from]), to(&poses[3 * edge.to]);
      all = all || is_due || EdgeChi2(edge, from, to) > kMaxAgreeingChi2;
    }
    if (all) first = 0;
    std::vector<int> active(num_poses - first);
    std::iota(active.begin(), active.end(), first);
    return active;
  }

  void Extend(const SlamGraph& graph) {
    ExtendSurface(graph, num_scans_, NormalOptionsFor(solver_.factors.beam), pool_.get(),
                  &surface_);
    num_scans_ = graph.num_scans();
    edges_.Extend(graph, solver_.factors);
    store_->Extend(graph);
    frames_.resize(graph.num_poses());
  }

  // Gives the edges, ascending, that it has another opinion of than before.
  std::vector<std::size_t> TestEdges(const SlamGraph& graph, std::size_t first_new) {
    if (!solver_.test_edges) return {};
    tests_->Extend(graph, surface_, pool_.get());
    std::vector<ContradictedEdge> contradicted = tests_->Contradicted(graph);
    std::vector<std::size_t> before, now;
    for (const ContradictedEdge& c : contradicted_) before.push_back(c.edge);
    for (const ContradictedEdge& c : contradicted) now.push_back(c.edge);
    edges_.Ignore(graph, now);
    contradicted_ = std::move(contradicted);
    now.erase(std::lower_bound(now.begin(), now.end(), first_new), now.end());
    std::vector<std::size_t> revised;
    std::set_symmetric_difference(now.begin(), now.end(), before.begin(), before.end(),
                                  std::back_inserter(revised));
    return revised;
  }

  // Null if it is not.
  const ContradictedEdge* FindContradicted(std::size_t edge) const {
    const auto at = std::lower_bound(
        contradicted_.begin(), contradicted_.end(), edge,
        [](const ContradictedEdge& c, std::size_t sought) { return c.edge < sought; });
    return at != contradicted_.end() && at->edge == edge ? &*at : nullptr;
  }

  void TakeFrames(const std::vector<int>& of, const std::vector<double>& poses) {
    for (const int pose : of) frames_[pose] = PoseFrame(&poses[3 * pose]);
  }

  // Where a new relative pose asks for more than landmarks can bridge (a loop that gapes), the pose
  // graph of the drive shares that out. All poses begin at its optimum: landmarks that joined walls
  // which are not the same may have bent the map, and would hold it so. Matches take the place of
  // contradicted edges. An edge that neither its scans nor edges near by speak for may be false: it
  // is left to the joint estimation, where scans hold the map against it.
  void CloseLoops(const SlamGraph& graph, std::vector<double>* poses) {
    drive_.Measure(graph.num_poses(), *poses);
    std::vector<RelativePoseConstraint> steps, closures, alone;
    for (std::size_t i = 0; i < graph.relative_poses().size(); ++i) {
      RelativePoseConstraint edge = graph.relative_poses()[i];
      if (edge.from == edge.to) continue;
      const bool is_step = std::abs(edge.from - edge.to) == 1;
      const ContradictedEdge* contradicted = FindContradicted(i);
      if (contradicted != nullptr) {
        if (!contradicted->match) continue;
        edge = *contradicted->match;
      }
      if (is_step) {
        steps.push_back(edge);
      } else if (contradicted == nullptr && solver_.test_edges && tests_->LacksMatch(graph, i)) {
        alone.push_back(edge);
      } else {
        closures.push_back(edge);
      }
    }
    const std::vector<RelativePoseConstraint> matched = closures;
    for (const RelativePoseConstraint& edge : alone) {
      if (drive_.AgreesWithOne(edge, matched)) closures.push_back(edge);
    }
    drive_.Close(steps, closures, graph.fixed_poses(), poses);
    PutAtFixedPoses(graph, poses);
  }

  static bool IsClosure(const RelativePoseConstraint& edge) {
    return std::abs(edge.from - edge.to) > 1;
  }

  // Says which closures the map contradicts, and raises the alarm if they are many.
  void CheckClosures(const SlamGraph& graph, const std::vector<double>& poses,
                     IncrementalSummary* summary) const {
    std::size_t num_closures = 0;
    std::vector<IgnoredEdge> contradicting;
    for (std::size_t i = 0; i < graph.relative_poses().size(); ++i) {
      if (!IsClosure(graph.relative_poses()[i])) continue;
      ++num_closures;
      const IgnoredEdge closure = DescribeEdge(i, graph, poses);
      if (closure.sigmas * closure.sigmas <= kMaxAgreeingChi2) continue;
      contradicting.push_back(closure);
      if (FindContradicted(i) == nullptr) summary->contradicted_closures.push_back(closure);
    }
    const auto usual = static_cast<std::size_t>(kUsuallyFalse * static_cast<double>(num_closures));
    if (contradicting.size() <= std::max(usual, kAlwaysFalse)) return;
    const auto farthest =
        std::max_element(contradicting.begin(), contradicting.end(),
                         [](const auto& a, const auto& b) { return a.off_m < b.off_m; });
    std::ostringstream reason;
    reason << std::fixed << std::setprecision(1) << contradicting.size() << " of " << num_closures
           << " loop closures contradict the map, by up to " << farthest->off_m << " m";
    const int pose = static_cast<int>(std::max(farthest->from, farthest->to));
    summary->alarms.push_back({PlaceOfPose(graph, poses, pose), reason.str(), std::nullopt});
  }

  // Returns that have moved by less [m] are still in their cells, nearly.
  double PlacingTolerance() const {
    return 0.5 * LandmarkQuadtree::FinestCell(landmark_options_.largest_m);
  }

  void RunRound(const SlamGraph& graph, const std::vector<int>& active,
                const std::vector<int>& to_place, bool first, std::vector<double>* poses,
                IncrementalSummary* summary) {
    auto begin = Clock::now();
    store_->Place(to_place, graph, surface_, frames_, LossOf(1.0), pool_.get());
    // A wide gate first: what has just arrived may be off by some decimetres.
    Weigh(to_place, first ? kStartGateFactor : 1.0, graph);
    ActiveProblem problem(active, graph, edges_, *store_, *poses, pool_.get());
    HoldUnanchored(&problem);
    summary->num_placed_poses += static_cast<int>(to_place.size());
    ++summary->num_rounds;
    summary->association_time_s += SecondsSince(begin);
    begin = Clock::now();
    Step(&problem, summary);
    TakeResult(problem, active, poses);
    summary->minimization_time_s += SecondsSince(begin);
    begin = Clock::now();
    std::vector<int> to_weigh = problem.MovedPoses(*store_, WeighingTolerance());
    if (first) to_weigh.insert(to_weigh.end(), to_place.begin(), to_place.end());
    SortUnique(&to_weigh);
    Weigh(to_weigh, 1.0, graph);
    summary->association_time_s += SecondsSince(begin);
  }

  void Weigh(const std::vector<int>& poses, double gate_factor, const SlamGraph& graph) {
    store_->Weigh(poses, graph, frames_, LossOf(gate_factor), pool_.get());
  }

  GemanMcClure LossOf(double gate_factor) const {
    return GemanMcClure::FromGate(gate_factor * solver_.factors.manifold.robust_gate_sigmas);
  }

  // Returns that have moved against their line by less [m] keep their weights, nearly.
  double WeighingTolerance() const {
    constexpr double kSigmas = 0.2;
    return kSigmas * landmark_options_.noise.StandardDeviation();
  }

  std::vector<int> PosesToPlace(const SlamGraph& graph, const std::vector<int>& active,
                                const std::vector<double>& poses) {
    // Octants are laid along the walls, and these are known once some scans are there.
    if (num_scans_ >= 2 * num_scans_at_reset_) {
      num_scans_at_reset_ = num_scans_;
      const double direction = DominantDirection(graph, poses, surface_, pool_.get());
      constexpr double kRightAngle = 0.5 * kPi;
      const double change = std::remainder(direction - dominant_direction_rad_, kRightAngle);
      constexpr double kNoticeableRad = 0.05;
      if (!is_laid_ || std::abs(change) > kNoticeableRad) {
        is_laid_ = true;
        dominant_direction_rad_ = direction;
        store_->Reset(direction);
        std::vector<int> all(graph.num_poses());
        std::iota(all.begin(), all.end(), 0);
        return all;
      }
    }
    std::vector<int> to_place;
    for (const int pose : active) {
      if (!store_->IsPlaced(pose) || LargestMove(store_->PlacedAt(pose), frames_[pose],
                                                 store_->Reach(pose)) > PlacingTolerance()) {
        to_place.push_back(pose);
      }
    }
    return to_place;
  }

  // Where a group of poses is as a whole may be anybody's guess. It stays where its first pose is.
  static void HoldUnanchored(ActiveProblem* problem) {
    for (const int pose : FindUnanchoredComponents(problem->observations, problem->terms)) {
      problem->terms.is_constant[pose] = true;
    }
  }

  void Step(ActiveProblem* problem, IncrementalSummary* summary) {
    const std::vector<PoseFrame> frames = FramesOf(problem->poses);
    const LandmarkCost landmark_cost{problem->observations, problem->terms, true, pool_.get(),
                                     &problem->landmarks};
    double cost = landmark_cost.At(problem->poses, frames);
    summary->initial_cost = cost;
    system_.Linearize(problem->observations, problem->landmarks, problem->terms, problem->poses,
                      frames, pool_.get());
    TakeGaussNewtonStep(system_, landmark_cost, frames, solver_.reduced.linear_solver.get(),
                        &problem->poses, &cost);
    ++summary->num_steps;
    summary->final_cost = cost;
  }

  void TakeResult(const ActiveProblem& problem, const std::vector<int>& active,
                  std::vector<double>* poses) {
    for (std::size_t i = 0; i < problem.pose_ids.size(); ++i) {
      if (problem.terms.is_constant[i]) continue;
      std::copy_n(&problem.poses[3 * i], 3, &(*poses)[3 * problem.pose_ids[i]]);
    }
    for (std::size_t i = 0; i < problem.landmark_ids.size(); ++i) {
      store_->SetLine(problem.landmark_ids[i], problem.landmarks[i]);
    }
    TakeFrames(active, *poses);
  }

  LineLandmarks Landmarks() const {
    LineLandmarks result;
    result.landmark_of_return = store_->landmark_of_return();
    for (const StoredLandmark& landmark : store_->landmarks()) {
      result.landmarks.push_back(landmark.line);
    }
    return result;
  }

  SolverOptions solver_;
  IncrementalOptions options_;
  LineLandmarkOptions landmark_options_;
  mutable std::unique_ptr<ThreadPool> pool_;
  std::unique_ptr<LandmarkStore> store_;
  EdgesByPose edges_;
  DriveGraph drive_;
  std::unique_ptr<EdgeTests> tests_;
  std::vector<ContradictedEdge> contradicted_;  // in order
  MeasuredSurface surface_;
  std::vector<double> poses_;      // as the last update gave them
  std::vector<PoseFrame> frames_;  // of these, and of the poses at hand
  PoseSystem system_;
  int num_scans_ = 0;
  int num_scans_at_reset_ = 0;
  int num_poses_at_last_loop_ = 0;  // when all were free
  bool is_laid_ = false;
  double dominant_direction_rad_ = 0.0;
};

IncrementalSolver::IncrementalSolver(const SolverOptions& solver, const IncrementalOptions& options)
    : impl_(std::make_unique<Impl>(solver, options)) {}
IncrementalSolver::~IncrementalSolver() = default;
IncrementalSolver::IncrementalSolver(IncrementalSolver&&) noexcept = default;
IncrementalSolver& IncrementalSolver::operator=(IncrementalSolver&&) noexcept = default;

Status IncrementalSolver::Update(const SlamGraph& graph, UpdateScope scope,
                                 std::vector<double>* poses, IncrementalSummary* summary) {
  if (impl_ == nullptr) return MovedFrom();
  const DefaultFloatEnvironment float_environment;
  return impl_->Update(graph, scope, poses, summary);
}

Status IncrementalSolver::GetState(const SlamGraph& graph, MapState* state) const {
  if (impl_ == nullptr) return MovedFrom();
  const DefaultFloatEnvironment float_environment;
  return impl_->GetState(graph, state);
}

}  // namespace plumbline
