#include "plumbline/factors/pose_prior_factor.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "plumbline/factors/sqrt_information.h"
#include "plumbline/test/factor_testing.h"

namespace plumbline {
namespace {

struct Twin {
  PosePriorResidual fixed;

  template <typename T>
  bool operator()(const T* pose, T* residuals) const {
    const Eigen::Matrix<T, 3, 1> error(pose[0] - fixed.prior.x, pose[1] - fixed.prior.y,
                                       NormalizeAngle(T(pose[2] - fixed.prior.yaw)));
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(residuals);
    whitened = fixed.sqrt_information.cast<T>() * error;
    return true;
  }
};

PosePriorResidual PriorAt(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  PosePriorResidual residual;
  residual.prior = pose;
  EXPECT_TRUE(SqrtInformation(covariance, &residual.sqrt_information));
  return residual;
}

TEST(PosePriorFactor, HasTheHandWorkedValue) {
  PosePriorResidual residual;
  residual.prior = {1.0, 2.0, 0.5};
  residual.sqrt_information << 2, 1, 0, 0, 3, 1, 0, 0, 4;
  // e = (0.5, -1, 1).
  ExpectResiduals(PosePriorFactor(residual), {{1.5, 1.0, 1.5}}, {0.0, -2.0, 4.0});
}

TEST(PosePriorFactor, IsZeroAtThePrior) {
  const Pose2 prior(1.0, -2.0, 3.0);
  ExpectResiduals(PosePriorFactor(PriorAt(prior, CorrelatedCovariance())),
                  {{1.0, -2.0, 3.0 - 4.0 * kPi}}, {0.0, 0.0, 0.0});
}

TEST(PosePriorFactor, ObeysTheFactorLaws) {
  const PosePriorResidual residual = PriorAt({0.3, -0.4, 0.0}, CorrelatedCovariance());
  ExpectFactorLaws(PosePriorFactor(residual),
                   ceres::AutoDiffCostFunction<Twin, 3, 3>(new Twin{residual}),
                   [](RandomStates* random) -> Blocks {
                     Pose2 pose = random->Pose();
                     pose.yaw *= 0.95;
                     return {ToBlock(pose)};
                   });
}

TEST(PosePriorFactor, WrapsTheYawError) {
  const double turn = 6.0 - 2.0 * kPi;
  PosePriorResidual residual;
  residual.prior.yaw = -3.0;
  ExpectResiduals(PosePriorFactor(residual), {{0.0, 0.0, 3.0}}, {0.0, 0.0, turn});
  residual.prior.yaw = 3.0;
  ExpectResiduals(PosePriorFactor(residual), {{0.0, 0.0, -3.0}}, {0.0, 0.0, -turn});
}

TEST(PosePriorFactor, SquaredNormIsTheMahalanobisDistance) {
  const Eigen::Matrix3d covariance = CorrelatedCovariance();
  const Eigen::Vector3d e(0.2, -0.3, 0.1);
  const FactorEvaluation at =
      Evaluate(PosePriorFactor(PriorAt(Pose2(), covariance)), {{e.x(), e.y(), e.z()}});
  EXPECT_NEAR(at.residuals.squaredNorm(), e.dot(covariance.inverse() * e), 1e-10);
}

TEST(PosePriorFactor, IsUnchangedWhenTheWorldMoves) {
  const Pose2 prior(0.5, 1.0, -0.7), motion(10.0, -20.0, 2.5);
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(motion.yaw).toRotationMatrix();
  const Eigen::Matrix3d covariance = CorrelatedCovariance();
  ExpectSameCostAfterMove(
      PosePriorFactor(PriorAt(prior, covariance)),
      PosePriorFactor(PriorAt(motion * prior, rotation * covariance * rotation.transpose())),
      motion, {{0.7, 0.8, -0.2}});
}

TEST(PosePriorFactor, TakesItsSigmasFromTheOptions) {
  PosePriorOptions options;
  options.sigma_translation_m = 0.5;
  options.sigma_rotation_rad = 0.1;
  ExpectResiduals(PosePriorFactor(MakePosePriorResidual({1.0, 1.0, 1.0}, options)),
                  {{2.0, 0.0, 1.5}}, {2.0, -2.0, 5.0});
}

}  // namespace
}  // namespace plumbline
