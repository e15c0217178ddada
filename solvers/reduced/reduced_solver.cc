#include "plumbline/solvers/reduced/reduced_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include "plumbline/core/map_state.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/full/ceres_solver.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/landmarks/landmark_shape.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/gauss_newton_step.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/reduced/unanchored_components.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Rounds go on while one moves returns across their surfaces, relative to the returns of the pose
// before, by more than this [standard deviations of a return, root mean square].
constexpr double kMoveToleranceSigmas = 0.1;
constexpr char kStopped[] = "stopped by the callback";

// What a step came to.
struct StepOutcome {
  double gain = 0.0;           // of the cost
  double moved_squared = 0.0;  // sum of squares of how far returns moved, in sigmas
};

class LandmarkMinimizer {
 public:
  LandmarkMinimizer(const SlamGraph& graph, const MeasuredSurface& surface,
                    const FactorOptions& factors, const ReducedOptions& options,
                    const AssociationOptions& association, const ProgressCallback& report,
                    ThreadPool* pool, std::vector<double>* poses, const CeresOptions* ceres)
      : graph_(graph),
        surface_(surface),
        factors_(factors),
        options_(options),
        association_(association),
        report_(report),
        pool_(pool),
        poses_(*poses),
        terms_(graph, factors),
        fixed_(terms_.is_constant),
        compressor_(graph, NoiseOf(factors), pool),
        move_([this, ceres] { ceres ? MoveByCeres(*ceres) : MoveByGaussNewton(); }) {}

  ReducedResult Run() {
    for (int round = 0; round < options_.max_rounds && !result_.converged && !Ended(); ++round) {
      const double gate_factor = round == 0 ? kStartGateFactor : 1.0;
      RunRound(gate_factor * factors_.manifold.robust_gate_sigmas, round == 0);
    }
    result_.fitted_poses = poses_;
    result_.fitted_cut.landmarks = landmarks_;
    result_.fitted_cut.shared = observations_.shared;
    if (!Ended()) RunLastRound();
    ForgetObservations();
    result_.fitted_cut.landmark_of_return = std::move(landmark_of_return_);
    result_.last_landmarks = std::move(landmarks_);
    return std::move(result_);
  }

 private:
  bool Ended() const { return result_.stopped || !result_.usable; }

  void RunRound(double gate_sigmas, bool first) {
    // Where returns hardly moved, another cut would be the same one. The second takes more in.
    if (result_.rounds.size() < 2 || result_.rounds.back().moved_sigmas > kMoveToleranceSigmas) {
      CutLandmarks(first);
      HoldUnanchored();
    }
    const double gain = TakeStep(gate_sigmas);
    CheckConvergence(gain, first, result_.rounds.back());
  }

  // All returns, those held out so far included, on the landmarks at hand.
  void RunLastRound() {
    SharedLandmarks shared = observations_.shared;
    ForgetObservations();
    observations_ = compressor_.LayOut(landmarks_.size(), landmark_of_return_, std::move(shared));
    HoldUnanchored();
    TakeStep(factors_.manifold.robust_gate_sigmas);
    if (result_.stopped) result_.stop_reason = kStopped;
  }

  // Adds a row to the rounds, and returns by how much the step lowered the cost.
  double TakeStep(double gate_sigmas) {
    const double setup_time_s = result_.setup_time_s;
    const auto start = Clock::now();
    LandmarkRoundSummary row;
    row.gate_sigmas = gate_sigmas;
    row.num_landmarks = SumOfPeers(observations_.shared.NumCountedHere(landmarks_.size()));
    row.num_observations = SumOfPeers(observations_.observations.size());
    const GemanMcClure loss = GemanMcClure::FromGate(gate_sigmas);
    step_start_ = Clock::now();
    frames_ = FramesOf(poses_);
    compressor_.Weigh(landmarks_, frames_, loss, &observations_);
    if (factors_.shape) {
      AddShapeTerms(adjacent_, factors_.ShapeGateSigmas(), landmarks_, frames_, &observations_);
    }
    if (!options_.lines_follow) FitLandmarkLines(observations_, frames_, pool_, &landmarks_);
    cost_ = row.initial_cost = landmark_cost_.At(poses_, frames_);
    const StepOutcome outcome = Step();
    row.final_cost = cost_;
    row.moved_sigmas = MovedSigmas(outcome.moved_squared);
    result_.rounds.push_back(row);
    result_.minimization_time_s += SecondsSince(start) - (result_.setup_time_s - setup_time_s);
    return outcome.gain;
  }

  // Where a group of poses is as a whole may be anybody's guess. It stays where its first pose is.
  void HoldUnanchored() {
    terms_.is_constant = fixed_;
    for (const int pose : FindUnanchoredComponents(observations_, terms_))
      terms_.is_constant[pose] = true;
  }

  // Need not lie beside what is about to take their place.
  void ForgetObservations() {
    observations_ = LineObservations();
    compressor_.ForgetLayout();
    system_ = PoseSystem();
  }

  // Returns without a normal have to guess where they belong, by the map as it is: while a seed may
  // have surfaces twice, they would hold them apart. They wait for the second round, if there is
  // one.
  void CutLandmarks(bool first) {
    const auto start = Clock::now();
    ForgetObservations();
    landmark_of_return_ = std::vector<int>();
    LineLandmarkOptions options = LandmarkOptionsFor(factors_, association_);
    options.hold_out = true;
    options.joins_without_normal = !first || options_.max_rounds == 1;
    LineLandmarks cut = CutIntoLandmarks(graph_, poses_, surface_, options, pool_);
    if (factors_.shape) adjacent_ = FindAdjacentLandmarks(graph_, cut, pool_);
    if (result_.rounds.empty()) result_.first_cut = cut;
    landmarks_ = std::move(cut.landmarks);
    landmark_of_return_ = std::move(cut.landmark_of_return);
    ReturnSelection fitted;
    fitted.without_held_out = true;
    observations_ =
        compressor_.LayOut(landmarks_.size(), landmark_of_return_, std::move(cut.shared), fitted);
    result_.cutting_time_s += SecondsSince(start);
  }

  StepOutcome Step() {
    system_.Linearize(observations_, landmarks_, terms_, poses_, frames_, pool_);
    if (!options_.lines_follow) system_.HoldLines();
    const std::vector<double> poses = poses_;
    const double cost = cost_;
    move_();
    return {cost - cost_, MovedSquared(poses)};
  }

  void MoveByGaussNewton() {
    const double cost = cost_;
    const GaussNewtonStep step = TakeGaussNewtonStep(system_, landmark_cost_, frames_,
                                                     options_.linear_solver.get(), &poses_, &cost_);
    IterationSummary iteration;
    iteration.phase = "poses";
    iteration.gradient_max_norm = MaxOverPeers(
        graph_.peers(),
        system_.gradient.size() > 0 ? system_.gradient.lpNorm<Eigen::Infinity>() : 0.0);
    iteration.evaluations = step.cg_iterations;
    iteration.step_norm = step.norm;
    iteration.step_size = step.length;
    iteration.cost = cost_;
    iteration.cost_change = cost - cost_;
    iteration.iteration_time_s = SecondsSince(step_start_);
    Report(iteration);
  }

  void MoveByCeres(const CeresOptions& options) {
    // A single constant is only the gauge. Ceres' iterative solvers, which end early, would rather
    // tear that pose off its map than turn the map, so all poses move, and then the map as a whole.
    PoseTerms terms = terms_;
    const auto gauge = std::find(terms.is_constant.begin(), terms.is_constant.end(), true);
    const bool is_gauge =
        graph_.factors().empty() && std::count(gauge, terms.is_constant.end(), true) == 1;
    if (is_gauge) *gauge = false;
    std::vector<double> poses = poses_;
    const InnerResult inner = SolveLandmarksWithCeres(
        observations_, landmarks_, terms, options, pool_->num_threads(),
        [this](const IterationSummary& iteration) { return Report(iteration); }, &poses_);
    poses_.swap(poses);
    if (is_gauge) MoveBack(static_cast<int>(gauge - terms.is_constant.begin()), &poses);
    landmark_cost_.MoveIfBetter(poses, &poses_, &cost_);
    result_.setup_time_s += inner.setup_time_s;
    result_.usable = inner.usable;
    if (!inner.usable) result_.stop_reason = inner.stop_reason;
  }

  // Moves all poses so that one is where it is in poses_, to the bit.
  void MoveBack(int in_place, std::vector<double>* poses) const {
    const Pose2 motion = Pose2(&poses_[3 * in_place]) * Pose2(&(*poses)[3 * in_place]).Inverse();
    std::vector<Pose2> moved = PosesOf(*poses);
    for (Pose2& pose : moved) pose = motion * pose;
    *poses = PoseArray(moved);
    std::copy_n(&poses_[3 * in_place], 3, &(*poses)[3 * in_place]);
  }

  // How far returns moved across their surfaces, but for what they share with those of the pose
  // before: a whole stretch of the map that shifts or bends takes its surfaces along.
  double MovedSquared(const std::vector<double>& from) const {
    double sum = 0.0;
    Eigen::Vector3d moved_before = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const Eigen::Vector3d moved = Eigen::Map<const Eigen::Vector3d>(&poses_[3 * i]) -
                                    Eigen::Map<const Eigen::Vector3d>(&from[3 * i]);
      Eigen::Vector3d relative = moved - moved_before;
      if (i > 0) {
        relative.x() += moved_before.z() * (frames_[i].y - frames_[i - 1].y);
        relative.y() -= moved_before.z() * (frames_[i].x - frames_[i - 1].x);
      }
      const int row = system_.row_of_pose[i];
      if (row >= 0) sum += relative.dot(system_.by_observations[row] * relative);
      moved_before = moved;
    }
    return SumOverPeers(graph_.peers(), sum);
  }

  std::size_t SumOfPeers(std::size_t count) const {
    return static_cast<std::size_t>(SumOverPeers(graph_.peers(), static_cast<double>(count)));
  }

  bool Report(IterationSummary iteration) {
    iteration.round = static_cast<int>(result_.rounds.size()) + 1;
    const bool stop = report_ && !report_(iteration);
    result_.stopped = SumOverPeers(graph_.peers(), stop ? 1.0 : 0.0) > 0.0;
    return !result_.stopped;
  }

  double MovedSigmas(double moved_squared) const {
    double total_weight = 0.0;
    for (const LineObservation& observation : observations_.observations)
      total_weight += observation.weight;
    total_weight = SumOverPeers(graph_.peers(), total_weight);
    const double noise_m = NoiseOf(factors_).StandardDeviation();
    return std::sqrt(moved_squared / std::max(total_weight * noise_m * noise_m, 1.0));
  }

  void CheckConvergence(double gain, bool first, const LandmarkRoundSummary& round) {
    if (!result_.usable) return;
    std::ostringstream reason;
    reason << "a round brought the cost down to " << round.final_cost << ", by " << gain
           << ", and moved returns by " << round.moved_sigmas << " sigmas";
    result_.converged = !first && !result_.stopped &&
                        gain <= options_.relative_tolerance * round.final_cost &&
                        round.moved_sigmas <= kMoveToleranceSigmas;
    reason << (result_.converged ? ": within the tolerances" : "");
    result_.stop_reason = result_.stopped ? kStopped : reason.str();
  }

  const SlamGraph& graph_;
  const MeasuredSurface& surface_;
  const FactorOptions& factors_;
  const ReducedOptions& options_;
  const AssociationOptions& association_;
  const ProgressCallback& report_;
  ThreadPool* pool_;
  std::vector<double>& poses_;  // the result so far
  PoseTerms terms_;
  const std::vector<char>
      fixed_;  // the graph's own constants; those of unanchored components come on top
  ReturnCompressor compressor_;
  // Lowers the cost for the weights at hand, if it can: changes poses_ and cost_.
  const std::function<void()> move_;
  std::vector<LineLandmark> landmarks_;
  std::vector<int> landmark_of_return_;  // with those held out
  std::vector<AdjacentLandmarks> adjacent_;
  LineObservations observations_;
  std::vector<PoseFrame> frames_;
  const LandmarkCost landmark_cost_{observations_, terms_, options_.lines_follow, pool_,
                                    &landmarks_};
  PoseSystem system_;
  double cost_ = 0.0;
  Clock::time_point step_start_;
  ReducedResult result_;
};

}  // namespace

ReducedResult MinimizeOverLandmarks(const SlamGraph& graph, const MeasuredSurface& surface,
                                    const FactorOptions& factors, const ReducedOptions& options,
                                    const AssociationOptions& association,
                                    const ProgressCallback& report, ThreadPool* pool,
                                    std::vector<double>* poses, const CeresOptions* ceres) {
  return LandmarkMinimizer(graph, surface, factors, options, association, report, pool, poses,
                           ceres)
      .Run();
}

}  // namespace plumbline
