#include "plumbline/solvers/full/rounds_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "plumbline/core/fixed_poses.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/solvers/association/held_out_returns.h"
#include "plumbline/solvers/full/joint_run.h"
#include "plumbline/solvers/pose_graph/pose_sets.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Fine rounds end when one lowers the marginal energy by less than this fraction.
constexpr double kRoundTolerance = 2e-4;

// What a round works with: neighbourhood radius [m] and factor on the robust gates.
struct RoundScale {
  double radius_m;
  double gate_factor;
};

RoundScale ScaleOfCoarseRound(const RoundOptions& rounds, double smallest_radius_m, int round) {
  const double progress = static_cast<double>(round) / rounds.max_coarse_rounds;
  const double radius_m =
      rounds.coarse_radius_m * std::pow(rounds.fine_radius_m / rounds.coarse_radius_m, progress);
  return {std::max(radius_m, smallest_radius_m), std::pow(kStartGateFactor, 1.0 - progress)};
}

// Rounds without the held-out returns, then one with all, so that none is lost to the result.
class RoundsRun final : public JointRun {
 public:
  RoundsRun(const RoundsSolver& solver, const SolverProblem& problem, const MapState& seed)
      : JointRun(solver.name(), problem, seed), solver_(solver), constants_(Constants()) {}

 private:
  void Refine() override {
    if (summary_.started_from_constraints) {
      state_.points = graph_.MeasuredMap(state_.poses);
    } else {
      state_.points = seed_.points;
      seed_landmarks_ = CutSurfaces(seed_.poses);
    }
    Keep(MarginalEnergyUnder(CurrentLines()));

    // A return without a normal has no line, and then says nothing of poses and lines.
    const MeasuredSurface fitted{WithoutHeldOut(graph_, surface_->normals, ReturnNormal())};
    associated_ = &fitted;
    RunFittedRounds();
    Candidate found = Evaluator().Evaluate(state_.poses, CutSurfaces(state_.poses));
    const std::vector<DownweightedStep> downweighted = StepsAgainst(&found);
    if (!downweighted.empty()) RunRoundsDownweighting(downweighted, &found);
    associated_ = surface_;

    RunAcceptanceTest(&found);
    if (!summary_.acceptance.IsBetter()) {
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

  // Once more from the seed; what is the better one by the energy without these steps stays.
  void RunRoundsDownweighting(const std::vector<DownweightedStep>& steps, Candidate* found) {
    const MapState plain = state_;
    const double energy = best_energy_;
    const int round = best_round_;
    const bool converged = converged_;
    DownweightSteps(steps);
    state_ = seed_;
    Keep(MarginalEnergyUnder(CurrentLines()));
    RunFittedRounds();
    Candidate again = Evaluator().Evaluate(state_.poses, CutSurfaces(state_.poses));
    if (last_inner_.usable && Evaluator().IsPreferable(*found, again)) {
      *found = std::move(again);
      summary_.started_from_constraints = false;
      return;
    }
    RestoreSteps();
    state_ = plain;
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
      converged_ = !ended_ && (!kept || before - best_energy_ <= kRoundTolerance * before);
      if (converged_) break;
    }
  }

  // Share of an energy that the rounding of measured points to single precision may change.
  static constexpr double kRounding = 1e-9;

  bool IsImprovement(double energy) const { return energy < best_energy_ * (1.0 - kRounding); }

  // Runs one round from the best state so far. Returns whether it was an improvement; if not, the
  // best state is back.
  bool RunRound(const RoundScale& scale) {
    FactorOptions factors = factors_;
    factors.manifold.robust_gate_sigmas *= scale.gate_factor;
    RoundSummary row;
    row.radius_m = scale.radius_m;
    row.gate_sigmas = factors.manifold.robust_gate_sigmas;
    auto start = Clock::now();
    const Associations associations = Associate(scale.radius_m);
    summary_.association_time_s += SecondsSince(start);
    row.num_lines = associations.lines.CountReturns();
    row.num_shape_pairs = associations.shape_pairs.size();

    start = Clock::now();
    const Energy energy(graph_, associations, factors, &pool_, constants_);
    RecordTerms(energy, state_, &TermSummary::initial_cost);
    last_inner_ = solver_.Minimize({options_, graph_, associations, factors, energy},
                                   ReportCallback(), &state_);
    RecordTerms(energy, state_, &TermSummary::final_cost);
    PutAtFixedPoses(graph_, &state_);
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

  // A single pose that is held cannot take the map along, since the lines of a round are where the
  // map is: the pose would be torn off. Where other poses hang together with it, it need not be
  // held.
  std::vector<FixedPose> Constants() const {
    const bool is_gauge =
        graph_.fixed_poses().size() == 1 && graph_.factors().empty() && AllPosesAreTied();
    return is_gauge ? std::vector<FixedPose>() : graph_.fixed_poses();
  }
  bool AllPosesAreTied() const {
    PoseSets sets(graph_.num_poses());
    std::vector<char> tied(graph_.num_poses(), false);
    for (const auto& term : PoseTerms(graph_, factors_).terms) term->TiePoses(&sets, &tied);
    for (int pose = 0; pose < graph_.num_poses(); ++pose) {
      if (sets.Find(pose) != 0) return false;
    }
    return true;
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

  const RoundsSolver& solver_;
  const std::vector<FixedPose> constants_;       // of every round
  const MeasuredSurface* associated_ = nullptr;  // what takes part in the rounds
  bool ended_ = false;  // by the callback, or because the energy cannot be evaluated
  MapState best_;       // of all rounds
};

}  // namespace

SolverSummary RoundsSolver::Solve(const SolverProblem& problem, MapState* state) const {
  return RoundsRun(*this, problem, *state).Run(state);
}

}  // namespace plumbline
