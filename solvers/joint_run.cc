#include "plumbline/solvers/joint_run.h"

#include <sstream>
#include <utility>

#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/marginal_energy.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/solvers/verdict.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

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
  summary_.num_points = graph_.num_returns();
  DescribeTerms();
}

SolverSummary JointRun::Run(MapState* result) {
  if (surface_ == nullptr) {
    own_surface_ = MeasureSurface(graph_, NormalOptionsFor(factors_.beam), &pool_);
    surface_ = &own_surface_;
  }
  FindStart();
  Refine();
  Conclude();
  if (summary_.verdict.IsBetter()) *result = std::move(state_);
  return std::move(summary_);
}

// Where odometry and relative poses flatly contradict the seed, what they say may be the better
// start.
void JointRun::FindStart() {
  state_.poses = seed_.poses;
  if (!suggested_) return;
  seed_patches_ = CutSurfaces(seed_.poses);
  summary_.started_from_constraints =
      CompareWithSeed(graph_, *surface_, factors_, {seed_.poses, seed_patches_},
                      {*suggested_, CutSurfaces(*suggested_)}, &pool_)
          .LowersEnergy();
  if (summary_.started_from_constraints) state_.poses = *suggested_;
}

std::vector<DoubtedStep> JointRun::StepsAgainst(const Candidate& found) const {
  if (Ended()) return {};
  return StepsToDoubt(graph_, factors_, seed_.poses, found.poses, found.worse);
}

void JointRun::DoubtSteps(const std::vector<DoubtedStep>& steps) {
  summary_.doubted_steps = steps;
  factors_.doubted_steps.insert(factors_.doubted_steps.end(), steps.begin(), steps.end());
}

void JointRun::TrustSteps() {
  summary_.doubted_steps.clear();
  factors_.doubted_steps = options_.factors.doubted_steps;
}

void JointRun::PassVerdict(Candidate* found) {
  summary_.put_back = Judge().PutBackWorse(found);
  summary_.verdict = found->verdict;
  if (!summary_.verdict.IsBetter()) summary_.put_back.clear();
}

SurfacePatches JointRun::CutSurfaces(const std::vector<double>& poses) {
  SurfacePatchOptions cutting = PatchOptionsFor(factors_, options_.association);
  cutting.hold_out = true;
  return CutIntoPatches(graph_, poses, *surface_, cutting, &pool_);
}

std::vector<TangentLine> JointRun::CurrentLines() {
  const auto start = Clock::now();
  std::vector<TangentLine> lines = LinesFromRadius(graph_, state_.poses, *surface_,
                                                   options_.association, fine_radius_m_, &pool_);
  summary_.association_time_s += SecondsSince(start);
  return lines;
}

double JointRun::MarginalEnergyUnder(const std::vector<TangentLine>& lines) {
  return MarginalEnergy(graph_, state_.poses, *surface_, lines, factors_, &pool_);
}

PointDisplacements JointRun::Displacements() {
  return MeasureDisplacements(graph_, state_, *surface_, factors_, &pool_);
}

ProgressCallback JointRun::ReportCallback() {
  return [this](const IterationSummary& from) {
    IterationSummary iteration = from;
    iteration.iteration = static_cast<int>(summary_.iterations.size()) + 1;
    iteration.round += iteration.round > 0 ? rounds_before_ : 0;
    if (iteration.round == 0) {
      iteration.round = static_cast<int>(summary_.rounds.size() + summary_.patch_rounds.size()) + 1;
    }
    iteration.total_time_s = SecondsSince(start_);
    summary_.iterations.push_back(iteration);
    iteration.poses = &state_.poses;
    return !options_.callback || options_.callback(iteration);
  };
}

void JointRun::RecordTerms(const Energy& energy, const MapState& state, double TermSummary::*cost) {
  TermCosts costs;
  if (!energy.Evaluate(state.poses, state.points, &costs)) return;
  const auto counts = energy.CountTerms();
  for (int t = 0; t < kNumTerms; ++t) {
    summary_.terms[t].count = counts[t];
    summary_.terms[t].*cost = costs.cost[t];
  }
}

// Sizes and units that turn the costs of the terms into errors in metres and radians.
void JointRun::DescribeTerms() {
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

void JointRun::Conclude() {
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

TerminationType JointRun::Termination() const {
  const bool better = summary_.verdict.IsBetter();
  if (!better && !last_inner_.usable) return TerminationType::kFailure;
  if (last_inner_.stopped) return TerminationType::kUserStopped;
  if (!better) return TerminationType::kNoImprovement;
  return converged_ ? TerminationType::kConverged : TerminationType::kMaxIterations;
}

}  // namespace plumbline
