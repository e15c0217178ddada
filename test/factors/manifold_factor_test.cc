#include "plumbline/factors/manifold_factor.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

struct Twin {
  ManifoldResidual fixed;

  template <typename T>
  bool operator()(const T* point, T* residual) const {
    const double nx = fixed.line.normal_x, ny = fixed.line.normal_y;
    residual[0] =
        ((point[0] - nx * fixed.line.offset) * nx + (point[1] - ny * fixed.line.offset) * ny) *
        fixed.inv_sigma;
    return true;
  }
};

TEST(ManifoldFactor, HasTheHandWorkedValueAndDerivative) {
  const ManifoldFactor factor({{0.6, 0.8, 2.0}, 2.0});
  ExpectResiduals(factor, {{3.0, 4.0}}, {6.0});
  const FactorEvaluation at = Evaluate(factor, {{3.0, 4.0}});
  EXPECT_DOUBLE_EQ(at.jacobians[0](0, 0), 1.2);
  EXPECT_DOUBLE_EQ(at.jacobians[0](0, 1), 1.6);
}

TEST(ManifoldFactor, IsZeroAllAlongTheLine) {
  const ManifoldFactor factor({{0.6, 0.8, 2.0}, 100.0});
  for (const double along : {-5.0, 0.0, 3.0}) {
    ExpectResiduals(factor, {{1.2 - 0.8 * along, 1.6 + 0.6 * along}}, {0.0});
  }
}

TEST(ManifoldFactor, ObeysTheFactorLaws) {
  for (const TangentLine& line : {TangentLine{0.6, -0.8, 4.0}, TangentLine{0.0, 1.0, 3.0}}) {
    const ManifoldResidual residual{line, 125.0};
    ExpectFactorLaws(ManifoldFactor(residual),
                     ceres::AutoDiffCostFunction<Twin, 1, 2>(new Twin{residual}),
                     [](RandomStates* random) -> Blocks {
                       return {ToBlock(Eigen::Vector2d(random->Pose().translation()))};
                     });
  }
}

TEST(ManifoldFactor, IsUnchangedWhenTheWorldMoves) {
  const Pose2 motion(10.0, -20.0, 2.5);
  const Eigen::Vector2d normal = Pose2(0.0, 0.0, motion.yaw) * Eigen::Vector2d(0.6, 0.8);
  const TangentLine moved{normal.x(), normal.y(), 2.0 + normal.dot(motion.translation())};
  ExpectSameCostAfterMove(ManifoldFactor({{0.6, 0.8, 2.0}, 10.0}), ManifoldFactor({moved, 10.0}),
                          motion, {{1.5, -0.3}});
}

TEST(ManifoldFactor, RefusesALineThatIsNotFinite) {
  EXPECT_FALSE(Evaluate(ManifoldFactor({{kNaN, 0.0, 0.0}, 1.0}), {{1.0, 1.0}}).ok);
  EXPECT_FALSE(Evaluate(ManifoldFactor({{1.0, 0.0, kInfinity}, 1.0}), {{1.0, 1.0}}).ok);
}

}  // namespace
}  // namespace plumbline
