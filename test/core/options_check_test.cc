#include "plumbline/core/options_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace plumbline {
namespace {

struct Inner {
  int count = 1;
  double sigma_m = 0.5;
  int percentage = 50;

  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_OPTION(count, >, 0);
    PLUMBLINE_CHECK_FINITE_OPTION(sigma_m, >, 0.0);
    PLUMBLINE_CHECK_OPTION_WITHIN(percentage, 0, 100);
    return true;
  }
};

struct Outer {
  Inner inner;
  double share = 0.5;

  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_NESTED_OPTIONS(inner);
    PLUMBLINE_CHECK_OPTION(share, <=, 1.0);
    return true;
  }
};

struct Outermost {
  Outer outer;

  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_NESTED_OPTIONS(outer);
    return true;
  }
};

std::string ErrorOf(const Outermost& options) {
  std::string error;
  const bool passes = options.Check(&error);
  EXPECT_EQ(passes, error.empty());
  EXPECT_EQ(options.Check(nullptr), passes);
  return error;
}

TEST(OptionsCheck, GoodOptionsPassWithoutAMessage) { EXPECT_EQ(ErrorOf({}), ""); }

TEST(OptionsCheck, NamesFieldValueAndBound) {
  Outermost options;
  options.outer.share = 1.5;
  EXPECT_EQ(ErrorOf(options), "outer.share = 1.5, but it must be <= 1.0");
}

TEST(OptionsCheck, NamesThePathToANestedField) {
  Outermost options;
  options.outer.inner.count = 0;
  EXPECT_EQ(ErrorOf(options), "outer.inner.count = 0, but it must be > 0");
}

TEST(OptionsCheck, ARangeIncludesItsBounds) {
  Outermost options;
  for (const int good : {0, 100}) {
    options.outer.inner.percentage = good;
    EXPECT_EQ(ErrorOf(options), "");
  }
  options.outer.inner.percentage = -1;
  EXPECT_EQ(ErrorOf(options), "outer.inner.percentage = -1, but it must be >= 0");
  options.outer.inner.percentage = 101;
  EXPECT_EQ(ErrorOf(options), "outer.inner.percentage = 101, but it must be <= 100");
}

TEST(OptionsCheck, RefusesNaNAndInfinity) {
  Outermost options;
  options.outer.inner.sigma_m = std::nan("");
  EXPECT_EQ(ErrorOf(options), "outer.inner.sigma_m = nan, but it must be > 0.0");
  options.outer.inner.sigma_m = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ErrorOf(options), "outer.inner.sigma_m = inf, but it must be finite");
  options = Outermost();
  options.outer.share = std::nan("");
  EXPECT_EQ(ErrorOf(options), "outer.share = nan, but it must be <= 1.0");
}

}  // namespace
}  // namespace plumbline
