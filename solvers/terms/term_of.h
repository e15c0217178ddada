#ifndef PLUMBLINE_SOLVERS_TERMS_TERM_OF_H_
#define PLUMBLINE_SOLVERS_TERMS_TERM_OF_H_

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "plumbline/factors/analytic_factor.h"
#include "plumbline/factors/geman_mcclure_loss.h"
#include "plumbline/solvers/pose_graph/pose_sets.h"
#include "plumbline/solvers/terms/term.h"
#include "plumbline/solvers/terms/term_parts.h"

namespace plumbline {

/// All of a term but what is its own: Derived has
///   name(), num_blocks(), and unit(), sigma(), ... where the defaults of Term do not hold,
///   loss(): NoLoss or GemanMcClure,
///   bool ForEach(int scan, const double* poses, const Visit& visit) const: calls
///     visit(measurement, residual, block ids...) for the residuals of a batch, until one is false.
///     `residual` is what Factor is made of, or is derived from that with an Evaluate of its own.
/// Factor is an AnalyticFactor; Ids are the PoseId and PointId of its blocks.
template <typename Derived, typename Factor, typename... Ids>
class TermOf;

template <typename Derived, typename Residual, int M, int... kSizes, typename... Ids>
class TermOf<Derived, AnalyticFactor<Residual, M, kSizes...>, Ids...> : public Term {
  static_assert(sizeof...(kSizes) == sizeof...(Ids) && ((kSizes == Ids::kSize) && ...),
                "the factor's blocks are not those of the term");

 public:
  int residuals_per_block() const final { return M; }
  bool SeesPoses() const final { return kNumPoses > 0; }
  bool SeesPoints() const final { return kNumPoints > 0; }
  bool JoinsPoints() const final { return kNumPoints > 1; }
  bool GoesByScan() const final { return kNumPoints > 0; }

  bool Linearize(int scan, const StateView& at, const TermDerivatives& out,
                 double* cost) const final {
    return With(out.WantsPoses(), out.WantsPoints(),
                [&](auto wanted) { return LinearizeAs<decltype(wanted)>(scan, at, out, cost); });
  }

  void AddCurvature(int scan, const StateView& at, const StateView& direction,
                    double* sum) const final {
    With(direction.poses != nullptr, direction.points != nullptr,
         [&](auto wanted) { AddCurvatureAs<decltype(wanted)>(scan, at, direction, sum); });
  }

  void AddCarriedBlock(int scan, const double* pose, const double* points,
                       double* block) const final {
    if constexpr (kNumPoses == 0 && kNumPoints == 1) {
      const auto loss = derived().loss();
      double r[M], n[2 * M];
      derived().ForEach(scan, nullptr, [&](std::size_t, const auto& residual, PointId id) {
        const double* point = points + 2 * id.id;
        if (!residual.Evaluate(point, r, n)) return false;
        const double weight = loss.Weight(Square(r));
        for (int k = 0; k < M; ++k) {
          const double* d = n + 2 * k;
          // Chain rule: a point turns about its robot, dm/dyaw = (-(m - t)_y, (m - t)_x).
          const double j[3] = {d[0], d[1],
                               -(point[1] - pose[1]) * d[0] + (point[0] - pose[0]) * d[1]};
          int entry = 0;
          for (int a = 0; a < 3; ++a) {
            for (int b = a; b < 3; ++b) block[entry++] += weight * j[a] * j[b];
          }
        }
        return true;
      });
    }
  }

  void Evaluate(int scan, const StateView& at, double* residuals) const final {
    double unused[kNumBlocks][3 * M];
    derived().ForEach(scan, at.poses, [&](std::size_t i, const auto& residual, Ids... ids) {
      double* r = residuals + M * i;
      if (!EvaluateAt<Wanted<false, false>>(residual, at, r, unused, kBlocks, ids...)) {
        std::fill_n(r, M, std::numeric_limits<double>::quiet_NaN());
      }
      return true;
    });
  }

  std::unique_ptr<ceres::LossFunction> MakeLoss() const final {
    if constexpr (IsRobust()) return std::make_unique<GemanMcClureLoss>(derived().loss());
    return nullptr;
  }

  void AddTo(int scan, TermProblem* to) const final {
    derived().ForEach(scan, to->poses, [&](std::size_t, const auto& residual, Ids... ids) {
      to->residual_blocks->push_back(to->problem->AddResidualBlock(
          new AnalyticFactor<Residual, M, kSizes...>(residual), to->loss, BlockOf(*to, ids)...));
      return true;
    });
  }

  void AddSquares(const double* poses, double* total) const final {
    if constexpr (kNumPoints == 0) {
      const auto loss = derived().loss();
      double sum = *total;
      derived().ForEach(kNoScan, poses, [&](std::size_t, const auto& residual, Ids... ids) {
        Eigen::Matrix<double, M, 1> r;
        double unused[kNumBlocks][3 * M];
        const bool ok = EvaluateAt<Wanted<false, false>>(residual, {poses, nullptr}, r.data(),
                                                         unused, kBlocks, ids...);
        sum += ok ? loss.Rho(r.squaredNorm()) : std::numeric_limits<double>::quiet_NaN();
        return true;
      });
      *total = sum;
    }
  }

  void AddEquations(const double* poses, PoseEquations* equations) const final {
    if constexpr (kNumPoints == 0) {
      derived().ForEach(kNoScan, poses, [&](std::size_t, const auto& residual, Ids... ids) {
        AddEquationsOf(residual, poses, equations, ids...);
        return true;
      });
    }
  }

  void TiePoses(PoseSets* sets, std::vector<char>* tied) const final {
    if constexpr (kNumPoints == 0) {
      derived().ForEach(kNoScan, nullptr, [&](std::size_t, const auto&, Ids... ids) {
        const int poses[] = {ids.id...};
        if (kNumBlocks == 1) (*tied)[poses[0]] = true;
        for (const int pose : poses) sets->Join(poses[0], pose);
        return true;
      });
    }
  }

 private:
  static constexpr int kNumBlocks = sizeof...(Ids);
  static constexpr int kNumPoses = (0 + ... + std::is_same_v<Ids, PoseId>);
  static constexpr int kNumPoints = kNumBlocks - kNumPoses;
  static constexpr std::make_index_sequence<sizeof...(Ids)> kBlocks{};

  const Derived& derived() const { return static_cast<const Derived&>(*this); }
  static constexpr bool IsRobust() {
    return !std::is_same_v<decltype(std::declval<const Derived&>().loss()), NoLoss>;
  }

  // Jacobians of blocks that are not wanted are left as they are.
  template <typename Which, typename AnyResidual, std::size_t... K>
  static bool EvaluateAt(const AnyResidual& residual, const StateView& at, double* r,
                         double (&jacobians)[kNumBlocks][3 * M], std::index_sequence<K...>,
                         Ids... ids) {
    return residual.Evaluate(BlockOf(at, ids)..., r,
                             (Which::Has(Ids{}) ? jacobians[K] : nullptr)...);
  }

  template <typename Which>
  bool LinearizeAs(int scan, const StateView& at, const TermDerivatives& out, double* cost) const {
    const auto loss = derived().loss();
    const TermDerivatives to = out;
    double sum = *cost;
    double r[M] = {}, jacobians[kNumBlocks][3 * M] = {};
    const bool ok =
        derived().ForEach(scan, at.poses, [&](std::size_t, const auto& residual, Ids... ids) {
          if (!EvaluateAt<Which>(residual, at, r, jacobians, kBlocks, ids...)) return false;
          const double s = Square(r);
          // Pose terms are few, and added up one component at a time: the last digits of their sums
          // depend on the order.
          if constexpr (kNumPoints == 0 && !IsRobust()) {
            for (int k = 0; k < M; ++k) sum += 0.5 * r[k] * r[k];
          } else {
            sum += 0.5 * loss.Rho(s);
          }
          const double weight = loss.Weight(s);
          int block = 0;
          (Accumulate<Which, M>(weight, r, jacobians[block++], ids, to), ...);
          return true;
        });
    *cost = sum;
    return ok;
  }

  template <typename Which>
  void AddCurvatureAs(int scan, const StateView& at, const StateView& direction,
                      double* total) const {
    const auto loss = derived().loss();
    double sum = *total;
    double r[M] = {}, jacobians[kNumBlocks][3 * M] = {};
    derived().ForEach(scan, at.poses, [&](std::size_t, const auto& residual, Ids... ids) {
      if (!EvaluateAt<Which>(residual, at, r, jacobians, kBlocks, ids...)) return false;
      const double weight = loss.Weight(Square(r));
      double product[M] = {};
      int block = 0;
      (AddProduct<Which, M>(jacobians[block++], ids, direction, product), ...);
      for (int k = 0; k < M; ++k) sum += weight * product[k] * product[k];
      return true;
    });
    *total = sum;
  }

  template <typename AnyResidual>
  void AddEquationsOf(const AnyResidual& residual, const double* poses, PoseEquations* equations,
                      Ids... ids) const {
    using Jacobian = Eigen::Matrix<double, M, 3, Eigen::RowMajor>;
    double values[kNumBlocks][3 * M];
    Eigen::Matrix<double, M, 1> r;
    if (!EvaluateAt<Wanted<true, false>>(residual, {poses, nullptr}, r.data(), values, kBlocks,
                                         ids...)) {
      return;
    }
    Jacobian d[kNumBlocks];
    for (int i = 0; i < kNumBlocks; ++i) d[i] = Eigen::Map<const Jacobian>(values[i]);
    if constexpr (IsRobust()) {
      const double scale = std::sqrt(derived().loss().Weight(r.squaredNorm()));
      r *= scale;
      for (Jacobian& jacobian : d) jacobian *= scale;
    }
    const int pose[] = {ids.id...};
    for (int i = 0; i < kNumBlocks; ++i) {
      equations->Add(pose[i], d[i].transpose() * d[i], d[i].transpose() * r);
    }
    for (int i = 0; i < kNumBlocks; ++i) {
      for (int j = i + 1; j < kNumBlocks; ++j) {
        if (pose[i] < pose[j]) {
          equations->AddCoupling(pose[i], pose[j], d[j].transpose() * d[i]);
        } else {
          equations->AddCoupling(pose[j], pose[i], d[i].transpose() * d[j]);
        }
      }
    }
  }
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_TERM_OF_H_
