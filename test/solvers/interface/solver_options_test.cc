#include "plumbline/solvers/interface/solver_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>

#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

TEST(SolverOptionsTest, DefaultsAreSound) {
  std::string error;
  EXPECT_TRUE(SolverOptions().Check(&error)) << error;
}

TEST(SolverOptionsTest, NamesTheFieldThatIsWrong) {
  const auto expect_refused = [](const char* field,
                                 const std::function<void(SolverOptions*)>& spoil) {
    SolverOptions options;
    spoil(&options);
    std::string error;
    EXPECT_FALSE(options.Check(&error)) << field;
    EXPECT_THAT(error, testing::StartsWith(std::string(field) + " = "));
    EXPECT_FALSE(options.Check(nullptr));
  };
  using Options = SolverOptions;
  expect_refused("num_threads", [](Options* o) { o->num_threads = 0; });
  expect_refused("factors.beam.sigma_range_m",
                 [](Options* o) { o->factors.beam.sigma_range_m = 0; });
  expect_refused("association.landmark_size_m",
                 [](Options* o) { o->association.landmark_size_m = 0.0; });
  expect_refused("rounds.max_coarse_rounds", [](Options* o) { o->rounds.max_coarse_rounds = -1; });
  expect_refused("rounds.max_fine_rounds", [](Options* o) { o->rounds.max_fine_rounds = 0; });
  expect_refused("rounds.fine_radius_m", [](Options* o) { o->rounds.fine_radius_m = 0; });
  expect_refused("rounds.coarse_radius_m", [](Options* o) { o->rounds.coarse_radius_m = 0.05; });
  expect_refused("rounds.coarse_radius_m",
                 [](Options* o) { o->rounds.coarse_radius_m = kInfinity; });
  expect_refused("alternating_cg.max_sweeps", [](Options* o) { o->alternating_cg.max_sweeps = 0; });
  expect_refused("alternating_cg.scan_iterations_per_sweep",
                 [](Options* o) { o->alternating_cg.scan_iterations_per_sweep = -1; });
  expect_refused("alternating_cg.relative_cost_tolerance",
                 [](Options* o) { o->alternating_cg.relative_cost_tolerance = kNaN; });
  expect_refused("num_threads", [](Options* o) { o->num_threads = 2000; });
  expect_refused("ceres.max_num_iterations", [](Options* o) { o->ceres->max_num_iterations = 0; });
  expect_refused("ceres.function_tolerance", [](Options* o) { o->ceres->function_tolerance = -1; });
}

TEST(SolverOptionsTest, TheLimitsThemselvesAreAllowed) {
  SolverOptions options;
  options.num_threads = 1;
  options.rounds = {0, 1, 0.1, 0.1};
  options.alternating_cg = {1, 0, 0.0};
  options.ceres->max_num_iterations = 1;
  options.ceres->function_tolerance = 0.0;
  std::string error;
  EXPECT_TRUE(options.Check(&error)) << error;
}

TEST(SolverOptionsTest, ACopyHasCeresOptionsOfItsOwn) {
  SolverOptions options;
  options.ceres->max_num_iterations = 7;
  SolverOptions copy = options, assigned;
  assigned = options;
  options.ceres->max_num_iterations = 8;
  EXPECT_EQ(copy.ceres->max_num_iterations, 7);
  EXPECT_EQ(assigned.ceres->max_num_iterations, 7);
  const SolverOptions moved = std::move(copy);
  EXPECT_EQ(moved.ceres->max_num_iterations, 7);
  EXPECT_TRUE(copy.Check(nullptr));  // NOLINT: still options
}

TEST(SolverOptionsTest, SolverTypesGoToNamesAndBack) {
  for (const SolverType type :
       {SolverType::kAlternatingCg, SolverType::kCeres, SolverType::kPoseGraph, SolverType::kSgd}) {
    SolverType back = type == SolverType::kCeres ? SolverType::kAlternatingCg : SolverType::kCeres;
    EXPECT_TRUE(FromString(ToString(type), &back));
    EXPECT_EQ(back, type);
  }
  SolverType type = SolverType::kCeres;
  EXPECT_FALSE(FromString("Ceres", &type));
  EXPECT_FALSE(FromString("", &type));
  EXPECT_EQ(type, SolverType::kCeres);
}

}  // namespace
}  // namespace plumbline
