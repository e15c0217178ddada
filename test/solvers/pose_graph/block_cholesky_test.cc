#include "plumbline/solvers/pose_graph/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace plumbline {
namespace {

// A chain with loops, as a drive is, and its matrix both ways.
class LoopyChain {
 public:
  explicit LoopyChain(int num_nodes, int num_loops)
      : num_nodes_(num_nodes), dense_(Eigen::MatrixXd::Zero(3 * num_nodes, 3 * num_nodes)) {
    std::vector<std::pair<int, int>> couplings;
    for (int node = 1; node < num_nodes; ++node) couplings.emplace_back(node - 1, node);
    std::uniform_int_distribution<int> any(0, num_nodes - 1);
    for (int loop = 0; loop < num_loops; ++loop) {
      const int a = any(random_), b = any(random_);
      if (a != b) couplings.emplace_back(b, a);
    }
    blocks_ = BlockCholesky(num_nodes, couplings);
    for (const auto& [a, b] : couplings) AddEdge(a, b);
    // Long products of random matrices would be singular but for this.
    for (int node = 0; node < num_nodes; ++node) AddToDiagonal(node, 0.1);
  }

  void AddToDiagonal(int node, double value) {
    blocks_.AddToDiagonal(node, value * Eigen::Matrix3d::Identity());
    dense_.block<3, 3>(3 * node, 3 * node) += value * Eigen::Matrix3d::Identity();
  }

  double LargestErrorOfSolution() {
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(3 * num_nodes_, -1.0, 2.0);
    Eigen::VectorXd solution = right;
    blocks_.Solve(&solution);
    return (solution - dense_.ldlt().solve(right)).lpNorm<Eigen::Infinity>() /
           solution.lpNorm<Eigen::Infinity>();
  }

  BlockCholesky& blocks() { return blocks_; }

 private:
  // Of an edge with random derivatives.
  void AddEdge(int a, int b) {
    std::normal_distribution<double> normal;
    Eigen::Matrix3d by_a, by_b;
    for (int i = 0; i < 9; ++i) {
      by_a(i) = normal(random_);
      by_b(i) = normal(random_);
    }
    blocks_.AddToDiagonal(a, by_a.transpose() * by_a);
    blocks_.AddToDiagonal(b, by_b.transpose() * by_b);
    const Eigen::Matrix3d coupling = by_a.transpose() * by_b;
    const std::size_t at = blocks_.FindCoupling(a, b);
    EXPECT_EQ(at, blocks_.FindCoupling(b, a));
    EXPECT_NE(blocks_.HasRowsOf(a, b), blocks_.HasRowsOf(b, a));
    if (blocks_.HasRowsOf(a, b)) {
      blocks_.AddToCoupling(at, coupling);
    } else {
      blocks_.AddToCoupling(at, coupling.transpose());
    }
    dense_.block<3, 3>(3 * a, 3 * a) += by_a.transpose() * by_a;
    dense_.block<3, 3>(3 * b, 3 * b) += by_b.transpose() * by_b;
    dense_.block<3, 3>(3 * a, 3 * b) += coupling;
    dense_.block<3, 3>(3 * b, 3 * a) += coupling.transpose();
  }

  std::mt19937 random_{7};
  int num_nodes_;
  Eigen::MatrixXd dense_;
  BlockCholesky blocks_;
};

TEST(BlockCholesky, SolvesAsADenseFactorisationDoes) {
  for (const int num_nodes : {1, 2, 7, 60}) {
    for (const int num_loops : {0, 1, 40}) {
      LoopyChain chain(num_nodes, num_nodes > 2 ? num_loops : 0);
      ASSERT_TRUE(chain.blocks().Factorize());
      EXPECT_LT(chain.LargestErrorOfSolution(), 1e-7) << num_nodes << ' ' << num_loops;
    }
  }
}

TEST(BlockCholesky, ValuesChangeUnderOnePattern) {
  LoopyChain chain(40, 15);
  ASSERT_TRUE(chain.blocks().Factorize());
  chain.AddToDiagonal(17, 5.0);
  ASSERT_TRUE(chain.blocks().Factorize());
  EXPECT_LT(chain.LargestErrorOfSolution(), 1e-7);
}

TEST(BlockCholesky, RefusesAMatrixThatIsNotPositiveDefinite) {
  LoopyChain chain(40, 15);
  chain.AddToDiagonal(20, -1e3);
  EXPECT_FALSE(chain.blocks().Factorize());
  chain.AddToDiagonal(20, 1e3 + 1.0);
  ASSERT_TRUE(chain.blocks().Factorize());
  EXPECT_LT(chain.LargestErrorOfSolution(), 1e-7);
}

TEST(BlockCholesky, IsEmptyAfterSetZero) {
  LoopyChain chain(5, 0);
  chain.blocks().SetZero();
  EXPECT_FALSE(chain.blocks().Factorize());
  for (int node = 0; node < 5; ++node) {
    chain.blocks().AddToDiagonal(node, 2.0 * Eigen::Matrix3d::Identity());
  }
  ASSERT_TRUE(chain.blocks().Factorize());
  Eigen::VectorXd x = Eigen::VectorXd::Ones(15);
  chain.blocks().Solve(&x);
  EXPECT_TRUE(x.isApprox(Eigen::VectorXd::Constant(15, 0.5)));
}

}  // namespace
}  // namespace plumbline
