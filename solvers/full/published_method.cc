// The method as published: B. Pitzer, C. Stiller, Probabilistic mapping for mobile robots using
// spatial correlation models, ICRA 2010. What each step is taken from, by the lines of its
// Algorithm 1, and where the paper leaves a choice:
//
// Lines 1-7, the start: motion model, observation model, and one ICP over all scans. The caller
// brings it (MapLogOptions::start, kIcpGlobal).
//
// Line 9, the prior p(m) of the map at hand, eq. (5):
// - Section VI.A, eq. (6) and (7): a tangent line for every map point, through the centroid of its
//   10 to 50 nearest map points and along their first principal component. Their number is
//   proportional to the density (nearest_lines.cc). The potential is Gaussian.
// - Section VI.B, eq. (8) and (9): pairs of adjacent surface segments that are parallel or
//   orthogonal to 10 degrees, Gaussian. The paper does not say how long a segment is. Here it has
//   at least kShapeRegionM: between neighbouring points noise alone
//   would give the direction. Pairs are of one scan: which segments of two scans are adjacent is
//   left open, too.
// - sigma_M, the variance of tangent line distances, is the thickness of surfaces that the options
//   give, or that of the start (PublishedOptions::sigma_from_start).
//
// Lines 10-11, an iteration of conjugate gradients on the map with the poses fixed, and lines
// 12-13, one on the poses with the map fixed. Section VII.B: Fletcher-Reeves, plain gradients,
// directions carried on from pass to pass. The length of a step is by Newton-Raphson along the
// line: one step of it, by the Gauss-Newton curvature, halved if the energy does not fall.
// Directions restart where they are no descent.
//
// Line 14, until convergence. The energy still falls when the map has begun to bend and its corners
// to round, so convergence is that of ranges which are held out of lines and pairs: the result is
// the map of the pass that predicts them best, the start included (HeldOutRanges). It ends earlier
// by kPassTolerance. Held-out points are then drawn to the lines of the
// others.
//
// The prior of the first pose, eq. (4), is a constant pose. No gate or robust loss protects
// anything. The acceptance test is reported, and not applied.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/association/held_out_returns.h"
#include "plumbline/solvers/full/cg_rows.h"
#include "plumbline/solvers/full/held_out_ranges.h"
#include "plumbline/solvers/full/joint_run.h"
#include "plumbline/solvers/full/nonlinear_cg.h"
#include "plumbline/solvers/full/partial_objective.h"
#include "plumbline/solvers/full/point_recovery.h"
#include "plumbline/solvers/interface/built_in_solvers.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Passes that may go by without a better prediction of held-out ranges: chance alone makes one of
// two the worse one near the best.
constexpr int kPatience = 5;
// Passes end when one lowers the energy of its lines and pairs by less than this fraction.
constexpr double kPassTolerance = 1e-3;
// A map is not known to be thinner [m].
constexpr double kThinnestM = 1e-3;

FactorOptions GaussianWithShape(FactorOptions factors) {
  constexpr double kNoGate = std::numeric_limits<double>::infinity();
  factors.manifold.robust_gate_sigmas = kNoGate;
  factors.shape = true;
  return factors;
}

class PublishedRun final : public JointRun {
 public:
  PublishedRun(const char* name, const SolverProblem& problem, const MapState& seed)
      : JointRun(name, problem, seed), gaussian_(GaussianWithShape(factors_)) {}

 private:
  bool IsAccepted() const override { return best_round_ > 0; }

  void Refine() override {
    state_ = seed_;
    const HeldOutRanges ranges(graph_, factors_.beam.sigma_range_m, &pool_);
    MapState best = seed_;
    double least_error = ranges.MeanError(seed_);
    for (int pass = 1; pass <= options_.published.max_passes && !converged_; ++pass) {
      RunPass();
      if (!last_inner_.usable) break;
      const double error = ranges.MeanError(state_);
      if (error < least_error || ranges.size() == 0) {
        least_error = error;
        best = state_;
        best_round_ = pass;
      }
      if (last_inner_.stopped) break;
      converged_ = converged_ || pass - best_round_ >= kPatience;
    }
    state_ = std::move(best);
    if (best_round_ > 0) PlaceHeldOutPoints();
    best_energy_ = MarginalEnergyUnder(CurrentLines());
    for (std::size_t i = 0; i < summary_.rounds.size(); ++i) {
      RoundSummary& row = summary_.rounds[i];
      row.kept = static_cast<int>(i) < best_round_;
      if (static_cast<int>(i) + 1 == best_round_) row.marginal_energy = best_energy_;
    }
    seed_landmarks_ = CutSurfaces(seed_.poses);
    summary_.acceptance =
        CompareWithSeed(graph_, *surface_, factors_, {seed_.poses, seed_landmarks_},
                        {state_.poses, CutSurfaces(state_.poses)}, &pool_);
    summary_.displacements = Displacements();
  }

  // Lines 9 to 13.
  void RunPass() {
    auto start = Clock::now();
    const Associations prior = BuildPrior();
    summary_.association_time_s += SecondsSince(start);
    start = Clock::now();
    const Energy energy(graph_, prior, gaussian_, &pool_);
    RecordTerms(energy, state_, &TermSummary::initial_cost);
    RoundSummary row;
    row.gate_sigmas = gaussian_.manifold.robust_gate_sigmas;
    row.num_lines = prior.lines.CountReturns();
    row.num_shape_pairs = prior.shape_pairs.size();
    last_inner_ = Minimize(energy);
    RecordTerms(energy, state_, &TermSummary::final_cost);
    summary_.solve_time_s += SecondsSince(start);
    row.initial_cost = last_inner_.initial_cost;
    row.final_cost = last_inner_.final_cost;
    row.iterations = last_inner_.iterations;
    row.stop_reason = last_inner_.stop_reason;
    row.kept = last_inner_.usable;
    converged_ = last_inner_.converged;
    summary_.rounds.push_back(row);
  }

  Associations BuildPrior() {
    Associations prior;
    prior.lines = LinesOfAll();
    for (int scan = 0; scan < graph_.num_scans(); ++scan) {
      HeldOutReturns::ForEachOf(graph_, scan,
                                [&](std::size_t r) { prior.lines.Assign(r, TangentLines::kNone); });
    }
    for (const ShapePair& pair : FindShapePairs(graph_, state_.points, surface_->normals, &pool_)) {
      if (!HasHeldOut(pair)) prior.shape_pairs.push_back(pair);
    }
    if (options_.published.sigma_from_start && summary_.rounds.empty()) {
      gaussian_.manifold.sigma_m = RmsDistanceM(prior.lines);
    }
    return prior;
  }

  // Held-out returns have the lines of the others.
  TangentLines LinesOfAll() { return LinesFromNearest(graph_, state_.points, &pool_); }

  bool HasHeldOut(const ShapePair& pair) const {
    for (const std::size_t r :
         {pair.previous, pair.current, pair.adjacent_previous, pair.adjacent_current}) {
      const int scan = graph_.ScanOfReturn(r);
      const std::size_t first = HeldOutReturns::FirstOf(graph_, scan);
      if (HeldOutReturns::Contain(r - graph_.scan(scan).first_return, first)) return true;
    }
    return false;
  }

  double RmsDistanceM(const TangentLines& lines) const {
    double sum = 0.0, count = 0.0;
    for (std::size_t r = 0; r < lines.size(); ++r) {
      if (!lines.HasLine(r)) continue;
      const TangentLine& line = lines[r];
      const double distance_m = line.normal_x * state_.points[2 * r] +
                                line.normal_y * state_.points[2 * r + 1] - line.offset;
      sum += distance_m * distance_m;
      count += 1.0;
    }
    return std::max(kThinnestM, std::sqrt(sum / std::max(1.0, count)));
  }

  void PlaceHeldOutPoints() {
    const std::vector<double> points =
        RecoverPoints(graph_, state_.poses, LinesOfAll(), gaussian_, &pool_);
    for (int scan = 0; scan < graph_.num_scans(); ++scan) {
      HeldOutReturns::ForEachOf(graph_, scan, [&](std::size_t r) {
        std::copy_n(&points[2 * r], 2, &state_.points[2 * r]);
      });
    }
  }

  InnerResult Minimize(const Energy& energy) {
    InnerResult result;
    TermCosts costs;
    if (!energy.Evaluate(state_.poses, state_.points, &costs)) {
      result.stop_reason = "the energy is not finite";
      return result;
    }
    result.usable = true;
    result.initial_cost = result.final_cost = costs.Total();
    PartialObjective<2> map(energy, state_.poses, /*precondition=*/false);
    PartialObjective<3> poses(energy, state_.points, /*precondition=*/false);
    Iterate("map", &map, &map_memory_, &state_.points, &result);
    if (!result.stopped) Iterate("poses", &poses, &pose_memory_, &state_.poses, &result);
    const double change = result.initial_cost - result.final_cost;
    result.converged = !result.stopped && change <= kPassTolerance * result.initial_cost;
    std::ostringstream reason;
    if (result.stopped) {
      reason << "stopped by the callback";
    } else {
      reason << "a pass lowered the cost of " << result.initial_cost << " by " << change
             << (result.converged ? ", a fraction <= " : ", a fraction > ") << kPassTolerance;
    }
    result.stop_reason = reason.str();
    return result;
  }

  // One iteration on what moves, along a direction that goes on from the last one.
  void Iterate(const char* phase, CgObjective* objective, CgMemory* memory,
               std::vector<double>* moves, InnerResult* result) {
    NonlinearCgOptions options;
    options.formula = CgFormula::kFletcherReeves;
    options.max_iterations = 1;
    const ProgressCallback report = ReportCallback();
    CgRows rows(phase, report);
    const CgResult cg = MinimizeByCg(
        options, objective, [&](const CgIteration& iteration) { return rows.Add(iteration); },
        &pool_, moves, memory);
    if (cg.termination == CgTermination::kFailure) return;
    result->final_cost = cg.cost;
    result->iterations += cg.iterations;
    result->stopped = cg.termination == CgTermination::kStopped;
  }

  FactorOptions gaussian_;
  CgMemory map_memory_, pose_memory_;
};

class PublishedMethod final : public Solver {
 public:
  const char* name() const override { return "published"; }
  SolverSummary Solve(const SolverProblem& problem, MapState* state) const override {
    // The start is the start, whatever odometry and relative poses say of it.
    const std::optional<std::vector<double>> no_other_start;
    return PublishedRun(name(), {problem.options, problem.graph, problem.surface, no_other_start},
                        *state)
        .Run(state);
  }
};

}  // namespace

const Solver& PublishedSolver() {
  static const PublishedMethod solver;
  return solver;
}

}  // namespace plumbline
