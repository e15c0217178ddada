#include "plumbline/solvers/interface/solver_options.h"

#include "plumbline/core/options_check.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/interface/solver.h"

namespace plumbline {
namespace {

constexpr int kMostIterations = 1000000000;  // the sum of two is an int

bool Refuse(const std::string& reason, std::string* error) {
  if (error != nullptr) *error = reason;
  return false;
}

}  // namespace

bool ReducedOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(max_rounds, 1, kMostIterations);
  PLUMBLINE_CHECK_OPTION_WITHIN(relative_tolerance, 0.0, 1.0);
  return true;
}

bool AlternatingCgOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(max_sweeps, 1, kMostIterations);
  PLUMBLINE_CHECK_OPTION_WITHIN(scan_iterations_per_sweep, 0, kMostIterations);
  PLUMBLINE_CHECK_OPTION_WITHIN(relative_cost_tolerance, 0.0, 1.0);
  return true;
}

bool PublishedOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(max_passes, 1, kMostIterations);
  return true;
}

CeresOptionsValue::CeresOptionsValue() : options_(std::make_unique<CeresOptions>()) {}

CeresOptionsValue::CeresOptionsValue(const CeresOptionsValue& other)
    : options_(std::make_unique<CeresOptions>(*other)) {}

CeresOptionsValue& CeresOptionsValue::operator=(const CeresOptionsValue& other) {
  *options_ = *other;
  return *this;
}

CeresOptionsValue::~CeresOptionsValue() = default;

bool CeresOptionsValue::Check(std::string* error) const { return options_->Check(error); }

bool RoundOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(max_coarse_rounds, 0, kMostIterations);
  PLUMBLINE_CHECK_OPTION_WITHIN(max_fine_rounds, 1, kMostIterations);
  PLUMBLINE_CHECK_OPTION_WITHIN(fine_radius_m, 1e-3, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(coarse_radius_m, fine_radius_m, 100.0);
  return true;
}

bool SolverOptions::IsOverLandmarks() const { return SolverOf(*this).IsOverLandmarks(); }

bool SolverOptions::MovesPosesOnly() const { return SolverOf(*this).MovesPosesOnly(); }

bool SolverOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(num_threads, 1, 1024);
  PLUMBLINE_CHECK_NESTED_OPTIONS(factors);
  PLUMBLINE_CHECK_NESTED_OPTIONS(association);
  PLUMBLINE_CHECK_NESTED_OPTIONS(rounds);
  PLUMBLINE_CHECK_NESTED_OPTIONS(reduced);
  PLUMBLINE_CHECK_NESTED_OPTIONS(alternating_cg);
  PLUMBLINE_CHECK_NESTED_OPTIONS(published);
  PLUMBLINE_CHECK_NESTED_OPTIONS(ceres);
  const Solver& solver = SolverOf(*this);
  if (&solver == &CeresSolver() || &solver == &CeresReducedSolver()) {
    const Status status = CheckCeresOptions(*ceres);
    if (!status.ok()) return Refuse(status.message(), error);
  }
  if (&solver == &CeresReducedSolver() && !reduced.lines_follow) {
    return Refuse(
        "reduced.lines_follow = false goes with the built-in steps; lines are parameters "
        "of Ceres' reduced problem",
        error);
  }
  return true;
}

}  // namespace plumbline
