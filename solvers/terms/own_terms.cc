#include "plumbline/solvers/terms/own_terms.h"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/solvers/pose_graph/pose_sets.h"
#include "plumbline/solvers/terms/term_parts.h"

namespace plumbline {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

bool AreFinite(const double* values, std::size_t size) {
  return std::all_of(values, values + size, [](double value) { return std::isfinite(value); });
}

// Calls a host's function. False if that returns false or throws, or anything is not finite.
bool EvaluateSafely(const ceres::CostFunction& cost, double const* const* blocks, double* residuals,
                    double** jacobians) {
  try {
    if (!cost.Evaluate(blocks, residuals, jacobians)) return false;
  } catch (...) {  // Ceres' threads cannot pass it on.
    return false;
  }
  const std::size_t num_rows = cost.num_residuals();
  if (!AreFinite(residuals, num_rows)) return false;
  const auto& sizes = cost.parameter_block_sizes();
  for (std::size_t b = 0; jacobians != nullptr && b < sizes.size(); ++b) {
    if (jacobians[b] != nullptr && !AreFinite(jacobians[b], num_rows * sizes[b])) return false;
  }
  return true;
}

// Lends a residual to Ceres, which deletes what it is given.
class LentCost final : public ceres::CostFunction {
 public:
  LentCost(std::shared_ptr<const OwnTerm> term, const OwnResidual& residual)
      : term_(std::move(term)), cost_(*residual.cost) {
    set_num_residuals(cost_.num_residuals());
    *mutable_parameter_block_sizes() = cost_.parameter_block_sizes();
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    return EvaluateSafely(cost_, blocks, residuals, jacobians);
  }

 private:
  const std::shared_ptr<const OwnTerm> term_;  // keeps it alive
  const ceres::CostFunction& cost_;
};

// One residual of the term at a time, evaluated.
class Evaluation {
 public:
  // False where it is undefined.
  bool Run(const OwnResidual& residual, const StateView& at, bool with_jacobians) {
    blocks_.clear();
    for (const int pose : residual.poses) blocks_.push_back(at.poses + 3 * pose);
    for (const std::size_t point : residual.points) blocks_.push_back(at.points + 2 * point);
    const ceres::CostFunction& cost = *residual.cost;
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
    if (residual.loss != nullptr) residual.loss->Evaluate(loss[0], loss);
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

class HostTerm final : public Term {
 public:
  explicit HostTerm(std::shared_ptr<const OwnTerm> term)
      : term_(std::move(term)), sees_points_(term_->SeesPoints()) {
    for (const OwnResidual& residual : term_->residuals) {
      sees_poses_ |= !residual.poses.empty();
      joins_points_ |= residual.points.size() > 1;
    }
  }

  std::string name() const override { return term_->name; }
  std::string unit() const override { return term_->unit; }
  double sigma() const override { return term_->sigma; }
  int residuals_per_block() const override {
    return term_->residuals.empty() ? 0 : term_->residuals.front().cost->num_residuals();
  }
  std::size_t num_blocks() const override { return term_->residuals.size(); }
  bool SeesPoses() const override { return sees_poses_; }
  bool SeesPoints() const override { return sees_points_; }
  bool JoinsPoints() const override { return joins_points_; }
  // What a residual sees is up to the host.
  bool GoesByScan() const override { return false; }

  bool Linearize(int, const StateView& at, const TermDerivatives& out,
                 double* cost) const override {
    Evaluation evaluation;
    for (const OwnResidual& residual : term_->residuals) {
      if (!evaluation.Run(residual, at, out.WantsPoses() || out.WantsPoints())) return false;
      *cost += 0.5 * evaluation.rho;
      const RowMajor* jacobian = evaluation.jacobians.data();
      for (const int pose : residual.poses) {
        AddDerivatives(evaluation, *jacobian++, PoseId{pose}, out);
      }
      for (const std::size_t point : residual.points) {
        AddDerivatives(evaluation, *jacobian++, PointId{point}, out);
      }
    }
    return true;
  }

  void AddCurvature(int, const StateView& at, const StateView& direction,
                    double* sum) const override {
    Evaluation evaluation;
    for (const OwnResidual& residual : term_->residuals) {
      if (!evaluation.Run(residual, at, true)) continue;
      Eigen::VectorXd product = Eigen::VectorXd::Zero(evaluation.r.size());
      const RowMajor* jacobian = evaluation.jacobians.data();
      const auto add = [&](const double* values, std::size_t first) {
        const RowMajor& by_block = *jacobian++;
        if (values == nullptr) return;
        product += by_block * Eigen::Map<const Eigen::VectorXd>(values + first, by_block.cols());
      };
      for (const int pose : residual.poses) add(direction.poses, 3 * pose);
      for (const std::size_t point : residual.points) add(direction.points, 2 * point);
      *sum += evaluation.weight * product.squaredNorm();
    }
  }

  void Evaluate(int, const StateView& at, double* residuals) const override {
    Evaluation evaluation;
    for (const OwnResidual& residual : term_->residuals) {
      const bool ok = evaluation.Run(residual, at, false);
      if (!ok) evaluation.r.setConstant(std::numeric_limits<double>::quiet_NaN());
      residuals = std::copy_n(evaluation.r.data(), evaluation.r.size(), residuals);
    }
  }

  // Every residual has its own.
  std::unique_ptr<ceres::LossFunction> MakeLoss() const override { return nullptr; }

  void AddTo(int, TermProblem* to) const override {
    for (const OwnResidual& residual : term_->residuals) {
      std::vector<double*> blocks;
      for (const int pose : residual.poses) blocks.push_back(to->poses + 3 * pose);
      for (const std::size_t point : residual.points) blocks.push_back(to->points + 2 * point);
      to->residual_blocks->push_back(to->problem->AddResidualBlock(new LentCost(term_, residual),
                                                                   residual.loss.get(), blocks));
    }
  }

  void AddSquares(const double* poses, double* sum) const override {
    Evaluation evaluation;
    for (const OwnResidual& residual : term_->residuals) {
      *sum += evaluation.Run(residual, {poses, nullptr}, false)
                  ? evaluation.rho
                  : std::numeric_limits<double>::quiet_NaN();
    }
  }

  void AddEquations(const double* poses, PoseEquations* equations) const override {
    Evaluation evaluation;
    for (const OwnResidual& residual : term_->residuals) {
      if (!evaluation.Run(residual, {poses, nullptr}, true)) continue;
      const std::vector<RowMajor>& d = evaluation.jacobians;
      for (std::size_t i = 0; i < d.size(); ++i) {
        equations->Add(residual.poses[i], evaluation.weight * d[i].transpose() * d[i],
                       evaluation.weight * d[i].transpose() * evaluation.r);
        for (std::size_t j = 0; j < d.size(); ++j) {
          if (residual.poses[i] >= residual.poses[j]) continue;
          equations->AddCoupling(residual.poses[i], residual.poses[j],
                                 evaluation.weight * d[j].transpose() * d[i]);
        }
      }
    }
  }

  void TiePoses(PoseSets* sets, std::vector<char>* tied) const override {
    for (const OwnResidual& residual : term_->residuals) {
      const int first = residual.poses.front();
      if (residual.poses.size() == 1) (*tied)[first] = true;
      for (const int pose : residual.poses) sets->Join(first, pose);
    }
  }

 private:
  const std::shared_ptr<const OwnTerm> term_;
  bool sees_poses_ = false;
  bool sees_points_ = false;
  bool joins_points_ = false;
};

template <typename Id>
bool IsUnknown(Id id, std::size_t count) {
  return id < Id{0} || static_cast<std::size_t>(id) >= count;
}

// What is wrong with the ids of a residual; empty: nothing.
std::string FaultOfIds(const OwnResidual& residual, const SlamGraph& graph) {
  for (const int pose : residual.poses) {
    if (!IsUnknown(pose, graph.num_poses())) continue;
    return "sees pose " + std::to_string(pose) + ", but the graph has " +
           std::to_string(graph.num_poses()) + " poses";
  }
  for (const std::size_t point : residual.points) {
    if (!IsUnknown(point, graph.num_returns())) continue;
    return "sees point " + std::to_string(point) + ", but the graph has " +
           std::to_string(graph.num_returns()) + " returns";
  }
  return "";
}

// Likewise with its value at a state.
std::string FaultOfValue(const OwnResidual& residual, const MapState& state) {
  const StateView at{state.poses.data(), state.points.data()};
  Evaluation evaluation;
  if (!evaluation.Run(residual, at, false)) {
    return "throws, fails or is not finite at the given state";
  }
  if (!evaluation.Run(residual, at, true)) return "has no finite derivatives at the given state";
  return "";
}

// fault_of(residual): what is wrong with it; empty: nothing.
template <typename FaultOf>
Status CheckEach(const FactorOptions& options, const FaultOf& fault_of) {
  for (const auto& term : options.own_terms) {
    for (std::size_t i = 0; i < term->residuals.size(); ++i) {
      const std::string fault = fault_of(term->residuals[i]);
      if (fault.empty()) continue;
      return Status::InvalidArgument("own term \"" + term->name + "\": residual " +
                                     std::to_string(i) + " " + fault);
    }
  }
  return Status::Ok();
}

}  // namespace

std::shared_ptr<const Term> MakeTerm(std::shared_ptr<const OwnTerm> term) {
  return std::make_shared<HostTerm>(std::move(term));
}

Status CheckOwnTermIds(const FactorOptions& options, const SlamGraph& graph) {
  return CheckEach(options,
                   [&](const OwnResidual& residual) { return FaultOfIds(residual, graph); });
}

Status CheckOwnTerms(const FactorOptions& options, const SlamGraph& graph, const MapState& state) {
  PLUMBLINE_RETURN_IF_ERROR(CheckOwnTermIds(options, graph));
  return CheckEach(options,
                   [&](const OwnResidual& residual) { return FaultOfValue(residual, state); });
}

double OwnPointCost(const FactorOptions& options, const SlamGraph& graph,
                    const std::vector<double>& poses) {
  double cost = 0.0;
  std::vector<double> points;
  for (const auto& own_term : options.own_terms) {
    if (!own_term->SeesPoints()) continue;
    if (points.empty()) points = graph.MeasuredMap(poses);
    const StateView at{poses.data(), points.data()};
    if (!HostTerm(own_term).Linearize(Term::kNoScan, at, {}, &cost)) {
      cost = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return cost;
}

}  // namespace plumbline
