#include "plumbline/solvers/solve.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "plumbline/core/float_environment.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/alternating_cg.h"
#include "plumbline/solvers/candidate.h"
#include "plumbline/solvers/ceres_solver.h"
#include "plumbline/solvers/constraint_start.h"
#include "plumbline/solvers/contradicted_steps.h"
#include "plumbline/solvers/energy.h"
#include "plumbline/solvers/held_out_returns.h"
#include "plumbline/solvers/local_acceptance.h"
#include "plumbline/solvers/marginal_energy.h"
#include "plumbline/solvers/mirrored_scans.h"
#include "plumbline/solvers/point_recovery.h"
#include "plumbline/solvers/pose_only_solve.h"
#include "plumbline/solvers/reduced/reduced_solver.h"
#include "plumbline/solvers/solver_input.h"
#include "plumbline/solvers/verdict.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

Status CheckSurface(const MeasuredSurface& surface, const SlamGraph& graph) {
  if (surface.points.size() == graph.num_returns() &&
      surface.normals.size() == graph.num_returns()) {
    return Status::Ok();
  }
  return Status::InvalidArgument("the graph has " + std::to_string(graph.num_returns()) +
                                 " returns, but the surface " +
                                 std::to_string(surface.points.size()) + " points and " +
                                 std::to_string(surface.normals.size()) + " normals");
}

// What a round works with: neighbourhood radius [m] and factor on the robust gates.
struct RoundScale {
  double radius_m;
  double gate_factor;
};

// A stretch of surface of half length r, seen with standard deviation s across it, has variances
// r^2 / 3 and s^2: below 4.5 s even a perfect wall fails the default eigenvalue ratio of 0.15.
double SmallestUsefulRadius(const FactorOptions& factors) {
  return 5.0 * std::hypot(factors.beam.sigma_range_m, factors.manifold.sigma_m);
}

RoundScale ScaleOfCoarseRound(const RoundOptions& rounds, double smallest_radius_m, int round) {
  const double progress = static_cast<double>(round) / rounds.max_coarse_rounds;
  const double radius_m =
      rounds.coarse_radius_m * std::pow(rounds.fine_radius_m / rounds.coarse_radius_m, progress);
  return {std::max(radius_m, smallest_radius_m),
          std::pow(rounds.coarse_gate_factor, 1.0 - progress)};
}

// What was done for the sake of single places.
std::string LocalText(const SolverSummary& summary) {
  std::string text;
  if (!summary.doubted_steps.empty()) {
    text += ", with " + std::to_string(summary.doubted_steps.size()) +
            " odometry steps doubted that the seed contradicts";
  }
  if (!summary.put_back.empty()) {
    text += ", with " + std::to_string(summary.put_back.size()) +
            " stretches put back to the seed that had become worse";
  }
  return text;
}

class JointSolver {
 public:
  // Keeps references to all its arguments. suggested: see StartFromConstraints.
  JointSolver(const SolverOptions& options, const MeasuredSurface* surface,
              const std::optional<std::vector<double>>& suggested, const SlamGraph& graph,
              const MapState& seed)
      : options_(options),
        factors_(options.factors),
        suggested_(suggested),
        graph_(graph),
        seed_(seed),
        fine_radius_m_(FineRadius(options)),
        pool_(options.num_threads),
        surface_(surface) {
    summary_.solver = ToString(options.type);
    if (options.type == SolverType::kCeres && options.ceres.reduced) summary_.solver += ", reduced";
    summary_.num_poses = graph.num_poses();
    summary_.num_points = graph.num_returns();
    DescribeTerms();
  }

  // Puts the best state into *result, which may be the seed; unless it is the seed.
  SolverSummary Run(MapState* result) {
    if (surface_ == nullptr) {
      own_surface_ = MeasureSurface(graph_, NormalOptionsFor(factors_.beam), &pool_);
      surface_ = &own_surface_;
    }
    FindStart();
    if (options_.IsOverPatches()) {
      RunReduced();
    } else {
      RunRounds();
    }
    Conclude();
    if (summary_.verdict.IsBetter()) *result = std::move(state_);
    return std::move(summary_);
  }

 private:
  const CeresOptions* Ceres() const {
    return options_.type == SolverType::kCeres ? &options_.ceres : nullptr;
  }

  // Where odometry and relative poses flatly contradict the seed, what they say may be the better
  // start.
  void FindStart() {
    state_.poses = seed_.poses;
    if (!suggested_) return;
    seed_patches_ = CutSurfaces(seed_.poses);
    summary_.started_from_constraints =
        Compare({*suggested_, CutSurfaces(*suggested_)}).LowersEnergy();
    if (summary_.started_from_constraints) state_.poses = *suggested_;
  }

  // Rounds over patches, then the points in closed form.
  void RunReduced() {
    ReducedResult result = Minimize();
    if (!summary_.started_from_constraints) seed_patches_ = std::move(result.first_cut);
    Candidate found = Judge().Weigh(result.judged_poses, std::move(result.judged_cut));
    const std::vector<DoubtedStep> doubted = StepsAgainst(found);
    if (!doubted.empty()) MinimizeDoubting(doubted, &result, &found);
    last_patches_ = std::move(result.last_cut);
    PassVerdict(&found);
    judged_patches_ = std::move(found.cut);
    if (summary_.verdict.IsBetter()) {
      PutBack(summary_.put_back, graph_.fixed_poses(), seed_.poses, &state_.poses);
    } else {
      state_.poses = seed_.poses;
    }
    Associations associations;
    associations.lines = CurrentLines();
    best_energy_ = MarginalEnergyUnder(associations.lines);
    if (summary_.verdict.IsBetter()) {
      best_round_ = static_cast<int>(summary_.patch_rounds.size());
      FinishReduced(&associations);
    } else {
      RecordSeedTerms(associations);
    }
  }

  // From the poses at hand.
  ReducedResult Minimize() {
    rounds_before_ = static_cast<int>(summary_.patch_rounds.size());
    ReducedResult result =
        MinimizeOverPatches(graph_, *surface_, factors_, options_.reduced, options_.association,
                            ReportCallback(), &pool_, &state_.poses, Ceres());
    summary_.patch_rounds.insert(summary_.patch_rounds.end(), result.rounds.begin(),
                                 result.rounds.end());
    rounds_before_ = 0;
    summary_.solve_time_s += result.minimization_time_s;
    summary_.setup_time_s += result.setup_time_s;
    summary_.association_time_s += result.cutting_time_s;
    last_inner_.usable = result.usable;
    last_inner_.stopped = result.stopped;
    last_inner_.stop_reason = result.stop_reason;
    converged_ = result.converged;
    return result;
  }

  // Once more from the seed; what is the better one by the energy without these steps stays.
  void MinimizeDoubting(const std::vector<DoubtedStep>& steps, ReducedResult* result,
                        Candidate* found) {
    const std::vector<double> poses = state_.poses;
    const InnerResult inner = last_inner_;
    const bool converged = converged_;
    DoubtSteps(steps);
    state_.poses = seed_.poses;
    ReducedResult second = Minimize();
    Candidate again = Judge().Weigh(second.judged_poses, std::move(second.judged_cut));
    if (last_inner_.usable && Judge().IsPreferable(*found, again)) {
      *result = std::move(second);
      *found = std::move(again);
      summary_.started_from_constraints = false;
      return;
    }
    TrustSteps();
    state_.poses = poses;
    const bool stopped = last_inner_.stopped;
    last_inner_ = inner;
    last_inner_.stopped = stopped;
    converged_ = converged;
  }

  CandidateJudge Judge() {
    return {graph_, *surface_, factors_, {seed_.poses, seed_patches_}, &pool_};
  }
  bool Ended() const { return last_inner_.stopped || !last_inner_.usable; }
  std::vector<DoubtedStep> StepsAgainst(const Candidate& found) const {
    if (Ended()) return {};
    return StepsToDoubt(graph_, factors_, seed_.poses, found.poses, found.worse);
  }

  void DoubtSteps(const std::vector<DoubtedStep>& steps) {
    summary_.doubted_steps = steps;
    factors_.doubted_steps.insert(factors_.doubted_steps.end(), steps.begin(), steps.end());
  }
  void TrustSteps() {
    summary_.doubted_steps.clear();
    factors_.doubted_steps = options_.factors.doubted_steps;
  }

  // The parts that are clearly worse than the seed's are put back, and then the whole has to be
  // better.
  void PassVerdict(Candidate* found) {
    summary_.put_back = Judge().PutBackWorse(found);
    summary_.verdict = found->verdict;
    if (!summary_.verdict.IsBetter()) summary_.put_back.clear();
  }

  // The surfaces as these poses place them, without what is held out.
  SurfacePatches CutSurfaces(const std::vector<double>& poses) {
    SurfacePatchOptions cutting = PatchOptionsFor(factors_, options_.association);
    cutting.hold_out = true;
    return CutIntoPatches(graph_, poses, *surface_, cutting, &pool_);
  }

  Verdict Compare(const JudgedState& state) {
    return CompareWithSeed(graph_, *surface_, factors_, {seed_.poses, seed_patches_}, state,
                           &pool_);
  }

  // For want of something better, the terms after are those before.
  void RecordSeedTerms(const Associations& associations) {
    const Energy energy(graph_, associations, factors_, &pool_);
    RecordTerms(energy, seed_, &TermSummary::initial_cost);
    RecordTerms(energy, seed_, &TermSummary::final_cost);
  }

  // The final points, and the costs per term before and after, under the final lines.
  void FinishReduced(Associations* associations) {
    AddPatchLines(last_patches_, &associations->lines);
    state_.points =
        RecoverPoints(graph_, state_.poses, *surface_, associations->lines, factors_, &pool_);
    summary_.displacements = Displacements();
    if (factors_.shape.enabled) {
      associations->shape_pairs = FindShapePairs(graph_, state_.points, surface_->normals,
                                                 associations->lines, options_.association, &pool_);
    }
    const Energy energy(graph_, *associations, factors_, &pool_);
    RecordTerms(energy, seed_, &TermSummary::initial_cost);
    if (options_.reduced.polish_sweeps > 0 && !Ended()) Polish(energy);
    RecordTerms(energy, state_, &TermSummary::final_cost);
  }

  // Exact per-point sweeps on the lines at hand, which never raise the energy there; undone if the
  // poses have become worse than the seed by that.
  void Polish(const Energy& energy) {
    const MapState unpolished = state_;
    AlternatingCgOptions sweeps = options_.alternating_cg;
    sweeps.max_sweeps = options_.reduced.polish_sweeps;
    const auto start = Clock::now();
    last_inner_.stopped = SolveByAlternatingCg(energy, sweeps, ReportCallback(), &state_).stopped;
    summary_.solve_time_s += SecondsSince(start);
    const Candidate polished = Judge().Weigh(state_.poses, judged_patches_);
    if (!polished.verdict.IsBetter()) {
      state_ = unpolished;
      return;
    }
    best_energy_ = MarginalEnergyUnder(CurrentLines());
    summary_.displacements = Displacements();
  }

  // Rounds without the held-out returns, then one with all, so that none is lost to the result.
  void RunRounds() {
    if (summary_.started_from_constraints) {
      state_.points = graph_.MeasuredMap(state_.poses);
    } else {
      state_.points = seed_.points;
      seed_patches_ = CutSurfaces(seed_.poses);
    }
    Keep(MarginalEnergyUnder(CurrentLines()));

    // A return without a normal has no line, and then says nothing of poses and lines.
    const Eigen::Vector2f no_normal = Eigen::Vector2f::Zero();
    const MeasuredSurface fitted{surface_->points,
                                 WithoutHeldOut(graph_, surface_->normals, no_normal)};
    associated_ = &fitted;
    RunFittedRounds();
    Candidate found = Judge().Weigh(state_.poses, CutSurfaces(state_.poses));
    const std::vector<DoubtedStep> doubted = StepsAgainst(found);
    if (!doubted.empty()) RunRoundsDoubting(doubted, &found);
    associated_ = surface_;

    PassVerdict(&found);
    if (!summary_.verdict.IsBetter()) {
      state_ = seed_;
      best_energy_ = MarginalEnergyUnder(CurrentLines());
    } else if (!summary_.put_back.empty()) {
      // Another round might draw off again what has been put back.
      state_.poses = found.poses;
      state_.points = graph_.MeasuredMap(found.poses);
      best_energy_ = MarginalEnergyUnder(CurrentLines());
    } else if (!ended_) {
      RunRound({fine_radius_m_, 1.0});
    }
    summary_.displacements = Displacements();
  }

  // Like MinimizeDoubting.
  void RunRoundsDoubting(const std::vector<DoubtedStep>& steps, Candidate* found) {
    const MapState trusting = state_;
    const double energy = best_energy_;
    const int round = best_round_;
    const bool converged = converged_;
    DoubtSteps(steps);
    state_ = seed_;
    Keep(MarginalEnergyUnder(CurrentLines()));
    RunFittedRounds();
    Candidate again = Judge().Weigh(state_.poses, CutSurfaces(state_.poses));
    if (last_inner_.usable && Judge().IsPreferable(*found, again)) {
      *found = std::move(again);
      summary_.started_from_constraints = false;
      return;
    }
    TrustSteps();
    state_ = trusting;
    Keep(energy);
    best_round_ = round;
    converged_ = converged;
  }

  void RunFittedRounds() {
    for (int round = 0; round < options_.rounds.max_coarse_rounds && !ended_; ++round) {
      if (!RunRound(ScaleOfCoarseRound(options_.rounds, fine_radius_m_, round))) break;
    }
    for (int round = 0; round < options_.rounds.max_fine_rounds && !ended_; ++round) {
      const double before = best_energy_;
      const bool kept = RunRound({fine_radius_m_, 1.0});
      converged_ = !ended_ &&
                   (!kept || before - best_energy_ <= options_.rounds.relative_tolerance * before);
      if (converged_) break;
    }
  }

  // The lines that the current poses give.
  std::vector<TangentLine> CurrentLines() {
    const auto start = Clock::now();
    std::vector<TangentLine> lines = LinesFromRadius(graph_, state_.poses, *surface_,
                                                     options_.association, fine_radius_m_, &pool_);
    summary_.association_time_s += SecondsSince(start);
    return lines;
  }
  double MarginalEnergyUnder(const std::vector<TangentLine>& lines) {
    return MarginalEnergy(graph_, state_.poses, *surface_, lines, factors_, &pool_);
  }
  PointDisplacements Displacements() {
    return MeasureDisplacements(graph_, state_, *surface_, factors_, &pool_);
  }

  // Share of an energy that the rounding of measured points to single precision may change.
  static constexpr double kRounding = 1e-9;

  bool IsImprovement(double energy) const { return energy < best_energy_ * (1.0 - kRounding); }

  // Runs one round from the best state so far. Returns whether it was an improvement; if not, the
  // best state is back.
  bool RunRound(const RoundScale& scale) {
    FactorOptions factors = factors_;
    factors.manifold.robust_gate_sigmas *= scale.gate_factor;
    factors.shape.robust_gate_sigmas *= scale.gate_factor;
    RoundSummary row;
    row.radius_m = scale.radius_m;
    row.gate_sigmas = factors.manifold.robust_gate_sigmas;
    auto start = Clock::now();
    const Associations associations = Associate(scale.radius_m);
    summary_.association_time_s += SecondsSince(start);
    row.num_lines = associations.CountLines();
    row.num_shape_pairs = associations.shape_pairs.size();

    start = Clock::now();
    const Energy energy(graph_, associations, factors, &pool_);
    RecordTerms(energy, state_, &TermSummary::initial_cost);
    last_inner_ = SolveInner(energy, associations, factors);
    RecordTerms(energy, state_, &TermSummary::final_cost);
    summary_.setup_time_s += last_inner_.setup_time_s;
    summary_.solve_time_s += SecondsSince(start) - last_inner_.setup_time_s;
    row.initial_cost = last_inner_.initial_cost;
    row.final_cost = last_inner_.final_cost;
    row.iterations = last_inner_.iterations;
    row.stop_reason = last_inner_.stop_reason;
    row.marginal_energy = MarginalEnergyUnder(CurrentLines());
    row.kept = last_inner_.usable && IsImprovement(row.marginal_energy);
    ended_ = last_inner_.stopped || !last_inner_.usable;
    summary_.rounds.push_back(row);
    if (row.kept) {
      Keep(row.marginal_energy);
    } else {
      state_ = best_;
    }
    return row.kept;
  }

  // Lines are fitted to the measured ends of the beams at the current poses, not to the points:
  // these have been drawn to the last lines and would hold the next ones in place.
  Associations Associate(double radius_m) {
    const MapState measured{state_.poses, graph_.MeasuredMap(state_.poses)};
    return BuildAssociations(graph_, measured, *associated_, options_.association, radius_m,
                             &pool_);
  }

  void Keep(double energy) {
    best_energy_ = energy;
    best_round_ = static_cast<int>(summary_.rounds.size());
    best_ = state_;
  }

  // Keeps every iteration, numbered through, and hands it on.
  ProgressCallback ReportCallback() {
    return [this](const IterationSummary& from) {
      IterationSummary iteration = from;
      iteration.iteration = static_cast<int>(summary_.iterations.size()) + 1;
      iteration.round += iteration.round > 0 ? rounds_before_ : 0;
      if (iteration.round == 0) {
        iteration.round =
            static_cast<int>(summary_.rounds.size() + summary_.patch_rounds.size()) + 1;
      }
      iteration.total_time_s = SecondsSince(start_);
      summary_.iterations.push_back(iteration);
      iteration.poses = &state_.poses;
      return !options_.callback || options_.callback(iteration);
    };
  }

  InnerResult SolveInner(const Energy& energy, const Associations& associations,
                         const FactorOptions& factors) {
    if (options_.type == SolverType::kCeres) {
      return SolveWithCeres(graph_, associations, factors, options_.ceres, options_.num_threads,
                            ReportCallback(), &state_);
    }
    return SolveByAlternatingCg(energy, options_.alternating_cg, ReportCallback(), &state_);
  }

  void RecordTerms(const Energy& energy, const MapState& state, double TermSummary::*cost) {
    TermCosts costs;
    if (!energy.Evaluate(state.poses, state.points, &costs)) return;
    const auto counts = energy.CountTerms();
    for (int t = 0; t < kNumTerms; ++t) {
      summary_.terms[t].count = counts[t];
      summary_.terms[t].*cost = costs.cost[t];
    }
  }

  // Sizes and units that turn the costs of the terms into errors in metres and radians.
  void DescribeTerms() {
    constexpr int kResiduals[kNumTerms] = {3, 3, 2, 1, 2};
    for (int t = 0; t < kNumTerms; ++t) summary_.terms[t].residuals_per_block = kResiduals[t];
    const auto describe = [this](Term term, double sigma, const char* unit) {
      summary_.terms[static_cast<int>(term)].sigma = sigma;
      summary_.terms[static_cast<int>(term)].unit = unit;
    };
    describe(Term::kRangeBeam, factors_.beam.sigma_range_m, "m (as range)");
    describe(Term::kManifold, factors_.manifold.sigma_m, "m (robust)");
    describe(Term::kShape, factors_.shape.sigma_rad, "rad (robust)");
  }

  void Conclude() {
    summary_.final_marginal_energy = best_energy_;
    summary_.total_time_s = SecondsSince(start_);
    summary_.termination = Termination();
    std::ostringstream message;
    message << summary_.verdict.Text();
    if (summary_.started_from_constraints) {
      message << ", started from odometry and relative poses, which the seed contradicts";
    }
    if (!summary_.verdict.IsBetter()) {
      message << ": the seed is returned as it was";
    } else {
      message << ", best in round " << best_round_ << " of "
              << summary_.rounds.size() + summary_.patch_rounds.size() << LocalText(summary_);
    }
    message << "; last round: " << last_inner_.stop_reason;
    summary_.message = message.str();
  }

  TerminationType Termination() const {
    const bool better = summary_.verdict.IsBetter();
    if (!better && !last_inner_.usable) return TerminationType::kFailure;
    if (last_inner_.stopped) return TerminationType::kUserStopped;
    if (!better) return TerminationType::kNoImprovement;
    return converged_ ? TerminationType::kConverged : TerminationType::kMaxIterations;
  }

  const SolverOptions& options_;
  FactorOptions factors_;  // the options', and steps of the odometry that turned out to be wrong
  const std::optional<std::vector<double>>& suggested_;
  const SlamGraph& graph_;
  const MapState& seed_;
  const double fine_radius_m_;
  ThreadPool pool_;
  const Clock::time_point start_ = Clock::now();
  MeasuredSurface own_surface_;
  const MeasuredSurface* surface_;               // what the caller has measured, or own_surface_
  const MeasuredSurface* associated_ = nullptr;  // rounds of associations: what takes part in them
  SurfacePatches seed_patches_;                  // the surfaces as the seed places them
  SurfacePatches judged_patches_;                // over patches: as what is judged does
  SurfacePatches last_patches_;                  // over patches: as the result does
  SolverSummary summary_;
  InnerResult last_inner_;
  bool ended_ = false;      // by the callback, or because the energy cannot be evaluated
  bool converged_ = false;  // the last fine round gained next to nothing
  double best_energy_ = 0.0;
  int best_round_ = 0;     // 0: the start
  int rounds_before_ = 0;  // over patches: of earlier minimisations
  // What the solvers move. Over patches its points are empty until the poses are found.
  MapState state_;
  MapState best_;  // rounds of associations: of all rounds
};

// A null surface has not been measured yet.
SolverSummary SolveOn(const SolverOptions& options, const MeasuredSurface* surface,
                      const SlamGraph& graph, MapState* state) {
  return CatchFailures(options, [&] {
    const bool poses_only = MovesPosesOnly(options.type);
    Status status = CheckSolverInput(options, graph, *state);
    if (status.ok() && surface != nullptr && !poses_only) status = CheckSurface(*surface, graph);
    std::optional<std::vector<double>> suggested;
    if (status.ok() && !poses_only) {
      suggested = StartFromConstraints(graph, state->poses, options.factors.motion);
      status = CheckScansAreNotMirrored(graph, state->poses, suggested);
    }
    if (!status.ok()) return SolverFailure(options, status);
    if (!IsAtFixedPoses(graph, *state)) {
      MapState placed = *state;
      PutAtFixedPoses(graph, &placed);
      SolverSummary summary = SolveOn(options, surface, graph, &placed);
      if (summary.IsSolutionUsable()) *state = std::move(placed);
      return summary;
    }
    if (poses_only) return SolvePosesOnly(options, graph, state);
    return JointSolver(options, surface, suggested, graph, *state).Run(state);
  });
}

}  // namespace

ReturnNormalOptions NormalOptionsFor(const RangeBeamOptions& beam) {
  ReturnNormalOptions options;
  options.half_window_m = std::max(0.06, 6.0 * beam.sigma_range_m);
  return options;
}

double FineRadius(const SolverOptions& options) {
  return std::max(options.rounds.fine_radius_m, SmallestUsefulRadius(options.factors));
}

SolverSummary Solve(const SolverOptions& options, const SlamGraph& graph, MapState* state) {
  const DefaultFloatEnvironment float_environment;
  return SolveOn(options, nullptr, graph, state);
}

SolverSummary Solve(const SolverOptions& options, const MeasuredSurface& surface,
                    const SlamGraph& graph, MapState* state) {
  const DefaultFloatEnvironment float_environment;
  return SolveOn(options, &surface, graph, state);
}

}  // namespace plumbline
