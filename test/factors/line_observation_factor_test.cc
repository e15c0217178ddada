#include "plumbline/factors/line_observation_factor.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include <vector>

#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

struct Twin {
  LineObservationResidual fixed;

  template <typename T>
  bool operator()(const T* pose, const T* line, T* residuals) const {
    using std::cos;
    using std::sin;
    using Vector = Eigen::Matrix<T, 2, 1>;
    const Vector normal(cos(line[0]), sin(line[0]));
    const Vector centroid = fixed.centroid.cast<T>(), origin = fixed.origin.cast<T>();
    residuals[0] = fixed.sqrt_weight * (normal.dot(SE2<T>(pose) * centroid - origin) - line[1]);
    const SE2<T> robot_from_world(T(0), T(0), -pose[2]);
    const Vector spread = fixed.sqrt_scatter.cast<T>() * (robot_from_world * normal);
    residuals[1] = spread.x();
    residuals[2] = spread.y();
    return true;
  }
};

struct WeightedReturn {
  Eigen::Vector2d point;  // frame of the robot [m]
  double weight;
};

LineObservationResidual Compress(const std::vector<WeightedReturn>& returns,
                                 const Eigen::Vector2d& origin) {
  double weight = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const WeightedReturn& r : returns) {
    weight += r.weight;
    sum += r.weight * r.point;
  }
  const Eigen::Vector2d centroid = sum / weight;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const WeightedReturn& r : returns) {
    scatter += r.weight * (r.point - centroid) * (r.point - centroid).transpose();
  }
  return {std::sqrt(weight), centroid, SqrtScatter(scatter), origin};
}

const Eigen::Vector2d kOrigin(0.7, -0.4);

// A surface with noise, one without, which leaves a scatter of rank one, and a single return.
std::vector<std::vector<WeightedReturn>> Returns() {
  return {{{{1.0, 2.0}, 3.0}, {{1.4, 2.1}, 2.0}, {{1.9, 1.9}, 4.0}, {{2.2, 2.3}, 1.0}},
          {{{1.0, 2.0}, 3.0}, {{2.0, 1.0}, 2.0}, {{3.0, 0.0}, 1.0}},
          {{{-1.5, 0.5}, 4.0}}};
}

TEST(LineObservationFactor, HasTheHandWorkedValueAndDerivative) {
  // The centroid is at (0, 5) in the world; the line is y = 4.5. The normal is the robot's x axis.
  LineObservationResidual residual;
  residual.sqrt_weight = 2.0;
  residual.centroid = {3.0, 1.0};
  residual.sqrt_scatter << 3.0, 0.0, 0.0, 4.0;
  residual.origin = {0.5, 0.5};
  const LineObservationFactor factor(residual);
  const Blocks blocks = {{1.0, 2.0, kPi / 2.0}, {kPi / 2.0, 4.0}};
  ExpectResiduals(factor, blocks, {1.0, 3.0, 0.0});
  Eigen::Matrix3d d_pose;
  d_pose << 0.0, 2.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, -4.0;
  Eigen::Matrix<double, 3, 2> d_line;
  d_line << 1.0, -2.0, 0.0, 0.0, 4.0, 0.0;
  const FactorEvaluation at = Evaluate(factor, blocks);
  EXPECT_LT((at.jacobians[0] - d_pose).norm(), 1e-12) << at.jacobians[0];
  EXPECT_LT((at.jacobians[1] - d_line).norm(), 1e-12) << at.jacobians[1];
}

TEST(LineObservationFactor, CostsWhatItsReturnsCost) {
  RandomStates random(3);
  for (const std::vector<WeightedReturn>& returns : Returns()) {
    const LineObservationFactor factor(Compress(returns, kOrigin));
    for (int i = 0; i < 20; ++i) {
      const Pose2 pose = random.Pose();
      const Eigen::Vector2d normal = random.Direction();
      const double offset_m = random.Uniform(-3.0, 3.0);
      double expected = 0.0;
      for (const WeightedReturn& r : returns) {
        const double distance = normal.dot(pose * r.point - kOrigin) - offset_m;
        expected += r.weight * distance * distance;
      }
      const FactorEvaluation at =
          Evaluate(factor, {ToBlock(pose), {std::atan2(normal.y(), normal.x()), offset_m}});
      ASSERT_TRUE(at.ok);
      EXPECT_NEAR(at.residuals.squaredNorm(), expected, 1e-12 * (1.0 + expected));
    }
  }
}

TEST(LineObservationFactor, ObeysTheFactorLaws) {
  for (const std::vector<WeightedReturn>& returns : Returns()) {
    const LineObservationResidual residual = Compress(returns, kOrigin);
    ExpectFactorLaws(
        LineObservationFactor(residual),
        ceres::AutoDiffCostFunction<Twin, 3, 3, 2>(new Twin{residual}),
        // Beyond all that the robot sees, so that no residual vanishes.
        [](RandomStates* random) -> Blocks {
          return {ToBlock(random->Pose()), {random->Uniform(-kPi, kPi), random->Uniform(7.0, 9.0)}};
        });
  }
}

TEST(LineObservationFactor, IsUnchangedWhenTheWorldMoves) {
  const Pose2 motion(10.0, -20.0, 2.5), pose(0.3, -1.2, 0.8);
  const std::vector<WeightedReturn> returns = Returns()[0];
  const LineObservationFactor factor(Compress(returns, kOrigin));
  const LineObservationFactor moved(Compress(returns, motion * kOrigin));
  const FactorEvaluation before = Evaluate(factor, {ToBlock(pose), {0.4, 1.5}});
  const FactorEvaluation after = Evaluate(moved, {ToBlock(motion * pose), {0.4 + motion.yaw, 1.5}});
  ASSERT_TRUE(before.ok && after.ok);
  EXPECT_LT((after.residuals - before.residuals).norm(), 1e-12);
}

TEST(LineObservationFactor, RefusesAnObservationThatIsNotFinite) {
  const Blocks blocks = {{0.1, 0.2, 0.3}, {0.4, 0.5}};
  LineObservationResidual residual = Compress(Returns()[0], kOrigin);
  residual.centroid.x() = kNaN;
  EXPECT_FALSE(Evaluate(LineObservationFactor(residual), blocks).ok);
  residual = Compress(Returns()[0], {0.0, kInfinity});
  EXPECT_FALSE(Evaluate(LineObservationFactor(residual), blocks).ok);
  residual = Compress(Returns()[0], kOrigin);
  residual.sqrt_scatter = SqrtScatter(Eigen::Matrix2d::Constant(kNaN));
  EXPECT_FALSE(Evaluate(LineObservationFactor(residual), blocks).ok);
}

TEST(SqrtScatter, TakesAnyPositiveSemiDefiniteMatrix) {
  const auto expect_root = [](double xx, double xy, double yy) {
    Eigen::Matrix2d scatter;
    scatter << xx, xy, xy, yy;
    const Eigen::Matrix2d root = SqrtScatter(scatter);
    EXPECT_LE((root.transpose() * root - scatter).norm(), 1e-14 * scatter.norm()) << scatter;
  };
  expect_root(5.0, -2.0, 3.0);
  expect_root(1e8, 2e3, 1.0);
  expect_root(4.0, 0.0, 4.0);
  expect_root(0.0, 0.0, 7.0);
  expect_root(4.0, 6.0, 9.0);
  expect_root(9.0, -6.0, 4.0);
  expect_root(0.0, 0.0, 0.0);
}

TEST(SqrtScatter, TakesANegativeEigenvalueForZero) {
  // Eigenvalues 2 + 1e-9 along the diagonal and -1e-9 across it.
  Eigen::Matrix2d scatter;
  scatter << 1.0, 1.0 + 1e-9, 1.0 + 1e-9, 1.0;
  const Eigen::Matrix2d root = SqrtScatter(scatter);
  ASSERT_TRUE(root.allFinite());
  EXPECT_NEAR((root * Eigen::Vector2d(1.0, -1.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((root * Eigen::Vector2d(1.0, 1.0)).squaredNorm(), 4.0, 1e-8);
}

}  // namespace
}  // namespace plumbline
