#include "plumbline/apps/io/number_text.h"

#include <gtest/gtest.h>

#include <cstdlib>
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

TEST(NumberTextTest, ExactNumbersComeBackToTheLastBit) {
  EXPECT_EQ(ExactText(0.1), "0.1");
  EXPECT_EQ(ExactText(81.83), "81.83");
  EXPECT_EQ(ExactText(-3.0), "-3");
  for (const double value :
       {1.0 / 3.0, -2.2250738585072014e-308, 1e9 + 0.1, std::numeric_limits<double>::denorm_min(),
        std::numeric_limits<double>::lowest()}) {
    EXPECT_EQ(std::strtod(ExactText(value).c_str(), nullptr), value) << ExactText(value);
  }
}

TEST(NumberTextTest, AFloatBecomesTheDecimalItStandsFor) {
  EXPECT_EQ(ShortestDecimal(3.45F), 3.45);
  EXPECT_EQ(ShortestDecimal(81.83F), 81.83);
  EXPECT_EQ(ShortestDecimal(-0.5F), -0.5);
  for (const float value : {1.0F / 3.0F, 16777217.0F, std::numeric_limits<float>::denorm_min()}) {
    EXPECT_EQ(static_cast<float>(ShortestDecimal(value)), value);
  }
}

}  // namespace
}  // namespace plumbline
