#include "plumbline/solvers/full/nonlinear_cg.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

using Vector = std::vector<double>;

constexpr std::size_t kEntriesPerChunk = 1 << 14;

// The larger of the two; NaN if one is, so that a broken gradient does not pass for a small one.
double Larger(double a, double b) { return b > a || std::isnan(b) ? b : a; }

// Ends where no component of the gradient is larger than this [cost per unit].
constexpr double kGradientTolerance = 1e-10;
// Largest number of halvings of a step that does not lower the cost.
constexpr int kMaxHalvings = 20;

class CgMinimizer {
 public:
  CgMinimizer(const NonlinearCgOptions& options, CgObjective* objective, ThreadPool* pool,
              Vector* x, CgMemory* memory)
      : options_(options), objective_(objective), pool_(pool), x_(x), memory_(*memory) {}

  CgResult Run(const CgCallback& callback) {
    result_.termination = Minimize(callback);
    return result_;
  }

 private:
  CgTermination Minimize(const CgCallback& callback) {
    if (memory_.direction.empty()) {
      if (!objective_->Start(*x_, &result_.cost, &gradient_)) return CgTermination::kFailure;
      objective_->Precondition(*x_, gradient_, &memory_.preconditioned);
      memory_.decrease_rate = Dot(gradient_, memory_.preconditioned);
      Restart();
    } else {
      if (!objective_->Resume(*x_, &result_.cost, &trial_gradient_)) return CgTermination::kFailure;
      UpdateDirection();
    }
    gradient_max_norm_ = MaxNorm(gradient_);
    for (;;) {
      if (gradient_max_norm_ <= kGradientTolerance) {
        return CgTermination::kGradientConverged;
      }
      CgIteration iteration;
      if (!TakeStep(&iteration)) {
        // Along a stale direction the quadratic model may be off; along the gradient it is not.
        if (beta_ == 0.0) return CgTermination::kNoDescent;
        Restart();
        continue;
      }
      ++result_.iterations;
      if (callback && !callback(iteration)) return CgTermination::kStopped;
      if (iteration.cost_change <= options_.relative_cost_tolerance * std::abs(iteration.cost)) {
        return CgTermination::kCostConverged;
      }
      if (result_.iterations == options_.max_iterations) return CgTermination::kMaxIterations;
      UpdateDirection();
    }
  }

  // Calls body(begin, end) on ranges of a vector's entries, on all threads.
  template <typename Body>
  void ForEachRange(const Body& body) {
    pool_->ForEachChunk(x_->size(), kEntriesPerChunk,
                        [&](std::size_t, std::size_t begin, std::size_t end) { body(begin, end); });
  }

  double Dot(const Vector& a, const Vector& b) {
    partial_.assign(ThreadPool::NumChunks(a.size(), kEntriesPerChunk), 0.0);
    pool_->ForEachChunk(a.size(), kEntriesPerChunk,
                        [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                          double sum = 0.0;
                          for (std::size_t i = begin; i < end; ++i) sum += a[i] * b[i];
                          partial_[chunk] = sum;
                        });
    return std::accumulate(partial_.begin(), partial_.end(), 0.0);
  }

  double MaxNorm(const Vector& a) {
    partial_.assign(ThreadPool::NumChunks(a.size(), kEntriesPerChunk), 0.0);
    pool_->ForEachChunk(a.size(), kEntriesPerChunk,
                        [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                          double norm = 0.0;
                          for (std::size_t i = begin; i < end; ++i) {
                            norm = Larger(norm, std::abs(a[i]));
                          }
                          partial_[chunk] = norm;
                        });
    return std::accumulate(partial_.begin(), partial_.end(), 0.0, Larger);
  }

  void Restart() {
    if (beta_ != 0.0) ++result_.restarts;
    beta_ = 0.0;
    SetDirection();
  }

  // direction = -P^-1 gradient + beta direction.
  void SetDirection() {
    memory_.direction.resize(x_->size());
    ForEachRange([this](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const double carried = beta_ == 0.0 ? 0.0 : beta_ * memory_.direction[i];
        memory_.direction[i] = carried - memory_.preconditioned[i];
      }
    });
  }

  // Moves x along the direction if that lowers the cost, and evaluates the gradient there.
  bool TakeStep(CgIteration* iteration) {
    const Vector& direction = memory_.direction;
    const double slope = Dot(gradient_, direction);
    const double curvature = objective_->Curvature(*x_, direction);
    if (!(slope < 0.0) || !(curvature > 0.0)) return false;
    double step = -slope / curvature;
    trial_.resize(x_->size());
    for (int halving = 0; halving <= kMaxHalvings; ++halving, step *= 0.5) {
      ForEachRange([&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) trial_[i] = (*x_)[i] + step * direction[i];
      });
      ++iteration->evaluations;
      double trial_cost = 0.0;
      if (objective_->Evaluate(trial_, &trial_cost, &trial_gradient_) &&
          trial_cost <= result_.cost) {
        iteration->cost = trial_cost;
        iteration->cost_change = result_.cost - trial_cost;
        iteration->step_size = step;
        iteration->step_norm = step * std::sqrt(Dot(direction, direction));
        iteration->beta = beta_;
        iteration->gradient_max_norm = gradient_max_norm_ = MaxNorm(trial_gradient_);
        x_->swap(trial_);
        result_.cost = trial_cost;
        return true;
      }
    }
    return false;
  }

  void UpdateDirection() {
    const double mixed = Dot(trial_gradient_, memory_.preconditioned);
    gradient_.swap(trial_gradient_);
    objective_->Precondition(*x_, gradient_, &memory_.preconditioned);
    const double previous_rate = memory_.decrease_rate;
    memory_.decrease_rate = Dot(gradient_, memory_.preconditioned);
    const double beta = Beta(memory_.decrease_rate, mixed, previous_rate);
    if (beta == 0.0) {
      Restart();
      return;
    }
    beta_ = beta;
    SetDirection();
    if (!(Dot(gradient_, memory_.direction) < 0.0)) Restart();
  }

  // rate, previous_rate: g.z now and before; mixed: g.z_before.
  double Beta(double rate, double mixed, double previous_rate) const {
    if (!(previous_rate > 0.0)) return 0.0;
    const double shared = options_.formula == CgFormula::kPolakRibiere ? mixed : 0.0;
    return std::max(0.0, (rate - shared) / previous_rate);
  }

  const NonlinearCgOptions& options_;
  CgObjective* objective_;
  ThreadPool* pool_;
  Vector* x_;
  CgResult result_;
  CgMemory& memory_;
  Vector gradient_, trial_, trial_gradient_;
  Vector partial_;  // results of chunks
  double gradient_max_norm_ = 0.0;
  double beta_ = 0.0;
};

}  // namespace

bool NonlinearCgOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(max_iterations, >, 0);
  PLUMBLINE_CHECK_FINITE_OPTION(relative_cost_tolerance, >=, 0.0);
  return true;
}

CgResult MinimizeByCg(const NonlinearCgOptions& options, CgObjective* objective,
                      const CgCallback& callback, ThreadPool* pool, std::vector<double>* x,
                      CgMemory* memory) {
  CgMemory own;
  return CgMinimizer(options, objective, pool, x, memory != nullptr ? memory : &own).Run(callback);
}

}  // namespace plumbline
