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
  /// Like Start, for a minimisation that goes on after something else that the function depends on
  /// has moved: the preconditioner stays.
  virtual bool Resume(const std::vector<double>& x, double* cost, std::vector<double>* gradient) {
    return Evaluate(x, cost, gradient);
  }
  /// Second derivative along `direction`, or its Gauss-Newton approximation.
  virtual double Curvature(const std::vector<double>& x, const std::vector<double>& direction) = 0;
  /// result = P^-1 gradient, for the gradient at x: with the symmetric positive semidefinite P^-1
  /// of Start, or another descent from x, taken backwards.
  virtual void Precondition(const std::vector<double>& x, const std::vector<double>& gradient,
                            std::vector<double>* result) = 0;
};

/// Share beta of the last direction in the next one, with g the gradient and z = P^-1 g.
enum class CgFormula {
  kFletcherReeves,  ///< g.z / g_before.z_before (1964)
  /// (g.z - g.z_before) / g_before.z_before, at least 0 (1969). The same on a quadratic function.
  /// Elsewhere, and with a P^-1 that is not constant or not linear, it is the better one: where a
  /// step has brought little it restarts by itself.
  kPolakRibiere,
};

struct NonlinearCgOptions {
  CgFormula formula = CgFormula::kPolakRibiere;
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

/// What a minimisation needs to go on where an earlier one of the same variables ended, along
/// directions that are conjugate to those taken before.
struct CgMemory {
  std::vector<double> direction;       ///< the last one; empty: nothing to go on from
  std::vector<double> preconditioned;  ///< P^-1 gradient where it was chosen
  double decrease_rate = 0.0;          ///< gradient^T P^-1 gradient, likewise
};

/// Preconditioned nonlinear conjugate gradients (Fletcher, Reeves 1964; Polak, Ribiere 1969), with
/// the step length by Newton-Raphson along the line (one curvature product) and a guard: a step
/// that does not lower the cost is halved until it does, so the cost never rises. The direction
/// restarts along the preconditioned gradient when it is no descent or the formula says so. x is
/// changed in place and always the best point seen. The result does not depend on the number of
/// threads of the pool. memory: if given, the minimisation goes on from there, and leaves what the
/// next one needs.
CgResult MinimizeByCg(const NonlinearCgOptions& options, CgObjective* objective,
                      const CgCallback& callback, ThreadPool* pool, std::vector<double>* x,
                      CgMemory* memory = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_NONLINEAR_CG_H_
