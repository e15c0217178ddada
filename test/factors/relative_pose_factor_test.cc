#include "plumbline/factors/relative_pose_factor.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "plumbline/factors/sqrt_information.h"
#include "plumbline/test/factors/factor_testing.h"
#include "plumbline/test/factors/relative_pose_twin.h"

namespace plumbline {
namespace {

RelativePoseResidual Measured(const Pose2& a_from_b) {
  RelativePoseResidual residual;
  residual.a_from_b = a_from_b;
  EXPECT_TRUE(SqrtInformation(CorrelatedCovariance(), &residual.sqrt_information));
  return residual;
}

TEST(RelativePoseFactor, HasTheHandWorkedValue) {
  RelativePoseResidual residual;
  residual.a_from_b = {2.5, 1.25, kPi / 4.0};
  residual.sqrt_information << 2, 1, 0, 0, 3, 1, 0, 0, 4;
  // a looks along +y: b lies 3 ahead and 1 to the left, so e = (0.5, -0.25, pi / 4).
  ExpectResiduals(RelativePoseFactor(residual), {{1.0, 2.0, kPi / 2.0}, {0.0, 5.0, kPi}},
                  {0.75, -0.75 + kPi / 4.0, kPi});
}

TEST(RelativePoseFactor, IsZeroAtTheMeasurement) {
  const Pose2 a(1.0, -2.0, 2.8), a_from_b(0.7, 0.2, 1.1);
  ExpectResiduals(RelativePoseFactor(Measured(a_from_b)), {ToBlock(a), ToBlock(a * a_from_b)},
                  {0.0, 0.0, 0.0});
}

TEST(RelativePoseFactor, ObeysTheFactorLaws) {
  const RelativePoseResidual residual = Measured({0.5, -0.3, 0.8});
  ExpectFactorLaws(RelativePoseFactor(residual),
                   RelativePoseTwin(new RelativePoseTwinFunctor{residual}),
                   RelativePoseStates(residual.a_from_b));
}

TEST(RelativePoseFactor, WrapsTheYawError) {
  const double turn = 6.0 - 2.0 * kPi;
  RelativePoseResidual residual;
  residual.a_from_b.yaw = -3.0;
  ExpectResiduals(RelativePoseFactor(residual), {{0, 0, 1.0}, {0, 0, 4.0}}, {0, 0, turn});
  residual.a_from_b.yaw = 3.0;
  ExpectResiduals(RelativePoseFactor(residual), {{0, 0, 4.0}, {0, 0, 1.0}}, {0, 0, -turn});
}

TEST(RelativePoseFactor, SquaredNormIsTheMahalanobisDistance) {
  const Pose2 a(1.0, 2.0, -0.6), b(2.0, 1.0, 0.4), a_from_b(1.2, -0.4, 0.9);
  const Pose2 actual = Between(a, b);
  const Eigen::Vector3d e(actual.x - a_from_b.x, actual.y - a_from_b.y, actual.yaw - a_from_b.yaw);
  const FactorEvaluation at =
      Evaluate(RelativePoseFactor(Measured(a_from_b)), {ToBlock(a), ToBlock(b)});
  const double expected = e.dot(CorrelatedCovariance().inverse() * e);
  EXPECT_NEAR(at.residuals.squaredNorm(), expected, 1e-10 * expected);
}

TEST(RelativePoseFactor, IsUnchangedWhenTheWorldMoves) {
  const RelativePoseFactor factor(Measured({1.2, -0.4, 0.9}));
  ExpectSameCostAfterMove(factor, factor, {10.0, -20.0, 2.5}, {{1.0, 2.0, -0.6}, {2.0, 1.0, 0.4}});
}

}  // namespace
}  // namespace plumbline
