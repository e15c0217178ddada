#include "plumbline/factors/surface_noise.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

TEST(SurfaceNoiseTest, BeamVarianceIsTheBeamsCovarianceAcrossTheSurface) {
  const SurfaceNoise noise{0.02 * 0.02, 0.004 * 0.004, 0.01 * 0.01};
  RandomStates random(3);
  for (int i = 0; i < 100; ++i) {
    const double range_m = random.Uniform(0.1, 60.0);
    const Eigen::Vector2d axis = random.Direction(), normal = random.Direction();
    Eigen::Matrix2d axes;  // along the beam, and to its left
    axes << axis.x(), -axis.y(), axis.y(), axis.x();
    const Eigen::Vector2d variances(0.02 * 0.02, range_m * range_m * 0.004 * 0.004);
    const Eigen::Matrix2d covariance = axes * variances.asDiagonal() * axes.transpose();
    const double expected = normal.dot(covariance * normal);
    EXPECT_NEAR(noise.BeamVariance(range_m, axis, normal), expected, 1e-12 * variances.sum());
    EXPECT_TRUE(
        noise.BeamCovarianceTimes(range_m, axis, normal).isApprox(covariance * normal, 1e-9));
    // Neither the side of the surface nor the frame matters.
    EXPECT_EQ(noise.BeamVariance(range_m, axis, -normal),
              noise.BeamVariance(range_m, axis, normal));
    EXPECT_LE(expected + noise.surface_variance, noise.LargestVariance(range_m));
    const Eigen::Rotation2Dd turn(random.Uniform(-kPi, kPi));
    EXPECT_NEAR(noise.BeamVariance(range_m, turn * axis, turn * normal), expected,
                1e-12 * variances.sum());
  }
}

TEST(SurfaceNoiseTest, RangeCountsHeadOnAndBearingAtGrazingIncidence) {
  const SurfaceNoise noise{0.0004, 0.000009, 0.0001};
  EXPECT_DOUBLE_EQ(noise.BeamVariance(5.0, {1.0, 0.0}, {-1.0, 0.0}), 0.0004);
  EXPECT_DOUBLE_EQ(noise.BeamVariance(5.0, {1.0, 0.0}, {0.0, 1.0}), 25.0 * 0.000009);
}

TEST(SurfaceNoiseTest, ComesFromTheFactorsSigmas) {
  FactorOptions factors;
  factors.beam.sigma_range_m = 0.3;
  factors.beam.sigma_bearing_rad = 0.05;
  factors.manifold.sigma_m = 0.4;
  const SurfaceNoise noise = NoiseOf(factors);
  EXPECT_DOUBLE_EQ(noise.range_variance, 0.09);
  EXPECT_DOUBLE_EQ(noise.bearing_variance, 0.0025);
  EXPECT_DOUBLE_EQ(noise.surface_variance, 0.16);
  EXPECT_DOUBLE_EQ(noise.StandardDeviation(), 0.5);
}

}  // namespace
}  // namespace plumbline
