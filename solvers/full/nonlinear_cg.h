#ifndef PLUMBLINE_SOLVERS_FULL_NONLINEAR_CG_H_
#define PLUMBLINE_SOLVERS_FULL_NONLINEAR_CG_H_

#include <functional>
#include <string>
#include <vector>

#include "plumbline/core/thread_pool.h"

namespace plumbline {

/// A smooth function of many variables, as nonlinear conjugate gradients needs it.
class CgObjective {
 public:
  virtual ~CgObjective() = default;
  /// Evaluates cost and gradient; false where the function is undefined.
  virtual bool Evaluate(const std::vector<double>& x, double* cost,
                        std::vector<double>* gradient) = 0;
  /// The same, and sets the preconditioner up for a minimisation that starts at x.
  virtual bool Start(const std::vector<double>& x, double* cost, std::vector<double>* gradient) = 0;
  /// Second derivative along `direction`, or its Gauss-Newton approximation.
  virtual double Curvature(const std::vector<double>& x, const std::vector<double>& direction) = 0;
  /// result = P^-1 gradient with the symmetric positive semidefinite P^-1 of Start.
  virtual void Precondition(const std::vector<double>& gradient, std::vector<double>* result) = 0;
};

struct NonlinearCgOptions {
  int max_iterations = 100;
  /// Stops when the cost falls by no more than this fraction of itself in one iteration.
  double relative_cost_tolerance = 1e-9;

  bool Check(std::string* error) const;
};

struct CgIteration {
  double cost = 0.0;
  double cost_change = 0.0;  ///< positive: the cost fell
  double gradient_max_norm = 0.0;
  double step_norm = 0.0;
  double step_size = 0.0;  ///< along the search direction
  double beta = 0.0;       ///< 0 after a restart
  int evaluations = 0;
};

enum class CgTermination {
  kCostConverged,
  kGradientConverged,
  kMaxIterations,
  kNoDescent,  ///< no step along the preconditioned gradient lowers the cost
  kStopped,    ///< by the callback
  kFailure     ///< the function is undefined at the start; x is unchanged
};

struct CgResult {
  CgTermination termination = CgTermination::kFailure;
  int iterations = 0;
  int restarts = 0;
  double cost = 0.0;
};

/// Called after every iteration; false stops.
using CgCallback = std::function<bool(const CgIteration&)>;

/// Preconditioned nonlinear conjugate gradients after Fletcher and Reeves (1964), with the step
/// length by Newton-Raphson along the line (one curvature product) and a guard: a step that does
/// not lower the cost is halved until it does, so the cost never rises. The direction restarts
/// along the preconditioned gradient when it is no descent or has lost conjugacy (Powell's test). x
/// is changed in place and always the best point seen. The result does not depend on the number of
/// threads of the pool.
CgResult MinimizeByCg(const NonlinearCgOptions& options, CgObjective* objective,
                      const CgCallback& callback, ThreadPool* pool, std::vector<double>* x);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_NONLINEAR_CG_H_
