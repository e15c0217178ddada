#include "plumbline/solvers/full/joint_run.h"

#include <sstream>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/acceptance/compare_with_seed.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/marginal_energy.h"
#include "plumbline/solvers/full/point_recovery.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// What was done for the sake of single places.
std::string LocalText(const SolverSummary& summary) {
  std::string text;
  if (!summary.downweighted_steps.empty()) {
    text += ", with " + std::to_string(summary.downweighted_steps.size()) +
            " odometry steps downweighted that the map contradicts";
  }
  if (!summary.put_back.empty()) {
    text += ", with " + std::to_string(summary.put_back.size()) +
            " stretches put back to the seed that had become worse";
  }
  return text;
}

}  // namespace

JointRun::JointRun(const char* solver_name, const SolverProblem& problem, const MapState& seed)
    : options_(problem.options),
      factors_(problem.options.factors),
      graph_(problem.graph),
      seed_(seed),
      fine_radius_m_(FineRadius(problem.options)),
      pool_(problem.options.num_threads),
      surface_(problem.surface),
      suggested_(problem.suggested_poses) {
  summary_.solver = solver_name;
  summary_.num_poses = graph_.num_poses();
  summary_.num_points = static_cast<std::size_t>(
      SumOverPeers(graph_.peers(), static_cast<double>(graph_.num_returns())));
}

SolverSummary JointRun::Run(MapState* result) {
  if (surface_ == nullptr) {
    own_surface_ = MeasureSurface(graph_, NormalOptionsFor(factors_.beam), &pool_);
    surface_ = &own_surface_;
  }
  FindStart();
  Refine();
  Conclude();
  if (IsAccepted()) *result = std::move(state_);
  return std::move(summary_);
}

// Where odometry and relative poses flatly contradict the seed, what they say may be the better
// start.
void JointRun::FindStart() {
  state_.poses = seed_.poses;
  if (!suggested_) return;
  seed_landmarks_ = CutSurfaces(seed_.poses);
  summary_.started_from_constraints =
      CompareWithSeed(graph_, *surface_, factors_, {seed_.poses, seed_landmarks_},
                      {*suggested_, CutSurfaces(*suggested_)}, &pool_)
          .LowersEnergy();
  if (summary_.started_from_constraints) state_.poses = *suggested_;
}

std::vector<DownweightedStep> JointRun::StepsAgainst(Candidate* found) const {
  if (Ended()) return {};
  StepsAgainstState against =
      FindStepsAgainst(graph_, factors_, seed_.poses, found->poses, found->worse);
  // A seed that is no start is no yardstick either.
  found->is_refuted = against.refute_state && !summary_.started_from_constraints;
  return std::move(against.steps);
}

void JointRun::DownweightSteps(const std::vector<DownweightedStep>& steps) {
  summary_.downweighted_steps = steps;
  factors_.downweighted_steps.insert(factors_.downweighted_steps.end(), steps.begin(), steps.end());
}

void JointRun::RestoreSteps() {
  summary_.downweighted_steps.clear();
  factors_.downweighted_steps = options_.factors.downweighted_steps;
}

void JointRun::RunAcceptanceTest(Candidate* found) {
  const bool seed_is_bent =
      summary_.started_from_constraints && !factors_.ignored_relative_poses.empty();
  if (seed_is_bent) found->ForgetWorseStretches();
  summary_.put_back = Evaluator().PutBackWorse(found);
  summary_.acceptance = found->acceptance;
  if (!summary_.acceptance.IsBetter()) summary_.put_back.clear();
}

LineLandmarks JointRun::CutSurfaces(const std::vector<double>& poses) {
  LineLandmarkOptions cutting = LandmarkOptionsFor(factors_, options_.association);
  cutting.hold_out = true;
  cutting.joins_without_normal = false;  // CompareWithSeed does not ask for them
  return CutIntoLandmarks(graph_, poses, *surface_, cutting, &pool_);
}

TangentLines JointRun::CurrentLines() {
  const auto start = Clock::now();
  TangentLines lines = LinesFromRadius(graph_, state_.poses, *surface_, options_.association,
                                       fine_radius_m_, &pool_);
  summary_.association_time_s += SecondsSince(start);
  return lines;
}

double JointRun::MarginalEnergyUnder(const TangentLines& lines) {
  return MarginalEnergy(graph_, state_.poses, lines, factors_, &pool_);
}

PointDisplacements JointRun::Displacements() {
  return MeasureDisplacements(graph_, state_, factors_, &pool_);
}

ProgressCallback JointRun::ReportCallback() {
  return [this](const IterationSummary& from) {
    IterationSummary iteration = from;
    iteration.iteration = static_cast<int>(summary_.iterations.size()) + 1;
    iteration.round += iteration.round > 0 ? rounds_before_ : 0;
    if (iteration.round == 0) {
      iteration.round =
          static_cast<int>(summary_.rounds.size() + summary_.landmark_rounds.size()) + 1;
    }
    iteration.total_time_s = SecondsSince(start_);
    summary_.iterations.push_back(iteration);
    iteration.poses = &state_.poses;
    return !options_.callback || options_.callback(iteration);
  };
}

void JointRun::RecordTerms(const Energy& energy, const MapState& state, double TermSummary::*cost,
                           const TermChoice& choice) {
  const TermList& terms = energy.terms();
  if (summary_.terms.empty()) {
    for (const auto& term : terms) {
      TermSummary& row = summary_.terms.emplace_back();
      row.name = term->name();
      row.unit = term->unit();
      row.sigma = term->sigma();
      row.residuals_per_block = term->residuals_per_block();
    }
  }
  TermCosts costs;
  const bool succeeded = energy.Evaluate(state.poses, state.points, &costs, {}, choice);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    if (cost == &TermSummary::final_cost) {
      const auto num_blocks = static_cast<double>(terms[t]->num_blocks());
      summary_.terms[t].count = static_cast<std::size_t>(
          terms[t]->GoesByScan() ? SumOverPeers(graph_.peers(), num_blocks) : num_blocks);
    }
    if (succeeded) summary_.terms[t].*cost = costs.cost[t];
  }
}

void JointRun::Conclude() {
  summary_.final_marginal_energy = best_energy_;
  summary_.total_time_s = SecondsSince(start_);
  summary_.termination = Termination();
  std::ostringstream message;
  message << summary_.acceptance.Text();
  if (summary_.started_from_constraints) {
    message << ", started from odometry and relative poses, which the seed contradicts";
  }
  if (!IsAccepted()) {
    message << ": the seed is returned as it was";
  } else {
    message << ", best in round " << best_round_ << " of "
            << summary_.rounds.size() + summary_.landmark_rounds.size() << LocalText(summary_);
  }
  message << "; last round: " << last_inner_.stop_reason;
  summary_.message = message.str();
}

TerminationType JointRun::Termination() const {
  const bool better = IsAccepted();
  if (!better && !last_inner_.usable) return TerminationType::kFailure;
  if (last_inner_.stopped) return TerminationType::kUserStopped;
  if (!better) return TerminationType::kNoImprovement;
  return converged_ ? TerminationType::kConverged : TerminationType::kMaxIterations;
}

}  // namespace plumbline
