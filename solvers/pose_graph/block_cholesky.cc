#include "plumbline/solvers/pose_graph/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace plumbline {

BlockCholesky::BlockCholesky(int num_nodes, const std::vector<std::pair<int, int>>& couplings)
    : diagonal_(num_nodes, Eigen::Matrix3d::Zero()) {
  ChooseOrder(couplings);
  LayPattern(couplings);
  Analyze();
}

void BlockCholesky::ChooseOrder(const std::vector<std::pair<int, int>>& couplings) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(couplings.size() + diagonal_.size());
  for (int node = 0; node < num_nodes(); ++node) entries.emplace_back(node, node, 1.0);
  for (const auto& [a, b] : couplings) entries.emplace_back(a, b, 1.0);
  Eigen::SparseMatrix<double> pattern(num_nodes(), num_nodes());
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> node_at_place;
  Eigen::AMDOrdering<int>()(pattern, node_at_place);  // takes the pattern with its transpose
  place_.resize(diagonal_.size());
  for (int i = 0; i < num_nodes(); ++i) place_[node_at_place.indices()[i]] = i;
}

void BlockCholesky::LayPattern(const std::vector<std::pair<int, int>>& couplings) {
  std::vector<std::pair<int, int>> blocks;  // column, row
  blocks.reserve(couplings.size());
  for (const auto& [a, b] : couplings) {
    const auto [row, column] = std::minmax({place_[a], place_[b]});
    blocks.emplace_back(column, row);
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  first_of_column_.assign(diagonal_.size() + 1, 0);
  row_of_coupling_.clear();
  for (const auto& [column, row] : blocks) {
    ++first_of_column_[column + 1];
    row_of_coupling_.push_back(row);
  }
  for (std::size_t i = 1; i < first_of_column_.size(); ++i) {
    first_of_column_[i] += first_of_column_[i - 1];
  }
  couplings_.assign(blocks.size(), Eigen::Matrix3d::Zero());
}

void BlockCholesky::Analyze() {
  const int size = num_nodes();
  parent_.assign(size, -1);
  met_.assign(size, -1);
  std::vector<std::size_t> num_blocks(size, 0);
  for (int row = 0; row < size; ++row) {
    met_[row] = row;
    for (std::size_t k = first_of_column_[row]; k < first_of_column_[row + 1]; ++k) {
      for (int i = row_of_coupling_[k]; met_[i] != row; i = parent_[i]) {
        if (parent_[i] < 0) parent_[i] = row;
        ++num_blocks[i];
        met_[i] = row;
      }
    }
  }
  first_of_factor_.assign(size + 1, 0);
  for (int i = 0; i < size; ++i) first_of_factor_[i + 1] = first_of_factor_[i] + num_blocks[i];
  row_of_factor_.resize(first_of_factor_.back());
  factor_.resize(first_of_factor_.back());
  inverse_pivot_.resize(size);
  solution_.assign(size, Eigen::Matrix3d::Zero());
}

std::size_t BlockCholesky::FindCoupling(int a, int b) const {
  const auto [row, column] = std::minmax({place_[a], place_[b]});
  const auto begin =
      row_of_coupling_.begin() + static_cast<std::ptrdiff_t>(first_of_column_[column]);
  const auto end =
      row_of_coupling_.begin() + static_cast<std::ptrdiff_t>(first_of_column_[column + 1]);
  return static_cast<std::size_t>(std::lower_bound(begin, end, row) - row_of_coupling_.begin());
}

void BlockCholesky::SetZero() {
  std::fill(diagonal_.begin(), diagonal_.end(), Eigen::Matrix3d::Zero());
  std::fill(couplings_.begin(), couplings_.end(), Eigen::Matrix3d::Zero());
}

void BlockCholesky::FindRow(int row) {
  in_row_.clear();
  met_[row] = row;
  for (std::size_t k = first_of_column_[row]; k < first_of_column_[row + 1]; ++k) {
    path_.clear();
    for (int i = row_of_coupling_[k]; met_[i] != row; i = parent_[i]) {
      path_.push_back(i);
      met_[i] = row;
    }
    // A path comes before those found so far, which it may lead into.
    in_row_.insert(in_row_.end(), path_.rbegin(), path_.rend());
  }
  std::reverse(in_row_.begin(), in_row_.end());
}

bool BlockCholesky::Factorize() {
  end_of_factor_.assign(first_of_factor_.begin(), first_of_factor_.end() - 1);
  std::fill(met_.begin(), met_.end(), -1);
  for (int row = 0; row < num_nodes(); ++row) {
    FindRow(row);
    for (std::size_t k = first_of_column_[row]; k < first_of_column_[row + 1]; ++k) {
      solution_[row_of_coupling_[k]] = couplings_[k];
    }
    Eigen::Matrix3d pivot = diagonal_[row];
    for (const int i : in_row_) {
      const Eigen::Matrix3d above = solution_[i];
      solution_[i].setZero();
      for (std::size_t k = first_of_factor_[i]; k < end_of_factor_[i]; ++k) {
        solution_[row_of_factor_[k]].noalias() -= factor_[k] * above;
      }
      const Eigen::Matrix3d left = above.transpose() * inverse_pivot_[i];
      pivot.noalias() -= left * above;
      const std::size_t at = end_of_factor_[i]++;
      row_of_factor_[at] = row;
      factor_[at] = left;
    }
    const Eigen::LLT<Eigen::Matrix3d> cholesky(pivot);
    if (cholesky.info() != Eigen::Success) {
      std::fill(solution_.begin(), solution_.end(), Eigen::Matrix3d::Zero());
      return false;
    }
    inverse_pivot_[row] = cholesky.solve(Eigen::Matrix3d::Identity());
  }
  return true;
}

void BlockCholesky::Solve(Eigen::VectorXd* x) const {
  std::vector<Eigen::Vector3d> ordered(place_.size());
  for (std::size_t node = 0; node < place_.size(); ++node) {
    ordered[place_[node]] = x->segment<3>(static_cast<Eigen::Index>(3 * node));
  }
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t k = first_of_factor_[i]; k < first_of_factor_[i + 1]; ++k) {
      ordered[row_of_factor_[k]].noalias() -= factor_[k] * ordered[i];
    }
  }
  for (std::size_t i = ordered.size(); i-- > 0;) {
    ordered[i] = inverse_pivot_[i] * ordered[i];
    for (std::size_t k = first_of_factor_[i]; k < first_of_factor_[i + 1]; ++k) {
      ordered[i].noalias() -= factor_[k].transpose() * ordered[row_of_factor_[k]];
    }
  }
  for (std::size_t node = 0; node < place_.size(); ++node) {
    x->segment<3>(static_cast<Eigen::Index>(3 * node)) = ordered[place_[node]];
  }
}

}  // namespace plumbline
