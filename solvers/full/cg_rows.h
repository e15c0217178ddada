#ifndef PLUMBLINE_SOLVERS_FULL_CG_ROWS_H_
#define PLUMBLINE_SOLVERS_FULL_CG_ROWS_H_

#include <chrono>

#include "plumbline/core/seconds_since.h"
#include "plumbline/solvers/full/nonlinear_cg.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// Hands the iterations of conjugate gradients on as rows of a solver's progress.
class CgRows {
 public:
  /// Keeps references. phase: what moves. report may be empty.
  CgRows(const char* phase, const ProgressCallback& report) : phase_(phase), report_(report) {}

  /// As a CgCallback.
  bool Add(const CgIteration& cg) {
    IterationSummary row;
    row.phase = phase_;
    row.cost = cg.cost;
    row.cost_change = cg.cost_change;
    row.gradient_max_norm = cg.gradient_max_norm;
    row.step_norm = cg.step_norm;
    row.step_size = cg.step_size;
    row.beta = cg.beta;
    row.evaluations = cg.evaluations;
    row.iteration_time_s = SecondsSince(start_);
    start_ = std::chrono::steady_clock::now();
    return !report_ || report_(row);
  }

 private:
  const char* phase_;
  const ProgressCallback& report_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_CG_ROWS_H_
