#include "plumbline/apps/simulation/noise_source.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// Values of an independent implementation of std::seed_seq and the 64-bit Mersenne twister.
TEST(NoiseSourceTest, IsTheSameOnEveryPlatform) {
  NoiseSource source((std::uint64_t{1} << 32) + 7, 3);
  EXPECT_EQ(source.Uniform(), 0.6651299488704796);
  EXPECT_EQ(source.Uniform(), 0.5210568050251893);
  EXPECT_NEAR(source.Gaussian(), 0.32328994703091113, 1e-15);
}

TEST(NoiseSourceTest, GaussianHasTheMomentsOfAStandardNormal) {
  NoiseSource source(1, 0);
  const int n = 200000;
  double sum = 0.0, sum_squares = 0.0, sum_fourth = 0.0;
  for (int i = 0; i < n; ++i) {
    const double x = source.Gaussian();
    sum += x;
    sum_squares += x * x;
    sum_fourth += x * x * x * x;
  }
  // Four standard errors: variances of x, x^2 and x^4 are 1, 2 and 96.
  EXPECT_NEAR(sum / n, 0.0, 4.0 * std::sqrt(1.0 / n));
  EXPECT_NEAR(sum_squares / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(sum_fourth / n, 3.0, 4.0 * std::sqrt(96.0 / n));
}

TEST(NoiseSourceTest, StreamsDiffer) {
  NoiseSource a(1, 0), b(1, 1), c(2, 0);
  const double first = a.Uniform();
  EXPECT_NE(first, b.Uniform());
  EXPECT_NE(first, c.Uniform());
}

}  // namespace
}  // namespace plumbline
