#include "plumbline/solvers/full/block_jacobi.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

TEST(BlockJacobiTest, SolvesEachBlock) {
  // [2 1; 1 3] x = [3; 4] has x = [1; 1]; diag(4, 0.5) x = [8; 1] has x = [2; 2].
  BlockJacobi<2> preconditioner;
  ThreadPool pool(1);
  preconditioner.Set({2.0, 1.0, 3.0, 4.0, 0.0, 0.5}, &pool);
  std::vector<double> x;
  preconditioner.Apply({3.0, 4.0, 8.0, 1.0}, &pool, &x);
  ASSERT_EQ(x.size(), 4u);
  const double expected[] = {1.0, 1.0, 2.0, 2.0};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(x[i], expected[i], 1e-14);
}

TEST(BlockJacobiTest, ReadsUpperTrianglesRowByRow) {
  // The inverse of [4 2 0; 2 5 1; 0 1 3] applied to its product with (1, 2, 3).
  BlockJacobi<3> preconditioner;
  ThreadPool pool(1);
  preconditioner.Set({4.0, 2.0, 0.0, 5.0, 1.0, 3.0}, &pool);
  std::vector<double> x;
  preconditioner.Apply({8.0, 15.0, 11.0}, &pool, &x);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(x[i], i + 1.0, 1e-13);
}

TEST(BlockJacobiTest, HoldsVariablesThatTooFewResidualsSee) {
  BlockJacobi<2> preconditioner;
  ThreadPool pool(1);
  // Unseen, seen along one direction only (exactly and to rounding), not finite, and a sound one.
  const double third = 1.0 / 3.0;
  preconditioner.Set({0.0, 0.0, 0.0,                      //
                      1.0, 1.0, 1.0,                      //
                      third * third, third, 1.0 + 1e-15,  //
                      kNaN, 0.0, 1.0,                     //
                      1e-8, 0.0, 1e8},
                     &pool);
  std::vector<double> x;
  preconditioner.Apply(std::vector<double>(10, 1.0), &pool, &x);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(x[i], 0.0) << i;
  EXPECT_NEAR(x[8], 1e8, 1e-4);
  EXPECT_NEAR(x[9], 1e-8, 1e-20);
}

TEST(BlockJacobiTest, AnyNumberOfThreadsGivesTheSameBits) {
  constexpr int kBlocks = 50000;
  RandomStates random(1);
  std::vector<double> blocks, gradient, one;
  for (int b = 0; b < kBlocks; ++b) {
    blocks.insert(blocks.end(),
                  {random.Uniform(1, 2), random.Uniform(-1, 1), random.Uniform(1, 2)});
    gradient.insert(gradient.end(), {random.Gaussian(1.0), random.Gaussian(1.0)});
  }
  for (const int num_threads : {1, 2, 3, 8}) {
    ThreadPool pool(num_threads);
    BlockJacobi<2> preconditioner;
    preconditioner.Set(blocks, &pool);
    std::vector<double> x;
    preconditioner.Apply(gradient, &pool, &x);
    if (num_threads == 1) one = x;
    EXPECT_EQ(x, one) << num_threads;
  }
}

}  // namespace
}  // namespace plumbline
