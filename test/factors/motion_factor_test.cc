#include "plumbline/factors/motion_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "plumbline/factors/sqrt_information.h"
#include "plumbline/test/factors/factor_testing.h"
#include "plumbline/test/factors/relative_pose_twin.h"

namespace plumbline {
namespace {

MotionOptions HandOptions() {
  MotionOptions options;
  options.rotation_per_rotation = 0.5;
  options.rotation_per_translation_rad_m = 0.6;
  options.translation_per_translation = 0.2;
  options.translation_per_rotation_m_rad = 0.1;
  options.translation_floor_m = 0.01;
  options.rotation_floor_rad = 0.005;
  return options;
}

void ExpectCovariance(const Pose2& step, const Eigen::Matrix3d& expected) {
  const Eigen::Matrix3d actual = MotionCovariance(step, HandOptions());
  EXPECT_TRUE(actual.isApprox(expected, 1e-12)) << actual << "\nagainst\n" << expected;
}

TEST(MotionCovariance, HasTheHandWorkedValues) {
  Eigen::Matrix3d expected;
  // One metre ahead: sigmas (0.6 rad, 0.2 m, 0.6 rad); the first turn swings the end by 0.6 m.
  expected << 0.04 + 1e-4, 0, 0, 0, 0.36 + 1e-4, 0.36, 0, 0.36, 0.72 + 2.5e-5;
  ExpectCovariance({1.0, 0.0, 0.0}, expected);
  // One metre back: the first turn swings the end the other way.
  expected << 0.04 + 1e-4, 0, 0, 0, 0.36 + 1e-4, -0.36, 0, -0.36, 0.72 + 2.5e-5;
  ExpectCovariance({-1.0, 0.0, 0.0}, expected);
  // One radian on the spot: sigmas (0, 0.1 m, 0.5 rad).
  expected << 0.01 + 1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 0.25 + 2.5e-5;
  ExpectCovariance({0.0, 0.0, 1.0}, expected);
  // Standstill: the floors.
  expected << 1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 2.5e-5;
  ExpectCovariance({0.0, 0.0, 0.0}, expected);
}

// Drives the step many times with noisy controls and compares the spread.
TEST(MotionCovariance, IsTheSpreadOfNoisyDrives) {
  MotionOptions options;
  options.rotation_per_rotation = 0.02;
  options.rotation_per_translation_rad_m = 0.01;
  options.translation_per_translation = 0.03;
  options.translation_per_rotation_m_rad = 0.01;
  options.translation_floor_m = options.rotation_floor_rad = 1e-4;
  const double rot1 = 0.5, rot2 = -0.9;
  for (const double trans : {1.5, -1.5}) {
    const Pose2 step(trans * std::cos(rot1), trans * std::sin(rot1), rot1 + rot2);
    RandomStates random(7);
    constexpr int kDrives = 40000;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (int i = 0; i < kDrives; ++i) {
      const double r1 = rot1 + random.Gaussian(0.02 * 0.5 + 0.01 * 1.5);
      const double t = trans + random.Gaussian(0.03 * 1.5 + 0.01 * (0.5 + 0.9));
      const double r2 = rot2 + random.Gaussian(0.02 * 0.9 + 0.01 * 1.5);
      const Eigen::Vector3d e(t * std::cos(r1) - step.x, t * std::sin(r1) - step.y,
                              r1 + r2 - step.yaw);
      spread += e * e.transpose() / kDrives;
    }
    const Eigen::Matrix3d covariance = MotionCovariance(step, options);
    EXPECT_LT((spread - covariance).norm(), 0.02 * covariance.norm()) << spread << "\n\n"
                                                                      << covariance;
  }
}

TEST(MotionCovariance, DoesNotDependOnTheDirectionOfAVanishingStep) {
  const Eigen::Matrix3d turn_only = MotionCovariance({0.0, 0.0, 0.4}, HandOptions());
  for (int i = 0; i < 16; ++i) {
    const double angle = i * kPi / 8.0;
    const Pose2 step(1e-6 * std::cos(angle), 1e-6 * std::sin(angle), 0.4);
    EXPECT_LT((MotionCovariance(step, HandOptions()) - turn_only).norm(), 1e-6) << "at " << angle;
  }
}

TEST(MotionCovariance, IsPositiveDefiniteForEveryStep) {
  MotionOptions noiseless;
  noiseless.rotation_per_rotation = noiseless.rotation_per_translation_rad_m = 0.0;
  noiseless.translation_per_translation = noiseless.translation_per_rotation_m_rad = 0.0;
  for (const MotionOptions& options : {HandOptions(), noiseless}) {
    for (const double x : {-30.0, -1e-3, 0.0, 1e-9, 0.02, 5.0}) {
      for (const double y : {-2.0, 0.0, 1e-9, 0.02}) {
        for (const double yaw : {-kPi, -1.0, 0.0, 1e-9, 10.0}) {
          const Eigen::Matrix3d covariance = MotionCovariance({x, y, yaw}, options);
          Eigen::Matrix3d u;
          EXPECT_TRUE(SqrtInformation(covariance, &u)) << x << " " << y << " " << yaw;
          const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
          EXPECT_GT(eigen.eigenvalues()[0], 0.99 * 0.005 * 0.005);
        }
      }
    }
  }
}

TEST(MotionFactor, IsTheWhitenedRelativePoseError) {
  const Pose2 step(0.8, 0.1, 0.3), a(1.0, 2.0, -0.6), b(1.9, 1.4, -0.1);
  const Pose2 actual = Between(a, b);
  const Eigen::Vector3d e(actual.x - step.x, actual.y - step.y, actual.yaw - step.yaw);
  const double expected = e.dot(MotionCovariance(step, HandOptions()).inverse() * e);
  const MotionFactor factor(MakeMotionResidual(step, HandOptions()));
  EXPECT_NEAR(Evaluate(factor, {ToBlock(a), ToBlock(b)}).residuals.squaredNorm(), expected,
              1e-10 * expected);
  ExpectResiduals(factor, {ToBlock(a), ToBlock(a * step)}, {0.0, 0.0, 0.0});
  ExpectSameCostAfterMove(factor, factor, {-7.0, 3.0, 1.9}, {ToBlock(a), ToBlock(b)});
}

TEST(MotionFactor, ObeysTheFactorLaws) {
  for (const Pose2& step : {Pose2(0.5, 0.05, 0.2), Pose2(-0.5, 0.1, -0.4), Pose2()}) {
    const MotionResidual residual = MakeMotionResidual(step, HandOptions());
    ExpectFactorLaws(MotionFactor(residual),
                     RelativePoseTwin(new RelativePoseTwinFunctor{residual}),
                     RelativePoseStates(residual.a_from_b));
  }
}

TEST(MotionFactor, RefusesAStepThatIsNotFinite) {
  for (const Pose2& step : {Pose2(kNaN, 0, 0), Pose2(0, kInfinity, 0), Pose2(0, 0, kNaN)}) {
    const MotionFactor factor(MakeMotionResidual(step, HandOptions()));
    EXPECT_FALSE(Evaluate(factor, {{0, 0, 0}, {1, 0, 0}}).ok);
  }
}

}  // namespace
}  // namespace plumbline
