#include "plumbline/factors/robust_loss.h"

#include <gtest/gtest.h>

#include "plumbline/factors/geman_mcclure_loss.h"

namespace plumbline {
namespace {

TEST(GemanMcClure, HasTheHandWorkedValuesAtTheGate) {
  const GemanMcClure loss = GemanMcClure::FromGate(3.0);
  EXPECT_DOUBLE_EQ(loss.scale_squared, 9.0);
  EXPECT_DOUBLE_EQ(loss.Rho(9.0), 4.5);
  EXPECT_DOUBLE_EQ(loss.Weight(9.0), 0.25);
  EXPECT_DOUBLE_EQ(loss.Curvature(9.0), -1.0 / 36.0);
}

TEST(GemanMcClure, IsQuadraticNearZeroAndSaturatesFarOut) {
  const GemanMcClure loss{4.0};
  EXPECT_EQ(loss.Rho(0.0), 0.0);
  EXPECT_EQ(loss.Weight(0.0), 1.0);
  EXPECT_NEAR(loss.Rho(1e-6), 1e-6, 1e-12);
  EXPECT_NEAR(loss.Rho(1e12), 4.0, 1e-10);
  EXPECT_LT(loss.Weight(1e6), 1e-10);
}

TEST(GemanMcClure, TakesAResidualWithItsVariance) {
  const GemanMcClure loss = GemanMcClure::FromGate(2.0);
  for (const double residual : {0.0, 0.01, -0.3, 50.0}) {
    const double variance = 0.04, s = residual * residual / variance;
    const RobustTerm term = loss.Term(residual, variance);
    EXPECT_NEAR(term.rho, loss.Rho(s), 1e-15 * loss.scale_squared);
    EXPECT_NEAR(term.information, loss.Weight(s) / variance, 1e-15 / variance);
  }
}

TEST(GemanMcClure, DerivativesAgreeWithNumericDifferences) {
  const GemanMcClure loss = GemanMcClure::FromGate(1.7);
  for (const double s : {0.01, 0.5, 2.89, 10.0, 300.0}) {
    const double h = 1e-4 * s;
    const double slope = (loss.Rho(s + h) - loss.Rho(s - h)) / (2.0 * h);
    const double curvature = (loss.Weight(s + h) - loss.Weight(s - h)) / (2.0 * h);
    EXPECT_NEAR(loss.Weight(s), slope, 1e-6 * slope);
    EXPECT_NEAR(loss.Curvature(s), curvature, -1e-6 * curvature);
  }
}

TEST(GemanMcClureLoss, HandsTheSameNumbersToCeres) {
  const GemanMcClure loss{2.5};
  double rho[3];
  GemanMcClureLoss(loss).Evaluate(1.3, rho);
  EXPECT_EQ(rho[0], loss.Rho(1.3));
  EXPECT_EQ(rho[1], loss.Weight(1.3));
  EXPECT_EQ(rho[2], loss.Curvature(1.3));
}

}  // namespace
}  // namespace plumbline
