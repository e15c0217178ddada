#include "plumbline/core/return_normal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace plumbline {
namespace {

TEST(ReturnNormalTest, TakesTwoBytes) { EXPECT_EQ(sizeof(ReturnNormal), 2u); }

TEST(ReturnNormalTest, KeepsAnyDirectionToHalfAStep) {
  double worst = 0.0;
  for (int i = 0; i < 700000; ++i) {
    const double angle_rad = 1e-5 * i - 3.5;
    const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
    const ReturnNormal normal(0.2 * direction);
    ASSERT_FALSE(normal.IsNone());
    worst = std::max(worst, (normal.Direction() - direction).norm());
    ASSERT_NEAR(normal.Direction().norm(), 1.0, 1e-14);
    ASSERT_GE(normal.Turns(), 0.0);
    ASSERT_LT(normal.Turns(), 1.0);
    const double turned_rad = 2.0 * kPi * normal.Turns();
    ASSERT_NEAR(normal.Direction().x(), std::cos(turned_rad), 1e-14);
    ASSERT_NEAR(normal.Direction().y(), std::sin(turned_rad), 1e-14);
  }
  EXPECT_GT(worst, 4.5e-5);
  EXPECT_LT(worst, 4.9e-5);
}

TEST(ReturnNormalTest, AxesAreExact) {
  for (const Eigen::Vector2d& axis : {Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(0.0, 1.0),
                                      Eigen::Vector2d(-1.0, 0.0), Eigen::Vector2d(0.0, -1.0)}) {
    EXPECT_EQ(ReturnNormal(axis).Direction(), axis);
  }
  EXPECT_EQ(ReturnNormal({1.0, 1.0}).Turns(), 0.125);
  // Just below a full turn is no turn.
  EXPECT_EQ(ReturnNormal({1.0, -1e-7}).Direction(), Eigen::Vector2d(1.0, 0.0));
}

TEST(ReturnNormalTest, NoneIsNotADirection) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const ReturnNormal& none :
       {ReturnNormal(), ReturnNormal({0.0, 0.0}), ReturnNormal({nan, 1.0})}) {
    EXPECT_TRUE(none.IsNone());
    EXPECT_EQ(none, ReturnNormal());
    EXPECT_EQ(none.Direction(), Eigen::Vector2d(0.0, 0.0));
  }
  EXPECT_NE(ReturnNormal(), ReturnNormal({1.0, 0.0}));
}

}  // namespace
}  // namespace plumbline
