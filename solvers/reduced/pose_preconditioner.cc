#include "plumbline/solvers/reduced/pose_preconditioner.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

// More groups resolve shorter waves, but their dense factorisation grows with the cube.
constexpr int kMaxGroups = 150;
constexpr int kMinGroupSize = 8;

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

// Keeps the groups ascending.
void AddCoupling(const GroupCoupling& coupling, std::vector<GroupCoupling>* groups) {
  const auto at = std::lower_bound(
      groups->begin(), groups->end(), coupling,
      [](const GroupCoupling& a, const GroupCoupling& b) { return a.group < b.group; });
  if (at != groups->end() && at->group == coupling.group) {
    at->rows += coupling.rows;
  } else {
    groups->insert(at, coupling);
  }
}

double Dot(const PoseSystem& system, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return SumOverPeers(system.peers, a.dot(b));
}

}  // namespace

PosePreconditioner::PosePreconditioner(const PoseSystem& system,
                                       const LineObservations& observations,
                                       const std::vector<PoseFrame>& frames, ThreadPool* pool)
    : peers_(system.peers), chain_(system) {
  frames_.reserve(system.pose_of_row.size());
  for (const int pose : system.pose_of_row) frames_.push_back(frames[pose]);
  FormGroups(system, frames);
  FactorGroups(system, observations, frames, pool);
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
  const std::vector<int>& places = peers_ != nullptr ? system.place_of_pose : system.row_of_pose;
  const auto num_places = static_cast<int>(
      places.size() - std::count(places.begin(), places.end(), int{PoseSystem::kConstant}));
  group_size_ = std::max(kMinGroupSize, (num_places + kMaxGroups - 1) / kMaxGroups);
  const int num_groups = (num_places + group_size_ - 1) / group_size_;
  group_center_.assign(num_groups, Eigen::Vector2d::Zero());
  for (std::size_t pose = 0; pose < frames.size(); ++pose) {
    if (places[pose] == PoseSystem::kConstant) continue;
    const int group = GroupAt(places[pose]);
    const int size = std::min(group_size_, num_places - group * group_size_);
    group_center_[group] += frames[pose].translation() / static_cast<double>(size);
  }
  group_of_row_.reserve(frames_.size());
  for (std::size_t row = 0; row < frames_.size(); ++row) {
    group_of_row_.push_back(GroupAt(system.PlaceOf(static_cast<int>(row))));
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
  // Both processes have these: that of the later pose has the lower triangle.
  for (const ForeignCoupling& coupling : system.foreign_couplings) {
    const int place = system.place_of_pose[coupling.pose];
    if (place > system.PlaceOf(coupling.row)) continue;
    const int to = GroupOf(coupling.row), from = GroupAt(place);
    const Eigen::Matrix3d projected = RigidMotion(coupling.row).transpose() * coupling.block *
                                      RigidMotion(frames[coupling.pose], from);
    BlockAt(matrix, to, from) += projected;
    if (to == from) BlockAt(matrix, to, to) += projected.transpose();
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
    // RigidMotion(row)^T times the rows of the pose.
    const LineCoupling& coupling = system.line_coupling[i];
    const Eigen::Vector2d& normal = system.line_normal[p];
    const Eigen::Vector2d arm = frames_[row].translation() - group_center_[GroupOf(row)];
    Eigen::Matrix<double, 3, 2>& rows = groups->back().rows;
    rows.row(0) += normal.x() * coupling.along_normal;
    rows.row(1) += normal.y() * coupling.along_normal;
    rows.row(2) += coupling.turn + normal.dot(TurnedLeft(arm)) * coupling.along_normal;
  }
}

void PosePreconditioner::AddLandmarks(const PoseSystem& system,
                                      const LineObservations& observations, ThreadPool* pool,
                                      Eigen::MatrixXd* matrix) const {
  // Few chunks, as each brings a matrix of its own.
  constexpr std::size_t kNumChunks = 4;
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
  for (int rank = 0; rank < peers_->rank(); ++rank) {
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
  for (int rank = 0; rank < peers_->size(); ++rank) {
    for (const Message& message : from_rank[rank]) {
      const int slot = shared.SlotOf(shared.SharedWith(rank)[message.index]);
      AddCoupling({message.group, Eigen::Map<const Eigen::Matrix<double, 3, 2>>(message.rows)},
                  &of_slot[slot]);
    }
  }
  for (std::size_t slot = 0; slot < of_slot.size(); ++slot) {
    if (shared.RankInCharge(static_cast<int>(slot)) == peers_->rank()) {
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
  const auto at = [](std::size_t i) { return 3 * static_cast<Eigen::Index>(i); };
  Eigen::VectorXd coarse = Eigen::VectorXd::Zero(at(group_center_.size()));
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    coarse.segment<3>(at(GroupOf(i))) += RigidMotion(i).transpose() * v.segment<3>(at(i));
  }
  if (peers_ != nullptr) peers_->Sum(coarse.data(), static_cast<std::size_t>(coarse.size()));
  if (has_groups_) {
    group_matrix_.solveInPlace(coarse);
  } else {
    coarse.setZero();
  }
  chain_.Solve(v, result);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    result->segment<3>(at(i)) += RigidMotion(i) * coarse.segment<3>(at(GroupOf(i)));
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
