#include <chrono>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/acceptance/candidate.h"
#include "plumbline/solvers/full/joint_run.h"
#include "plumbline/solvers/full/point_recovery.h"
#include "plumbline/solvers/interface/built_in_solvers.h"
#include "plumbline/solvers/reduced/reduced_solver.h"
#include "plumbline/solvers/terms/terms.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Rounds over landmarks, then the points in closed form.
class LandmarkRun final : public JointRun {
 public:
  // ceres: null for Gauss-Newton.
  LandmarkRun(const char* solver_name, const CeresOptions* ceres, const SolverProblem& problem,
              const MapState& seed)
      : JointRun(solver_name, problem, seed), ceres_(ceres) {}

 private:
  void Refine() override {
    ReducedResult result = Minimize();
    if (!summary_.started_from_constraints) seed_landmarks_ = std::move(result.first_cut);
    Candidate found = Evaluator().Evaluate(result.fitted_poses, std::move(result.fitted_cut));
    const std::vector<DownweightedStep> downweighted = StepsAgainst(&found);
    if (!downweighted.empty()) MinimizeDownweighting(downweighted, &result, &found);
    RunAcceptanceTest(&found);
    seed_landmarks_ = LineLandmarks();
    last_landmarks_ = {std::move(result.last_landmarks), std::move(found.cut.landmark_of_return),
                       std::move(found.cut.shared)};
    if (summary_.acceptance.IsBetter()) {
      PutBack(summary_.put_back, graph_.fixed_poses(), seed_.poses, &state_.poses);
    } else {
      state_.poses = seed_.poses;
    }
    Associations associations;
    associations.lines = CurrentLines();
    best_energy_ = MarginalEnergyUnder(associations.lines);
    if (summary_.acceptance.IsBetter()) {
      best_round_ = static_cast<int>(summary_.landmark_rounds.size());
      FinishReduced(&associations);
    } else {
      RecordSeedTerms(associations);
    }
  }

  // From the poses at hand.
  ReducedResult Minimize() {
    rounds_before_ = static_cast<int>(summary_.landmark_rounds.size());
    ReducedResult result =
        MinimizeOverLandmarks(graph_, *surface_, factors_, options_.reduced, options_.association,
                              ReportCallback(), &pool_, &state_.poses, ceres_);
    summary_.landmark_rounds.insert(summary_.landmark_rounds.end(), result.rounds.begin(),
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
  void MinimizeDownweighting(const std::vector<DownweightedStep>& steps, ReducedResult* result,
                             Candidate* found) {
    const std::vector<double> poses = state_.poses;
    const InnerResult inner = last_inner_;
    const bool converged = converged_;
    DownweightSteps(steps);
    state_.poses = seed_.poses;
    ReducedResult second = Minimize();
    Candidate again = Evaluator().Evaluate(second.fitted_poses, std::move(second.fitted_cut));
    if (last_inner_.usable && Evaluator().IsPreferable(*found, again)) {
      *result = std::move(second);
      *found = std::move(again);
      summary_.started_from_constraints = false;
      return;
    }
    RestoreSteps();
    state_.poses = poses;
    const bool stopped = last_inner_.stopped;
    last_inner_ = inner;
    last_inner_.stopped = stopped;
    converged_ = converged;
  }

  // For want of something better, the terms after are those before.
  void RecordSeedTerms(const Associations& associations) {
    const Energy energy(graph_, associations, factors_, &pool_);
    RecordSeed(energy, &TermSummary::initial_cost);
    RecordSeed(energy, &TermSummary::final_cost);
  }

  void RecordSeed(const Energy& energy, double TermSummary::*cost) {
    // A process without returns has no points where the others have some.
    const bool lacks_points =
        SumOverPeers(graph_.peers(), static_cast<double>(seed_.points.size())) == 0.0;
    if (lacks_points) {
      // The beams have nothing against points where they put them.
      RecordTerms(energy, {seed_.poses, graph_.MeasuredMap(seed_.poses)}, cost,
                  [](const Term& term) { return term.name() != kRangeBeamTerm; });
    } else {
      RecordTerms(energy, seed_, cost);
    }
  }

  // The final points, and the costs per term before and after, under the final lines. One map at a
  // time: its points are most of what there is at the end.
  void FinishReduced(Associations* associations) {
    AddLandmarkLines(last_landmarks_, &pool_, &associations->lines);
    last_landmarks_ = LineLandmarks();
    if (factors_.shape) {
      associations->shape_pairs =
          FindShapePairs(graph_, FinalPoints(*associations), surface_->normals, &pool_);
    }
    const Energy energy(graph_, *associations, factors_, &pool_);
    RecordSeed(energy, &TermSummary::initial_cost);
    state_.points = FinalPoints(*associations, &summary_.displacements);
    RecordTerms(energy, state_, &TermSummary::final_cost);
  }

  std::vector<double> FinalPoints(const Associations& associations,
                                  PointDisplacements* displacements = nullptr) {
    return RecoverPoints(graph_, state_.poses, associations.lines, factors_, &pool_, displacements);
  }

  const CeresOptions* const ceres_;
  LineLandmarks last_landmarks_;  // the surfaces as the result places them
};

class LandmarkSolver final : public Solver {
 public:
  LandmarkSolver(const char* name, bool by_ceres) : name_(name), by_ceres_(by_ceres) {}

  const char* name() const override { return name_; }
  bool IsOverLandmarks() const override { return true; }
  SolverSummary Solve(const SolverProblem& problem, MapState* state) const override {
    const CeresOptions* ceres = by_ceres_ ? &*problem.options.ceres : nullptr;
    return LandmarkRun(name_, ceres, problem, *state).Run(state);
  }

 private:
  const char* name_;
  bool by_ceres_;
};

}  // namespace

const Solver& ReducedSolver() {
  static const LandmarkSolver solver("reduced", false);
  return solver;
}

const Solver& CeresReducedSolver() {
  static const LandmarkSolver solver("ceres, reduced", true);
  return solver;
}

}  // namespace plumbline
