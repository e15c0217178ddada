#ifndef PLUMBLINE_TEST_FACTORS_FACTOR_TESTING_H_
#define PLUMBLINE_TEST_FACTORS_FACTOR_TESTING_H_

#include <ceres/cost_function.h>
#include <ceres/gradient_checker.h>
#include <ceres/version.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/factors/analytic_factor.h"

namespace plumbline {

/// Parameter blocks of one factor in its order: poses have 3 entries, points 2.
using Blocks = std::vector<std::vector<double>>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Seeded source of test states.
class RandomStates {
 public:
  explicit RandomStates(unsigned seed) : engine_(seed) {}

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double Gaussian(double sigma) { return std::normal_distribution<double>(0.0, sigma)(engine_); }
  Pose2 Pose() { return {Uniform(-2, 2), Uniform(-2, 2), Uniform(-kPi, kPi)}; }
  /// A direction as unit vector.
  Eigen::Vector2d Direction() {
    const double angle = Uniform(-kPi, kPi);
    return {std::cos(angle), std::sin(angle)};
  }

 private:
  std::mt19937 engine_;
};

inline std::vector<double> ToBlock(const Pose2& pose) { return {pose.x, pose.y, pose.yaw}; }
inline std::vector<double> ToBlock(const Eigen::Vector2d& point) { return {point.x(), point.y()}; }

/// The state after the whole world has moved.
inline Blocks Moved(const Pose2& motion, Blocks blocks) {
  for (std::vector<double>& block : blocks) {
    block = block.size() == 3 ? ToBlock(motion * Pose2(block.data()))
                              : ToBlock(motion * Eigen::Vector2d(block[0], block[1]));
  }
  return blocks;
}

/// A covariance (x, y [m], yaw [rad]) in which everything is correlated.
inline Eigen::Matrix3d CorrelatedCovariance() {
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.01, -0.006, 0.01, 0.09, 0.012, -0.006, 0.012, 0.01;
  return covariance;
}

struct FactorEvaluation {
  bool ok = false;
  Eigen::VectorXd residuals;
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobians;
};

/// Evaluates into buffers filled with NaN, so that an entry left unwritten shows.
inline FactorEvaluation Evaluate(const ceres::CostFunction& factor, const Blocks& blocks) {
  FactorEvaluation result;
  result.residuals.setConstant(factor.num_residuals(), kNaN);
  std::vector<const double*> parameters;
  for (const std::vector<double>& block : blocks) {
    parameters.push_back(block.data());
    result.jacobians.emplace_back(factor.num_residuals(), block.size());
    result.jacobians.back().setConstant(kNaN);
  }
  std::vector<double*> jacobians;
  for (auto& jacobian : result.jacobians) jacobians.push_back(jacobian.data());
  result.ok = factor.Evaluate(parameters.data(), result.residuals.data(), jacobians.data());
  return result;
}

inline void ExpectResiduals(const ceres::CostFunction& factor, const Blocks& blocks,
                            const std::vector<double>& expected, double tolerance = 1e-12) {
  const FactorEvaluation actual = Evaluate(factor, blocks);
  ASSERT_TRUE(actual.ok);
  ASSERT_EQ(actual.residuals.size(), static_cast<Eigen::Index>(expected.size()));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(actual.residuals[i], expected[i], tolerance) << "residual " << i;
  }
}

/// Same residuals and Jacobians.
inline void ExpectSame(const ceres::CostFunction& a, const ceres::CostFunction& b,
                       const Blocks& blocks) {
  const FactorEvaluation at_a = Evaluate(a, blocks), at_b = Evaluate(b, blocks);
  ASSERT_TRUE(at_a.ok && at_b.ok);
  const auto near = [](const auto& p, const auto& q) {
    return (p - q).norm() <= 1e-10 * (1.0 + q.norm());
  };
  EXPECT_TRUE(near(at_a.residuals, at_b.residuals)) << at_a.residuals - at_b.residuals;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    EXPECT_TRUE(near(at_a.jacobians[i], at_b.jacobians[i])) << "block " << i << "\n"
                                                            << at_a.jacobians[i] << "\nagainst\n"
                                                            << at_b.jacobians[i];
  }
}

/// What shape the space of a block has. All of ours are flat, and nothing but the signature of
/// ceres::GradientChecker asks.
#if CERES_VERSION_MAJOR < 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR < 1)
using BlockGeometry = ceres::LocalParameterization;
#else
using BlockGeometry = ceres::Manifold;
#endif

/// Jacobians against numeric differences. Keep the state some 0.01 away from any jump.
inline void ExpectGradientsCorrect(const ceres::CostFunction& factor, const Blocks& blocks) {
  const std::vector<const BlockGeometry*>* euclidean = nullptr;  // typed: Ceres 2.1 overloads
  ceres::NumericDiffOptions options;
  options.ridders_relative_initial_step_size = 1e-4;  // Ceres starts at 32 times this
  const ceres::GradientChecker checker(&factor, euclidean, options);
  std::vector<const double*> parameters;
  for (const std::vector<double>& block : blocks) parameters.push_back(block.data());
  ceres::GradientChecker::ProbeResults result;
  EXPECT_TRUE(checker.Probe(parameters.data(), 1e-6, &result)) << result.error_log;
}

/// The factor refuses the state once any entry of it is not finite.
inline void ExpectRefusesNonFinite(const ceres::CostFunction& factor, const Blocks& blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::size_t k = 0; k < blocks[i].size(); ++k) {
      for (const double bad : {kNaN, kInfinity, -kInfinity}) {
        Blocks damaged = blocks;
        damaged[i][k] = bad;
        EXPECT_FALSE(Evaluate(factor, damaged).ok) << "block " << i << " entry " << k;
      }
    }
  }
}

/// What holds for every factor at 50 seeded states off the optimum: derivatives agree with numeric
/// differences and with an automatically differentiated twin, and bad states are refused.
inline void ExpectFactorLaws(const ceres::CostFunction& factor, const ceres::CostFunction& twin,
                             const std::function<Blocks(RandomStates*)>& state) {
  RandomStates random(42);
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(testing::Message() << "state " << i);
    const Blocks blocks = state(&random);
    EXPECT_GT(Evaluate(factor, blocks).residuals.norm(), 1e-2);
    ExpectGradientsCorrect(factor, blocks);
    ExpectSame(factor, twin, blocks);
    ExpectRefusesNonFinite(factor, blocks);
  }
}

/// The cost of `factor` is that of `moved_factor`, whose fixed data moved with the world.
inline void ExpectSameCostAfterMove(const ceres::CostFunction& factor,
                                    const ceres::CostFunction& moved_factor, const Pose2& motion,
                                    const Blocks& blocks) {
  const FactorEvaluation before = Evaluate(factor, blocks);
  const FactorEvaluation after = Evaluate(moved_factor, Moved(motion, blocks));
  ASSERT_TRUE(before.ok && after.ok);
  EXPECT_NEAR(after.residuals.squaredNorm(), before.residuals.squaredNorm(),
              1e-9 * (1.0 + before.residuals.squaredNorm()));
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_FACTORS_FACTOR_TESTING_H_
