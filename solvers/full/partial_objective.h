#ifndef PLUMBLINE_SOLVERS_FULL_PARTIAL_OBJECTIVE_H_
#define PLUMBLINE_SOLVERS_FULL_PARTIAL_OBJECTIVE_H_

#include <vector>

#include "plumbline/solvers/full/block_jacobi.h"
#include "plumbline/solvers/full/energy.h"
#include "plumbline/solvers/full/nonlinear_cg.h"

namespace plumbline {

/// The joint energy as a function of the points (N = 2) at fixed poses, or of the poses (N = 3) at
/// fixed points.
template <int N>
class PartialObjective final : public CgObjective {
 public:
  /// Keeps references. fixed: the poses if N = 2, the points if N = 3. precondition: by the
  /// diagonal blocks of the Gauss-Newton Hessian, or not at all.
  PartialObjective(const Energy& energy, const std::vector<double>& fixed, bool precondition)
      : energy_(energy), fixed_(fixed), precondition_(precondition) {}

  bool Start(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override {
    if (!EvaluateFixed(x)) return false;
    if (!precondition_) return Evaluate(x, cost, gradient, nullptr);
    std::vector<double> blocks;
    if (!Evaluate(x, cost, gradient, &blocks)) return false;
    preconditioner_.Set(blocks, energy_.pool());
    is_preconditioned_ = true;
    return true;
  }
  bool Resume(const std::vector<double>& x, double* cost, std::vector<double>* gradient) override {
    // What is resumed may have begun with another energy.
    if (precondition_ && !is_preconditioned_) return Start(x, cost, gradient);
    return EvaluateFixed(x) && Evaluate(x, cost, gradient, nullptr);
  }
  bool Evaluate(const std::vector<double>& x, double* cost,
                std::vector<double>* gradient) override {
    return Evaluate(x, cost, gradient, nullptr);
  }
  double Curvature(const std::vector<double>& x, const std::vector<double>& d) override {
    return energy_.Curvature(Poses(x), Points(x), kPoints ? nullptr : &d, kPoints ? &d : nullptr,
                             Moves);
  }
  void Precondition(const std::vector<double>& /*x*/, const std::vector<double>& gradient,
                    std::vector<double>* result) override {
    if (precondition_) {
      preconditioner_.Apply(gradient, energy_.pool(), result);
    } else {
      *result = gradient;
    }
  }

 private:
  static constexpr bool kPoints = N == 2;

  // Whether a term depends on what moves.
  static bool Moves(const Term& term) { return kPoints ? term.SeesPoints() : term.SeesPoses(); }
  const std::vector<double>& Poses(const std::vector<double>& x) const {
    return kPoints ? fixed_ : x;
  }
  const std::vector<double>& Points(const std::vector<double>& x) const {
    return kPoints ? x : fixed_;
  }
  bool EvaluateFixed(const std::vector<double>& x) {
    TermCosts costs;
    const auto stays = [](const Term& term) { return !Moves(term); };
    if (!energy_.Evaluate(Poses(x), Points(x), &costs, {}, stays)) return false;
    fixed_cost_ = costs.Total();
    return true;
  }
  bool Evaluate(const std::vector<double>& x, double* cost, std::vector<double>* gradient,
                std::vector<double>* blocks) const {
    TermCosts costs;
    EnergyDerivatives derivatives;
    (kPoints ? derivatives.point_gradient : derivatives.pose_gradient) = gradient;
    (kPoints ? derivatives.point_blocks : derivatives.pose_blocks) = blocks;
    const bool ok = energy_.Evaluate(Poses(x), Points(x), &costs, derivatives, Moves);
    *cost = fixed_cost_ + costs.Total();
    return ok;
  }

  const Energy& energy_;
  const std::vector<double>& fixed_;
  const bool precondition_;
  double fixed_cost_ = 0.0;         // of the terms that do not move
  bool is_preconditioned_ = false;  // preconditioner_ is set
  BlockJacobi<N> preconditioner_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_PARTIAL_OBJECTIVE_H_
