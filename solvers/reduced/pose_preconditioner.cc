#include "plumbline/solvers/reduced/pose_preconditioner.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

// More groups resolve shorter waves, but their dense factorisation grows with the cube.
constexpr std::size_t kMaxGroups = 150;
constexpr std::size_t kMinGroupSize = 8;

using Block = Eigen::Block<Eigen::MatrixXd, 3, 3>;

Block BlockAt(Eigen::MatrixXd* matrix, int row, int column) {
  return matrix->block<3, 3>(3 * static_cast<Eigen::Index>(row),
                             3 * static_cast<Eigen::Index>(column));
}

// What a landmark takes from the matrix of the groups that see it, ascending.
void SubtractLandmark(const std::vector<GroupCoupling>& groups, Eigen::MatrixXd* matrix) {
  for (std::size_t a = 0; a < groups.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      BlockAt(matrix, groups[a].group, groups[b].group) -=
          groups[a].rows * groups[b].rows.transpose();
    }
  }
}

double Dot(const PoseSystem& system, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return SumOverPeers(system.peers, a.dot(b));
}

}  // namespace

PosePreconditioner::PosePreconditioner(const PoseSystem& system,
                                       const LineObservations& observations,
                                       const std::vector<PoseFrame>& frames, ThreadPool* pool)
    : peers_(system.peers), rank_(peers_ != nullptr ? peers_->rank() : 0) {
  frames_.reserve(system.pose_of_row.size());
  for (const int pose : system.pose_of_row) frames_.push_back(frames[pose]);
  FactorChain(system);
  FormGroups(system, frames);
  FactorGroups(system, observations, frames, pool);
}

void PosePreconditioner::FactorChain(const PoseSystem& system) {
  const std::size_t n = system.diagonal.size();
  if (n == 0) return;
  std::vector<Eigen::Matrix3d> lower(n, Eigen::Matrix3d::Zero());
  for (const PoseCoupling& coupling : system.couplings) {
    if (coupling.to == coupling.from + 1) lower[coupling.to] += coupling.block;
  }
  chain_inverse_.resize(n);
  chain_lower_.resize(n);
  Eigen::Matrix3d pivot = system.diagonal[0];
  for (std::size_t i = 0;; ++i) {
    chain_inverse_[i] = pivot.inverse();
    if (i + 1 == n) break;
    chain_lower_[i + 1] = lower[i + 1] * chain_inverse_[i];
    pivot = system.diagonal[i + 1] - chain_lower_[i + 1] * lower[i + 1].transpose();
  }
}

Eigen::Matrix3d PosePreconditioner::RigidMotion(const PoseFrame& frame, int group) const {
  const Eigen::Vector2d& center = group_center_[group];
  Eigen::Matrix3d motion = Eigen::Matrix3d::Identity();
  motion(0, 2) = -(frame.y - center.y());
  motion(1, 2) = frame.x - center.x();
  return motion;
}

void PosePreconditioner::FormGroups(const PoseSystem& system,
                                    const std::vector<PoseFrame>& frames) {
  const std::size_t num_ranks = peers_ != nullptr ? peers_->size() : 1;
  std::vector<double> num_rows(num_ranks, 0.0);
  num_rows[rank_] = static_cast<double>(frames_.size());
  SumOverPeers(peers_, &num_rows);
  std::size_t num_all_rows = 0;
  for (const double rows : num_rows) num_all_rows += static_cast<std::size_t>(rows);
  groups_.size = std::max(kMinGroupSize, (num_all_rows + kMaxGroups - 1) / kMaxGroups);
  groups_.first_of_rank = {0};
  for (const double rows : num_rows) {
    const std::size_t num_groups =
        (static_cast<std::size_t>(rows) + groups_.size - 1) / groups_.size;
    groups_.first_of_rank.push_back(groups_.first_of_rank.back() + static_cast<int>(num_groups));
  }
  const auto group_of_pose = [&](std::size_t pose) {
    if (peers_ == nullptr) {
      const int row = system.row_of_pose[pose];
      return row == PoseSystem::kConstant ? row : GroupOf(row);
    }
    const int row = system.row_at_rank[pose];
    return row == PoseSystem::kConstant ? row : GroupAt(system.rank_of_pose[pose], row);
  };
  std::vector<double> sizes(groups_.first_of_rank.back(), 0.0);
  for (std::size_t pose = 0; pose < frames.size(); ++pose) {
    const int group = group_of_pose(pose);
    if (group != PoseSystem::kConstant) ++sizes[group];
  }
  group_center_.assign(sizes.size(), Eigen::Vector2d::Zero());
  for (std::size_t pose = 0; pose < frames.size(); ++pose) {
    const int group = group_of_pose(pose);
    if (group == PoseSystem::kConstant) continue;
    group_center_[group] += frames[pose].translation() / sizes[group];
  }
}

void PosePreconditioner::AddPoseBlocks(const PoseSystem& system,
                                       const std::vector<PoseFrame>& frames,
                                       Eigen::MatrixXd* matrix) const {
  for (std::size_t i = 0; i < system.diagonal.size(); ++i) {
    const Eigen::Matrix3d motion = RigidMotion(i);
    BlockAt(matrix, GroupOf(i), GroupOf(i)) += motion.transpose() * system.diagonal[i] * motion;
  }
  for (const PoseCoupling& coupling : system.couplings) {
    const int to = GroupOf(coupling.to), from = GroupOf(coupling.from);
    const Eigen::Matrix3d projected =
        RigidMotion(coupling.to).transpose() * coupling.block * RigidMotion(coupling.from);
    BlockAt(matrix, to, from) += projected;
    if (to == from) BlockAt(matrix, to, to) += projected.transpose();
  }
  // Both processes have these. The lower triangle is that of the one with the later groups.
  for (const ForeignCoupling& coupling : system.foreign_couplings) {
    if (coupling.rank > rank_) continue;
    const int other = GroupAt(coupling.rank, system.row_at_rank[coupling.pose]);
    BlockAt(matrix, GroupOf(coupling.row), other) += RigidMotion(coupling.row).transpose() *
                                                     coupling.block *
                                                     RigidMotion(frames[coupling.pose], other);
  }
}

void PosePreconditioner::CoupleGroups(const PoseSystem& system,
                                      const LineObservations& observations, std::size_t p,
                                      std::vector<GroupCoupling>* groups) const {
  groups->clear();
  for (std::size_t i = observations.first_of_landmark[p]; i < observations.first_of_landmark[p + 1];
       ++i) {
    if (system.line_coupling[i].row == PoseSystem::kConstant) continue;
    const std::size_t row = static_cast<std::size_t>(system.line_coupling[i].row);
    if (groups->empty() || groups->back().group != GroupOf(row)) groups->push_back({GroupOf(row)});
    groups->back().rows +=
        RigidMotion(row).transpose() * system.line_coupling[i].Rows(system.line_normal[p]);
  }
}

void PosePreconditioner::AddLandmarks(const PoseSystem& system,
                                      const LineObservations& observations, ThreadPool* pool,
                                      Eigen::MatrixXd* matrix) const {
  // Few chunks, as each brings a matrix of its own.
  constexpr std::size_t kNumChunks = 8;
  const std::size_t num_landmarks = observations.num_landmarks();
  const std::size_t landmarks_per_chunk = num_landmarks / kNumChunks + 1;
  std::vector<Eigen::MatrixXd> parts(ThreadPool::NumChunks(num_landmarks, landmarks_per_chunk));
  pool->ForEachChunk(num_landmarks, landmarks_per_chunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       parts[chunk] = Eigen::MatrixXd::Zero(matrix->rows(), matrix->cols());
                       std::vector<GroupCoupling> groups;
                       for (std::size_t p = begin; p < end; ++p) {
                         if (observations.shared.SlotOf(p) != SharedLandmarks::kNotShared) continue;
                         CoupleGroups(system, observations, p, &groups);
                         SubtractLandmark(groups, &parts[chunk]);
                       }
                     });
  for (const Eigen::MatrixXd& part : parts) *matrix += part;
}

// The process in charge of a landmark gets the groups of all others that see it.
void PosePreconditioner::AddSharedLandmarks(const PoseSystem& system,
                                            const LineObservations& observations,
                                            Eigen::MatrixXd* matrix) const {
  const SharedLandmarks& shared = observations.shared;
  // Numbers the landmark among those that both processes share.
  struct Message {
    int index;
    int group;
    double rows[6];
  };
  std::vector<std::vector<Message>> to_rank(peers_->size());
  std::vector<std::vector<GroupCoupling>> of_slot(shared.landmarks().size());
  for (std::size_t slot = 0; slot < of_slot.size(); ++slot) {
    CoupleGroups(system, observations, shared.landmarks()[slot], &of_slot[slot]);
  }
  for (int rank = 0; rank < rank_; ++rank) {
    for (std::size_t i = 0; i < shared.SharedWith(rank).size(); ++i) {
      const int slot = shared.SlotOf(shared.SharedWith(rank)[i]);
      if (shared.RankInCharge(slot) != rank) continue;
      for (const GroupCoupling& coupling : of_slot[slot]) {
        Message& message = to_rank[rank].emplace_back();
        message.index = static_cast<int>(i);
        message.group = coupling.group;
        Eigen::Map<Eigen::Matrix<double, 3, 2>>(message.rows) = coupling.rows;
      }
    }
  }
  const std::vector<std::vector<Message>> from_rank = ExchangeValues(*peers_, to_rank);
  // Groups ascend with the ranks.
  for (int rank = rank_ + 1; rank < peers_->size(); ++rank) {
    for (const Message& message : from_rank[rank]) {
      const int slot = shared.SlotOf(shared.SharedWith(rank)[message.index]);
      of_slot[slot].push_back(
          {message.group, Eigen::Map<const Eigen::Matrix<double, 3, 2>>(message.rows)});
    }
  }
  for (std::size_t slot = 0; slot < of_slot.size(); ++slot) {
    if (shared.RankInCharge(static_cast<int>(slot)) == rank_) {
      SubtractLandmark(of_slot[slot], matrix);
    }
  }
}

void PosePreconditioner::FactorGroups(const PoseSystem& system,
                                      const LineObservations& observations,
                                      const std::vector<PoseFrame>& frames, ThreadPool* pool) {
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(group_center_.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  AddPoseBlocks(system, frames, &matrix);
  AddLandmarks(system, observations, pool, &matrix);
  if (peers_ != nullptr) {
    AddSharedLandmarks(system, observations, &matrix);
    peers_->Sum(matrix.data(), static_cast<std::size_t>(matrix.size()));
  }
  // Rounding must not make a free mode (a component's gauge) indefinite.
  matrix.diagonal() *= 1.0 + 1e-9;
  group_matrix_.compute(matrix);
  has_groups_ = group_matrix_.info() == Eigen::Success;
}

void PosePreconditioner::Apply(const Eigen::VectorXd& v, Eigen::VectorXd* result) const {
  const std::size_t n = chain_inverse_.size();
  result->resize(v.size());
  const auto at = [](std::size_t i) { return 3 * static_cast<Eigen::Index>(i); };
  Eigen::VectorXd coarse =
      Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(group_center_.size()));
  Eigen::Vector3d carried = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    carried = v.segment<3>(at(i)) - (i > 0 ? Eigen::Vector3d(chain_lower_[i] * carried) : carried);
    result->segment<3>(at(i)) = carried;
    coarse.segment<3>(3 * static_cast<Eigen::Index>(GroupOf(i))) +=
        RigidMotion(i).transpose() * v.segment<3>(at(i));
  }
  if (peers_ != nullptr) peers_->Sum(coarse.data(), static_cast<std::size_t>(coarse.size()));
  if (has_groups_) {
    group_matrix_.solveInPlace(coarse);
  } else {
    coarse.setZero();
  }
  Eigen::Vector3d above = Eigen::Vector3d::Zero();
  for (std::size_t i = n; i-- > 0;) {
    Eigen::Vector3d x = chain_inverse_[i] * result->segment<3>(at(i));
    if (i + 1 < n) x -= chain_lower_[i + 1].transpose() * above;
    above = x;
    result->segment<3>(at(i)) =
        x + RigidMotion(i) * coarse.segment<3>(3 * static_cast<Eigen::Index>(GroupOf(i)));
  }
}

PoseSystemResult SolvePoseSystem(const PoseSystem& system, const LineObservations& observations,
                                 const PosePreconditioner& preconditioner,
                                 const Eigen::VectorXd& right_hand_side, double relative_tolerance,
                                 int max_iterations, ThreadPool* pool, Eigen::VectorXd* x) {
  Eigen::VectorXd residual = right_hand_side, direction, preconditioned, product;
  x->setZero(residual.size());
  preconditioner.Apply(residual, &preconditioned);
  direction = preconditioned;
  double product_of_residual = Dot(system, residual, preconditioned);
  const double target = relative_tolerance * relative_tolerance * product_of_residual;
  PoseSystemResult result;
  while (result.iterations < max_iterations && product_of_residual > target) {
    system.Apply(observations, direction, pool, &product);
    const double curvature = Dot(system, direction, product);
    if (!(curvature > 0.0)) break;
    const double step = product_of_residual / curvature;
    *x += step * direction;
    residual -= step * product;
    ++result.iterations;
    preconditioner.Apply(residual, &preconditioned);
    const double next = Dot(system, residual, preconditioned);
    direction = preconditioned + (next / product_of_residual) * direction;
    product_of_residual = next;
  }
  const double num_broken = SumOverPeers(system.peers, x->allFinite() ? 0.0 : 1.0);
  result.converged = product_of_residual <= target && num_broken == 0.0;
  return result;
}

}  // namespace plumbline
