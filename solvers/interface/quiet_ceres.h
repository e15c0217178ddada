#ifndef PLUMBLINE_SOLVERS_INTERFACE_QUIET_CERES_H_
#define PLUMBLINE_SOLVERS_INTERFACE_QUIET_CERES_H_

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace plumbline {

/// Calls ceres::Solve with Ceres' log lines below FATAL suppressed if the host has not initialised
/// glog, which would write them to standard error. summary->message has the reason of a failure.
/// glog is left alone, Ceres' lines included, if the host has initialised it.
///
/// Thread-safe. Throws what a callback of `options` throws. While Ceres runs in any thread, lines
/// that such a host logs below FATAL are suppressed, too. They are not while a callback of
/// `options` runs, unless another thread is inside Ceres.
void SolveQuietly(ceres::Solver::Options options, ceres::Problem* problem,
                  ceres::Solver::Summary* summary);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_QUIET_CERES_H_
