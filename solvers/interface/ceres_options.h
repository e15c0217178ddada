#ifndef PLUMBLINE_SOLVERS_INTERFACE_CERES_OPTIONS_H_
#define PLUMBLINE_SOLVERS_INTERFACE_CERES_OPTIONS_H_

#include <ceres/types.h>

#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Ceres' own switches, under Ceres' own names. Its documentation says what combines with what; a
/// combination that it refuses is reported as an error.
struct CeresOptions {
  /// @{
  /// See ceres::Solver::Options.
  ceres::MinimizerType minimizer = ceres::TRUST_REGION;
  ceres::TrustRegionStrategyType trust_region_strategy = ceres::LEVENBERG_MARQUARDT;
  ceres::DoglegType dogleg = ceres::TRADITIONAL_DOGLEG;
  ceres::LineSearchDirectionType line_search_direction = ceres::LBFGS;
  ceres::LineSearchType line_search = ceres::WOLFE;
  ceres::NonlinearConjugateGradientType nonlinear_conjugate_gradient = ceres::FLETCHER_REEVES;
  ceres::LinearSolverType linear_solver = ceres::SPARSE_SCHUR;
  ceres::PreconditionerType preconditioner = ceres::JACOBI;
  /// @}
  /// Ceres minimises over the poses and the lines of landmarks, points eliminated, between the
  /// re-weightings of the reduced solver's rounds (ReducedOptions); else over the poses and points
  /// in rounds of associations (RoundOptions).
  bool reduced = false;
  int max_iterations = 5;  ///< per round
  /// Ends when an iteration lowers the cost by less than this fraction.
  double function_tolerance = 1e-4;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// Fails on a combination of switches that the installed Ceres refuses, with its own words, or that
/// would abort in it.
Status CheckCeresOptions(const CeresOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_CERES_OPTIONS_H_
