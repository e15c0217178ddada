#include "plumbline/apps/benchmark/solver_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "plumbline/core/median.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The larger of two middle values, so that a median with half of its values infinite is so, too.
// Infinity if there are none.
double UpperMedian(std::vector<double> values) {
  if (values.empty()) return kInfinity;
  return Median(std::move(values));
}

std::optional<double> IfFinite(double value) {
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

std::optional<double> Ratio(double value, const std::optional<double>& reference) {
  return reference && *reference > 0.0 ? IfFinite(value / *reference) : std::nullopt;
}

using Runs = std::vector<const SolverRun*>;

template <typename Figure>
double MedianOf(const Runs& runs, const Figure& figure) {
  std::vector<double> values;
  for (const SolverRun* run : runs) values.push_back(figure(*run));
  return UpperMedian(values);
}

// Without what needs the figures of other solvers.
SolverFigures FiguresOf(const std::string& solver, const std::vector<SolverRun>& all, Runs* runs) {
  SolverFigures figures;
  figures.solver = solver;
  for (const SolverRun& run : all) {
    if (run.solver != solver) continue;
    if (run.failure.empty()) {
      runs->push_back(&run);
    } else {
      figures.failures.push_back(run.failure);
    }
  }
  if (runs->empty()) return figures;
  figures.time_s = MedianOf(*runs, [](const SolverRun& run) { return run.time_s(); });
  figures.final_energy = MedianOf(*runs, [](const SolverRun& run) { return run.final_energy(); });
  figures.peak_memory_bytes = MedianOf(
      *runs, [](const SolverRun& run) { return static_cast<double>(run.peak_memory_bytes); });
  figures.median_run = *std::find_if(runs->begin(), runs->end(), [&](const SolverRun* run) {
    return run->time_s() == figures.time_s;
  });
  return figures;
}

}  // namespace

bool ComparisonOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(repeats, 1, 1000000);
  PLUMBLINE_CHECK_OPTION(time_limit_s, >, 0.0);
  PLUMBLINE_CHECK_OPTION(time_limit_s, <=, 86400.0);
  return true;
}

std::vector<SolverRun> CompareSolvers(const std::vector<ComparedSolver>& solvers,
                                      const ComparedProblem& problem,
                                      const ComparisonOptions& options,
                                      const std::function<void(const SolverRun&)>& done) {
  std::vector<SolverRun> runs;
  for (int repeat = 1; repeat <= options.repeats; ++repeat) {
    for (const ComparedSolver& solver : solvers) {
      runs.push_back(RunSolverInChild(solver, problem, options.time_limit_s));
      runs.back().repeat = repeat;
      if (done) done(runs.back());
    }
  }
  return runs;
}

std::optional<double> TimeToReach(const SolverRun& run, double energy) {
  constexpr double kWithin = 1e-4;
  for (const TracePoint& point : run.trace) {
    if (point.marginal_energy <= energy * (1.0 + kWithin)) return point.time_s;
  }
  return std::nullopt;
}

std::vector<SolverFigures> SumUp(const std::vector<ComparedSolver>& solvers,
                                 const std::vector<SolverRun>& runs) {
  std::vector<Runs> runs_of(solvers.size());
  std::vector<SolverFigures> all;
  for (std::size_t i = 0; i < solvers.size(); ++i) {
    all.push_back(FiguresOf(solvers[i].name, runs, &runs_of[i]));
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const SolverFigures& other : all) {
      all[i].time_to_reach_s.push_back(
          other.median_run == nullptr
              ? std::nullopt
              : IfFinite(MedianOf(runs_of[i], [&](const SolverRun& run) {
                  return TimeToReach(run, other.final_energy).value_or(kInfinity);
                })));
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::optional<double> own = all[i].time_to_reach_s[i];
    if (!own || all[0].median_run == nullptr) continue;
    all[i].time_ratio = Ratio(*own, all[0].time_to_reach_s[i]);
    all[i].memory_ratio = Ratio(all[i].peak_memory_bytes, all[0].peak_memory_bytes);
  }
  return all;
}

double BestEnergy(const std::vector<SolverRun>& runs) {
  double best = kInfinity;
  for (const SolverRun& run : runs) {
    if (!run.failure.empty()) continue;
    for (const TracePoint& point : run.trace) best = std::min(best, point.marginal_energy);
  }
  return best;
}

}  // namespace plumbline
