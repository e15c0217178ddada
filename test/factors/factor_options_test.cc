#include "plumbline/factors/factor_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

struct Field {
  const char* name;
  bool may_be_zero;
  std::function<double&(FactorOptions&)> value;
  bool may_be_infinite = false;
};

std::vector<Field> Fields() {
  using O = FactorOptions;
  return {
      {"motion.rotation_per_rotation", true,
       [](O& o) -> double& { return o.motion.rotation_per_rotation; }},
      {"motion.rotation_per_translation_rad_m", true,
       [](O& o) -> double& { return o.motion.rotation_per_translation_rad_m; }},
      {"motion.translation_per_translation", true,
       [](O& o) -> double& { return o.motion.translation_per_translation; }},
      {"motion.translation_per_rotation_m_rad", true,
       [](O& o) -> double& { return o.motion.translation_per_rotation_m_rad; }},
      {"motion.translation_floor_m", false,
       [](O& o) -> double& { return o.motion.translation_floor_m; }},
      {"motion.rotation_floor_rad", false,
       [](O& o) -> double& { return o.motion.rotation_floor_rad; }},
      {"beam.sigma_range_m", false, [](O& o) -> double& { return o.beam.sigma_range_m; }},
      {"beam.sigma_bearing_rad", false, [](O& o) -> double& { return o.beam.sigma_bearing_rad; }},
      {"manifold.sigma_m", false, [](O& o) -> double& { return o.manifold.sigma_m; }},
      {"manifold.robust_gate_sigmas", false,
       [](O& o) -> double& { return o.manifold.robust_gate_sigmas; }, true},
  };
}

TEST(FactorOptions, DefaultsPass) {
  std::string error;
  EXPECT_TRUE(FactorOptions().Check(&error)) << error;
}

TEST(FactorOptions, NamesTheFieldOutOfRange) {
  for (const Field& field : Fields()) {
    for (const double bad : {-1.0, kNaN, 1e20, kInfinity}) {
      FactorOptions options;
      field.value(options) = bad;
      if (bad > 0.0 && field.may_be_infinite) {
        EXPECT_TRUE(options.Check(nullptr)) << field.name;
        continue;
      }
      std::string error;
      EXPECT_FALSE(options.Check(&error)) << field.name << " = " << bad;
      EXPECT_THAT(error, testing::StartsWith(std::string(field.name) + " = "));
      EXPECT_FALSE(options.Check(nullptr));
    }
  }
}

TEST(FactorOptions, NothingIsANoiselessDriveButNoSigma) {
  for (const Field& field : Fields()) {
    for (const double nothing : {0.0, 1e-300}) {
      FactorOptions options;
      field.value(options) = nothing;
      EXPECT_EQ(options.Check(nullptr), field.may_be_zero) << field.name;
    }
  }
}

}  // namespace
}  // namespace plumbline
