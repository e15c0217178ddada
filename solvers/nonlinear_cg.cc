#include "plumbline/solvers/nonlinear_cg.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

using Vector = std::vector<double>;

double Dot(const Vector& a, const Vector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double MaxNorm(const Vector& a) {
  double norm = 0.0;
  for (const double value : a) norm = std::max(norm, std::abs(value));
  return norm;
}

// Consecutive gradients of a quadratic are P^-1-orthogonal; beyond this share they are not.
constexpr double kPowellShare = 0.2;

class CgMinimizer {
 public:
  CgMinimizer(const NonlinearCgOptions& options, CgObjective* objective, Vector* x)
      : options_(options), objective_(objective), x_(x) {}

  CgResult Run(const CgCallback& callback) {
    if (!objective_->Start(*x_, &result_.cost, &gradient_)) return Finish(CgTermination::kFailure);
    objective_->Precondition(gradient_, &preconditioned_);
    decrease_rate_ = Dot(gradient_, preconditioned_);
    Restart();
    while (result_.iterations < options_.max_iterations) {
      if (MaxNorm(gradient_) <= options_.gradient_tolerance) {
        return Finish(CgTermination::kGradientConverged);
      }
      CgIteration iteration;
      if (!TakeStep(&iteration)) {
        // Along a stale direction the quadratic model may be off; along the gradient it is not.
        if (beta_ == 0.0) return Finish(CgTermination::kNoDescent);
        Restart();
        continue;
      }
      ++result_.iterations;
      UpdateDirection();
      if (callback && !callback(iteration)) return Finish(CgTermination::kStopped);
      if (iteration.cost_change <= options_.relative_cost_tolerance * iteration.cost) {
        return Finish(CgTermination::kCostConverged);
      }
    }
    return Finish(CgTermination::kMaxIterations);
  }

 private:
  CgResult Finish(CgTermination termination) {
    result_.termination = termination;
    return result_;
  }

  void Restart() {
    if (beta_ != 0.0) ++result_.restarts;
    beta_ = 0.0;
    direction_ = preconditioned_;
    for (double& value : direction_) value = -value;
  }

  // Moves x along the direction if that lowers the cost, and evaluates the gradient there.
  bool TakeStep(CgIteration* iteration) {
    const double slope = Dot(gradient_, direction_);
    const double curvature = objective_->Curvature(*x_, direction_);
    if (!(slope < 0.0) || !(curvature > 0.0)) return false;
    double step = -slope / curvature;
    double trial_cost = 0.0;
    for (int halving = 0; halving <= options_.max_halvings; ++halving, step *= 0.5) {
      trial_ = *x_;
      for (std::size_t i = 0; i < trial_.size(); ++i) trial_[i] += step * direction_[i];
      ++iteration->evaluations;
      if (objective_->Evaluate(trial_, &trial_cost, &trial_gradient_) &&
          trial_cost <= result_.cost) {
        iteration->cost = trial_cost;
        iteration->cost_change = result_.cost - trial_cost;
        iteration->step_size = step;
        iteration->step_norm = step * std::sqrt(Dot(direction_, direction_));
        iteration->beta = beta_;
        iteration->gradient_max_norm = MaxNorm(trial_gradient_);
        x_->swap(trial_);
        result_.cost = trial_cost;
        return true;
      }
    }
    return false;
  }

  void UpdateDirection() {
    const double mixed = Dot(trial_gradient_, preconditioned_);
    gradient_.swap(trial_gradient_);
    objective_->Precondition(gradient_, &preconditioned_);
    const double previous_rate = decrease_rate_;
    decrease_rate_ = Dot(gradient_, preconditioned_);
    if (std::abs(mixed) >= kPowellShare * decrease_rate_) {
      Restart();
      return;
    }
    beta_ = previous_rate > 0.0 ? std::min(1.0, decrease_rate_ / previous_rate) : 0.0;
    for (std::size_t i = 0; i < direction_.size(); ++i) {
      direction_[i] = -preconditioned_[i] + beta_ * direction_[i];
    }
    if (!(Dot(gradient_, direction_) < 0.0)) Restart();
  }

  const NonlinearCgOptions& options_;
  CgObjective* objective_;
  Vector* x_;
  CgResult result_;
  Vector gradient_, preconditioned_, direction_, trial_, trial_gradient_;
  double decrease_rate_ = 0.0;  // gradient^T P^-1 gradient
  double beta_ = 0.0;
};

}  // namespace

bool NonlinearCgOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(max_iterations, >, 0);
  PLUMBLINE_CHECK_FINITE_OPTION(relative_cost_tolerance, >=, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(gradient_tolerance, >=, 0.0);
  PLUMBLINE_CHECK_OPTION(max_halvings, >=, 0);
  return true;
}

CgResult MinimizeByCg(const NonlinearCgOptions& options, CgObjective* objective,
                      const CgCallback& callback, std::vector<double>* x) {
  return CgMinimizer(options, objective, x).Run(callback);
}

}  // namespace plumbline
