#include "plumbline/solvers/terms/custom_factor_terms.h"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/factor_check.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/solvers/pose_graph/pose_sets.h"
#include "plumbline/solvers/terms/term_parts.h"

namespace plumbline {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Lends a factor to Ceres, which deletes its cost functions.
class LentCost final : public ceres::CostFunction {
 public:
  explicit LentCost(const CustomFactor& factor) : factor_(factor) {
    set_num_residuals(factor.cost->num_residuals());
    *mutable_parameter_block_sizes() = factor.cost->parameter_block_sizes();
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    return EvaluateSafely(*factor_.cost, blocks, residuals, jacobians);
  }

 private:
  const CustomFactor factor_;  // keeps cost and loss alive
};

// One factor of the term at a time, evaluated.
class Evaluation {
 public:
  // False where it is undefined.
  bool Run(const CustomFactor& factor, const StateView& at, bool with_jacobians) {
    blocks_.clear();
    for (const int pose : factor.poses) blocks_.push_back(at.poses + 3 * pose);
    for (const std::size_t point : factor.points) blocks_.push_back(at.points + 2 * point);
    const ceres::CostFunction& cost = *factor.cost;
    r.resize(cost.num_residuals());
    jacobians.resize(blocks_.size());
    pointers_.clear();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      jacobians[b].resize(r.size(), cost.parameter_block_sizes()[b]);
      pointers_.push_back(jacobians[b].data());
    }
    if (!EvaluateSafely(cost, blocks_.data(), r.data(),
                        with_jacobians ? pointers_.data() : nullptr)) {
      return false;
    }
    double loss[3] = {r.squaredNorm(), 1.0, 0.0};
    if (factor.loss != nullptr) factor.loss->Evaluate(loss[0], loss);
    rho = loss[0];
    weight = loss[1];
    return std::isfinite(rho) && std::isfinite(weight);
  }

  Eigen::VectorXd r;
  std::vector<RowMajor> jacobians;  // by poses and then points
  double rho = 0.0;                 // twice the cost
  double weight = 1.0;              // rho'

 private:
  std::vector<const double*> blocks_;
  std::vector<double*> pointers_;
};

// Adds to the gradient and the upper triangle of the block of one parameter block.
template <typename Id>
void AddDerivatives(const Evaluation& residual, const RowMajor& jacobian, Id id,
                    const TermDerivatives& out) {
  const Eigen::Index size = jacobian.cols();
  if (double* gradient = out.Gradient(id)) {
    Eigen::Map<Eigen::VectorXd>(gradient, size) +=
        residual.weight * jacobian.transpose() * residual.r;
  }
  double* block = out.Block(id);
  for (Eigen::Index i = 0; i < size && block != nullptr; ++i) {
    for (Eigen::Index j = i; j < size; ++j) {
      *block++ += residual.weight * jacobian.col(i).dot(jacobian.col(j));
    }
  }
}

class FactorTerm final : public Term {
 public:
  explicit FactorTerm(std::string name) : name_(std::move(name)) {}

  void Add(CustomFactor factor) {
    sees_poses_ |= !factor.poses.empty();
    sees_points_ |= !factor.points.empty();
    joins_points_ |= factor.points.size() > 1;
    factors_.push_back(std::move(factor));
  }

  std::string name() const override { return name_; }
  int residuals_per_block() const override { return NumResiduals(factors_.front()); }
  std::size_t num_blocks() const override { return factors_.size(); }
  bool SeesPoses() const override { return sees_poses_; }
  bool SeesPoints() const override { return sees_points_; }
  bool JoinsPoints() const override { return joins_points_; }
  // What a factor sees is up to the host.
  bool GoesByScan() const override { return false; }

  bool Linearize(int, const StateView& at, const TermDerivatives& out,
                 double* cost) const override {
    Evaluation evaluation;
    for (const CustomFactor& factor : factors_) {
      if (!evaluation.Run(factor, at, out.WantsPoses() || out.WantsPoints())) return false;
      *cost += 0.5 * evaluation.rho;
      const RowMajor* jacobian = evaluation.jacobians.data();
      for (const int pose : factor.poses) {
        AddDerivatives(evaluation, *jacobian++, PoseId{pose}, out);
      }
      for (const std::size_t point : factor.points) {
        AddDerivatives(evaluation, *jacobian++, PointId{point}, out);
      }
    }
    return true;
  }

  void AddCurvature(int, const StateView& at, const StateView& direction,
                    double* sum) const override {
    Evaluation evaluation;
    for (const CustomFactor& factor : factors_) {
      if (!evaluation.Run(factor, at, true)) continue;
      Eigen::VectorXd product = Eigen::VectorXd::Zero(evaluation.r.size());
      const RowMajor* jacobian = evaluation.jacobians.data();
      const auto add = [&](const double* values, std::size_t first) {
        const RowMajor& by_block = *jacobian++;
        if (values == nullptr) return;
        product += by_block * Eigen::Map<const Eigen::VectorXd>(values + first, by_block.cols());
      };
      for (const int pose : factor.poses) add(direction.poses, 3 * pose);
      for (const std::size_t point : factor.points) add(direction.points, 2 * point);
      *sum += evaluation.weight * product.squaredNorm();
    }
  }

  void Evaluate(int, const StateView& at, double* residuals) const override {
    Evaluation evaluation;
    for (const CustomFactor& factor : factors_) {
      const bool ok = evaluation.Run(factor, at, false);
      if (!ok) evaluation.r.setConstant(std::numeric_limits<double>::quiet_NaN());
      residuals = std::copy_n(evaluation.r.data(), evaluation.r.size(), residuals);
    }
  }

  // Every factor has its own.
  std::unique_ptr<ceres::LossFunction> MakeLoss() const override { return nullptr; }

  void AddTo(int, TermProblem* to) const override {
    for (const CustomFactor& factor : factors_) {
      std::vector<double*> blocks;
      for (const int pose : factor.poses) blocks.push_back(to->poses + 3 * pose);
      for (const std::size_t point : factor.points) blocks.push_back(to->points + 2 * point);
      to->residual_blocks->push_back(
          to->problem->AddResidualBlock(new LentCost(factor), factor.loss.get(), blocks));
    }
  }

  void AddSquares(const double* poses, double* sum) const override {
    Evaluation evaluation;
    for (const CustomFactor& factor : factors_) {
      *sum += evaluation.Run(factor, {poses, nullptr}, false)
                  ? evaluation.rho
                  : std::numeric_limits<double>::quiet_NaN();
    }
  }

  void AddEquations(const double* poses, PoseEquations* equations) const override {
    Evaluation evaluation;
    for (const CustomFactor& factor : factors_) {
      if (!evaluation.Run(factor, {poses, nullptr}, true)) continue;
      const std::vector<RowMajor>& d = evaluation.jacobians;
      for (std::size_t i = 0; i < d.size(); ++i) {
        equations->Add(factor.poses[i], evaluation.weight * d[i].transpose() * d[i],
                       evaluation.weight * d[i].transpose() * evaluation.r);
        for (std::size_t j = 0; j < d.size(); ++j) {
          if (factor.poses[i] >= factor.poses[j]) continue;
          equations->AddCoupling(factor.poses[i], factor.poses[j],
                                 evaluation.weight * d[j].transpose() * d[i]);
        }
      }
    }
  }

  void TiePoses(PoseSets* sets, std::vector<char>* tied) const override {
    for (const CustomFactor& factor : factors_) {
      const int first = factor.poses.front();
      if (factor.poses.size() == 1) (*tied)[first] = true;
      for (const int pose : factor.poses) sets->Join(first, pose);
    }
  }

 private:
  const std::string name_;
  std::vector<CustomFactor> factors_;
  bool sees_poses_ = false;
  bool sees_points_ = false;
  bool joins_points_ = false;
};

// Holds a pose in some directions.
class GaugeCost final : public ceres::CostFunction {
 public:
  // directions: one per column, of x, y [m] and yaw [rad].
  GaugeCost(const Eigen::Matrix3Xd& directions, const Pose2& held)
      : directions_(directions / kSigma), held_(held.x, held.y, held.yaw) {
    set_num_residuals(static_cast<int>(directions.cols()));
    *mutable_parameter_block_sizes() = {3};
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Vector3d off = Eigen::Map<const Eigen::Vector3d>(blocks[0]) - held_;
    Eigen::Map<Eigen::VectorXd>(residuals, directions_.cols()) = directions_.transpose() * off;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[0], directions_.cols(), 3) = directions_.transpose();
    }
    return true;
  }

 private:
  static constexpr double kSigma = 1e-3;  // [m] or [rad]; nothing pulls
  const Eigen::Matrix3Xd directions_;
  const Eigen::Vector3d held_;
};

// The place of a factor in the world, by the initial guesses.
Eigen::Vector2d PlaceOf(const SeenByFactor& seen) {
  return seen.poses.empty() ? seen.points.front() : seen.poses.front().translation();
}

// The error of a factor at a state; empty: none.
std::string ProblemAt(const CustomFactor& factor, const MapState& state) {
  const StateView at{state.poses.data(), state.points.data()};
  Evaluation evaluation;
  if (!evaluation.Run(factor, at, false)) {
    return "throws, fails or is not finite at the given state";
  }
  if (!evaluation.Run(factor, at, true)) return "has no finite derivatives at the given state";
  return "";
}

}  // namespace

TermList MakeFactorTerms(const std::vector<CustomFactor>& factors) {
  std::vector<std::shared_ptr<FactorTerm>> terms;
  std::map<std::string, std::size_t> term_of_name;
  for (const CustomFactor& factor : factors) {
    const auto [term, is_new] = term_of_name.emplace(factor.name, terms.size());
    if (is_new) terms.push_back(std::make_shared<FactorTerm>(factor.name));
    terms[term->second]->Add(factor);
  }
  return {terms.begin(), terms.end()};
}

std::optional<CustomFactor> GaugeFactor(const SlamGraph& graph) {
  if (!graph.fixed_poses().empty() || graph.factors().empty()) return std::nullopt;
  std::vector<SeenByFactor> seen;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  for (const CustomFactor& factor : graph.factors()) {
    seen.push_back(SeenBy(graph, factor));
    origin += PlaceOf(seen.back()) / static_cast<double>(graph.factors().size());
  }
  Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Eigen::MatrixX3d hold = HoldOnWorld(graph.factors()[i], seen[i], origin);
    held += hold.transpose() * hold;
  }
  constexpr double kFree = 1e-9;  // as a share of what is held best
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(held);
  const Eigen::Index num_free =
      (eigen.eigenvalues().array() <= kFree * eigen.eigenvalues()[2]).count();
  if (num_free == 0) return std::nullopt;
  const Pose2 first = graph.InitialPose(0);
  Eigen::Matrix3Xd of_first = eigen.eigenvectors().leftCols(num_free);
  of_first.topRows<2>() += TurnedLeft(first.translation() - origin) * of_first.row(2);
  of_first.colwise().normalize();
  return CustomFactor{"gauge", std::make_shared<GaugeCost>(of_first, first), {0}, {}, nullptr};
}

TermList MakeFactorTerms(const SlamGraph& graph) {
  TermList terms = MakeFactorTerms(graph.factors());
  const std::optional<CustomFactor> gauge = GaugeFactor(graph);
  if (gauge) terms.push_back(MakeFactorTerms({*gauge}).front());
  return terms;
}

Status CheckFactors(const SlamGraph& graph, const MapState& state, std::size_t first) {
  for (std::size_t i = first; i < graph.factors().size(); ++i) {
    const CustomFactor& factor = graph.factors()[i];
    if (!factor.points.empty() && state.points.empty()) continue;
    const std::string problem = ProblemAt(factor, state);
    if (problem.empty()) continue;
    return Status::InvalidArgument("factor " + std::to_string(i) + " (\"" + factor.name +
                                   "\"): " + problem);
  }
  return Status::Ok();
}

double FactorPointCost(const SlamGraph& graph, const std::vector<double>& poses) {
  std::vector<CustomFactor> of_points;
  for (const CustomFactor& factor : graph.factors()) {
    if (!factor.points.empty()) of_points.push_back(factor);
  }
  if (of_points.empty()) return 0.0;
  const std::vector<double> points = graph.MeasuredMap(poses);
  double cost = 0.0;
  for (const auto& term : MakeFactorTerms(of_points)) {
    if (term->Linearize(Term::kNoScan, {poses.data(), points.data()}, {}, &cost)) continue;
    return std::numeric_limits<double>::quiet_NaN();
  }
  return cost;
}

}  // namespace plumbline
