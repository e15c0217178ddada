#include "plumbline/core/angle.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace plumbline {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(NormalizeAngle, KnownValues) {
  EXPECT_EQ(NormalizeAngle(0.0), 0.0);
  EXPECT_EQ(NormalizeAngle(1.5), 1.5);
  EXPECT_EQ(NormalizeAngle(-kPi), -kPi);
  EXPECT_EQ(NormalizeAngle(kPi), -kPi);
  EXPECT_NEAR(NormalizeAngle(1.5 * kPi), -0.5 * kPi, 1e-15);
  EXPECT_NEAR(NormalizeAngle(-1.5 * kPi), 0.5 * kPi, 1e-15);
  EXPECT_NEAR(NormalizeAngle(7.25 * kPi), -0.75 * kPi, 1e-14);
}

TEST(NormalizeAngle, StaysInTheHalfOpenIntervalNextToTheCut) {
  for (const int turns : {0, 1, -1, 2, -2, 7, -1000, 1000000}) {
    for (const double cut : {kPi, -kPi}) {
      const double angle = cut + turns * 2.0 * kPi;
      for (const double nearby :
           {angle, std::nextafter(angle, kInfinity), std::nextafter(angle, -kInfinity)}) {
        const double wrapped = NormalizeAngle(nearby);
        EXPECT_GE(wrapped, -kPi) << "turns " << turns;
        EXPECT_LT(wrapped, kPi) << "turns " << turns;
        EXPECT_NEAR(std::remainder(wrapped - nearby, 2.0 * kPi), 0.0, 1e-9) << "turns " << turns;
        EXPECT_EQ(NormalizeAngle(wrapped), wrapped) << "turns " << turns;
      }
    }
  }
}

TEST(NormalizeAngle, PassesNonFiniteOnAsNaN) {
  EXPECT_TRUE(std::isnan(NormalizeAngle(std::nan(""))));
  EXPECT_TRUE(std::isnan(NormalizeAngle(kInfinity)));
}

TEST(NormalizeAngle, DerivativeIsOneOnEveryTurn) {
  using Jet = ceres::Jet<double, 1>;
  for (const double angle : {-9.0, -kPi, -0.3, 0.0, 3.0, kPi, 4.0, 100.0}) {
    const Jet wrapped = NormalizeAngle(Jet(angle, 0));
    EXPECT_EQ(wrapped.a, NormalizeAngle(angle));
    EXPECT_EQ(wrapped.v[0], 1.0);
  }
}

TEST(AngleOf, IsTheArcTangentOfAnyVector) {
  for (const double angle : {0.0, 1e-9, 0.01, 0.0499, 0.0501, 0.7, 1.6, 3.1}) {
    for (const double sign : {-1.0, 1.0}) {
      const double x = 3.0 * std::cos(sign * angle), y = 3.0 * std::sin(sign * angle);
      EXPECT_NEAR(AngleOf(x, y), std::atan2(y, x), 1e-16 + 4e-16 * angle) << sign * angle;
    }
  }
  EXPECT_EQ(AngleOf(-1.0, 0.0), kPi);
  EXPECT_EQ(AngleOf(0.0, 2.0), std::atan2(2.0, 0.0));
  EXPECT_EQ(AngleOf(0.0, 0.0), 0.0);
  EXPECT_TRUE(std::isnan(AngleOf(std::nan(""), 1.0)));
}

TEST(Angle, DegreesAndRadians) {
  EXPECT_DOUBLE_EQ(DegToRad(180.0), kPi);
  EXPECT_DOUBLE_EQ(RadToDeg(-0.5 * kPi), -90.0);
}

}  // namespace
}  // namespace plumbline
