#include "plumbline/apps/number_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace plumbline {
namespace {

TEST(NumberTextTest, ThousandsArePartedByCommas) {
  EXPECT_EQ(WithThousands(0), "0");
  EXPECT_EQ(WithThousands(999), "999");
  EXPECT_EQ(WithThousands(1000), "1,000");
  EXPECT_EQ(WithThousands(1739359), "1,739,359");
}

TEST(NumberTextTest, WhatIsNotFiniteIsADash) {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(FixedText(value, 2), "-");
    EXPECT_EQ(ShortText(value), "-");
  }
  EXPECT_EQ(FixedText(-2.345, 1), "-2.3");
  EXPECT_EQ(FixedText(12345678.0, 0), "12345678");
  EXPECT_EQ(ShortText(0.012), "0.012");
  EXPECT_EQ(ShortText(5185365.0), "5.1854e+06");
}

}  // namespace
}  // namespace plumbline
