#include "plumbline/solvers/reduced/pose_chain.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>

#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

// Of each row of this process, the block left of the diagonal.
std::vector<Eigen::Matrix3d> LowerBlocks(const PoseSystem& system) {
  std::vector<Eigen::Matrix3d> lower(system.diagonal.size(), Eigen::Matrix3d::Zero());
  for (const PoseCoupling& coupling : system.couplings) {
    const bool are_neighbours = system.PlaceOf(coupling.to) == system.PlaceOf(coupling.from) + 1;
    if (are_neighbours) lower[coupling.to] += coupling.block;
  }
  return lower;
}

void SumBlocks(const Peers& peers, std::vector<Eigen::Matrix3d>* blocks) {
  if (!blocks->empty()) peers.Sum(blocks->front().data(), 9 * blocks->size());
}

Eigen::Map<Eigen::Vector3d> BlockOf(double* x, std::size_t i) {
  return Eigen::Map<Eigen::Vector3d>(x + 3 * i);
}

Eigen::Vector3d At(const Eigen::VectorXd& v, std::size_t row) {
  return v.segment<3>(3 * static_cast<Eigen::Index>(row));
}

}  // namespace

BlockTridiagonal::BlockTridiagonal(const std::vector<Eigen::Matrix3d>& diagonal,
                                   const std::vector<Eigen::Matrix3d>& lower) {
  const std::size_t n = diagonal.size();
  if (n == 0) return;
  inverse_.resize(n);
  lower_.resize(n);
  Eigen::Matrix3d pivot = diagonal[0];
  for (std::size_t i = 0;; ++i) {
    inverse_[i] = pivot.inverse();
    if (i + 1 == n) break;
    lower_[i + 1] = lower[i + 1] * inverse_[i];
    pivot = diagonal[i + 1] - lower_[i + 1] * lower[i + 1].transpose();
  }
}

void BlockTridiagonal::SolveInPlace(double* x) const {
  const std::size_t n = inverse_.size();
  Eigen::Vector3d carried = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    Eigen::Map<Eigen::Vector3d> at = BlockOf(x, i);
    carried = at - (i > 0 ? Eigen::Vector3d(lower_[i] * carried) : carried);
    at = carried;
  }
  Eigen::Vector3d above = Eigen::Vector3d::Zero();
  for (std::size_t i = n; i-- > 0;) {
    Eigen::Map<Eigen::Vector3d> at = BlockOf(x, i);
    Eigen::Vector3d solved = inverse_[i] * at;
    if (i + 1 < n) solved -= lower_[i + 1].transpose() * above;
    above = solved;
    at = solved;
  }
}

PoseChain::PoseChain(const PoseSystem& system) : peers_(system.peers) {
  if (peers_ == nullptr) {
    all_ = BlockTridiagonal(system.diagonal, LowerBlocks(system));
    return;
  }
  std::size_t num_stretches = 0;
  stretches_ = FindStretches(system, &num_stretches);
  std::vector<Eigen::Matrix3d> diagonal(num_stretches, Eigen::Matrix3d::Zero()), lower = diagonal;
  for (const Stretch& stretch : stretches_) {
    AddTo(stretch, system.diagonal[stretch.first], &diagonal, &lower);
  }
  SumBlocks(*peers_, &diagonal);
  SumBlocks(*peers_, &lower);
  all_ = BlockTridiagonal(diagonal, lower);
}

std::vector<PoseChain::Stretch> PoseChain::FindStretches(const PoseSystem& system,
                                                         std::size_t* num_stretches) const {
  const std::vector<Eigen::Matrix3d> lower = LowerBlocks(system);
  std::vector<Eigen::Matrix3d> to_next(lower.size(), Eigen::Matrix3d::Zero());
  for (const ForeignCoupling& coupling : system.foreign_couplings) {
    const bool is_next = system.place_of_pose[coupling.pose] == system.PlaceOf(coupling.row) + 1;
    if (is_next) to_next[coupling.row] += coupling.block;
  }
  std::vector<Stretch> stretches;
  int rank_before = -1;
  for (std::size_t pose = 0; pose < system.place_of_pose.size(); ++pose) {
    if (system.place_of_pose[pose] == PoseSystem::kConstant) continue;
    const int rank = system.rank_of_pose[pose];
    if (rank != rank_before) {
      if (rank_before == peers_->rank()) stretches.back().has_next = true;
      if (rank == peers_->rank()) {
        Stretch& stretch = stretches.emplace_back();
        stretch.id = static_cast<int>(*num_stretches);
        stretch.first = system.row_of_pose[pose];
      }
      ++*num_stretches;
    }
    rank_before = rank;
  }
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    Stretch& stretch = stretches[k];
    const std::size_t end = k + 1 < stretches.size() ? stretches[k + 1].first : lower.size();
    const auto inner = static_cast<std::ptrdiff_t>(stretch.first + 1);
    stretch.inner =
        BlockTridiagonal({system.diagonal.begin() + inner,
                          system.diagonal.begin() + static_cast<std::ptrdiff_t>(end)},
                         {lower.begin() + inner, lower.begin() + static_cast<std::ptrdiff_t>(end)});
    if (stretch.first + 1 < end) stretch.to_first = lower[stretch.first + 1];
    if (stretch.has_next) stretch.to_next = to_next[end - 1];
  }
  return stretches;
}

void PoseChain::AddTo(const Stretch& stretch, const Eigen::Matrix3d& first_diagonal,
                      std::vector<Eigen::Matrix3d>* diagonal, std::vector<Eigen::Matrix3d>* lower) {
  (*diagonal)[stretch.id] += first_diagonal;
  const std::size_t num_inner = stretch.inner.num_blocks();
  if (num_inner == 0) {
    if (stretch.has_next) (*lower)[stretch.id + 1] += stretch.to_next.transpose();
    return;
  }
  // What the inner rows answer to a motion of the one or the other end: their first and last row.
  const std::size_t last = num_inner - 1;
  Eigen::Matrix3d first_by_first, last_by_first, last_by_next;
  std::vector<double> x(3 * num_inner);
  for (int column = 0; column < 3; ++column) {
    std::fill(x.begin(), x.end(), 0.0);
    BlockOf(x.data(), 0) = stretch.to_first.col(column);
    stretch.inner.SolveInPlace(x.data());
    first_by_first.col(column) = BlockOf(x.data(), 0);
    last_by_first.col(column) = BlockOf(x.data(), last);
    std::fill(x.begin(), x.end(), 0.0);
    BlockOf(x.data(), last) = stretch.to_next.col(column);
    stretch.inner.SolveInPlace(x.data());
    last_by_next.col(column) = BlockOf(x.data(), last);
  }
  (*diagonal)[stretch.id] -= stretch.to_first.transpose() * first_by_first;
  if (!stretch.has_next) return;
  (*diagonal)[stretch.id + 1] -= stretch.to_next.transpose() * last_by_next;
  (*lower)[stretch.id + 1] -= stretch.to_next.transpose() * last_by_first;
}

void PoseChain::Solve(const Eigen::VectorXd& v, Eigen::VectorXd* result) const {
  *result = v;
  if (peers_ == nullptr) {
    all_.SolveInPlace(result->data());
    return;
  }
  std::vector<double> ends(3 * all_.num_blocks(), 0.0);
  const auto end_at = [&ends](std::size_t id) { return BlockOf(ends.data(), id); };
  const auto inner_rows = [result](const Stretch& stretch) {
    return result->data() + 3 * (stretch.first + 1);
  };
  for (const Stretch& stretch : stretches_) {
    end_at(stretch.id) += At(v, stretch.first);
    const std::size_t num_inner = stretch.inner.num_blocks();
    if (num_inner == 0) continue;
    stretch.inner.SolveInPlace(inner_rows(stretch));
    end_at(stretch.id) -= stretch.to_first.transpose() * At(*result, stretch.first + 1);
    if (!stretch.has_next) continue;
    end_at(stretch.id + 1) -= stretch.to_next.transpose() * At(*result, stretch.first + num_inner);
  }
  SumOverPeers(peers_, &ends);
  all_.SolveInPlace(ends.data());
  *result = v;
  for (const Stretch& stretch : stretches_) {
    result->segment<3>(3 * static_cast<Eigen::Index>(stretch.first)) = end_at(stretch.id);
    const std::size_t num_inner = stretch.inner.num_blocks();
    if (num_inner == 0) continue;
    BlockOf(inner_rows(stretch), 0) -= stretch.to_first * end_at(stretch.id);
    if (stretch.has_next) {
      BlockOf(inner_rows(stretch), num_inner - 1) -= stretch.to_next * end_at(stretch.id + 1);
    }
    stretch.inner.SolveInPlace(inner_rows(stretch));
  }
}

}  // namespace plumbline
