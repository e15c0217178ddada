#include "plumbline/solvers/reduced/pose_preconditioner.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace plumbline {
namespace {

// More groups resolve shorter waves, but their dense factorisation grows with the cube.
constexpr std::size_t kMaxGroups = 150;
constexpr std::size_t kMinGroupSize = 8;

// The rows of K_p of one group of poses, moving rigidly.
struct GroupCoupling {
  std::size_t group;
  Eigen::Matrix<double, 3, 2> rows;
};

}  // namespace

PosePreconditioner::PosePreconditioner(const PoseSystem& system,
                                       const LineObservations& observations,
                                       const std::vector<PoseFrame>& frames, ThreadPool* pool) {
  frames_.reserve(system.pose_of_row.size());
  for (const int pose : system.pose_of_row) frames_.push_back(frames[pose]);
  if (frames_.empty()) return;
  FactorChain(system);
  FactorGroups(system, observations, pool);
}

void PosePreconditioner::FactorChain(const PoseSystem& system) {
  const std::size_t n = system.diagonal.size();
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

Eigen::Matrix3d PosePreconditioner::RigidMotion(std::size_t row) const {
  const Eigen::Vector2d& center = group_center_[GroupOf(row)];
  Eigen::Matrix3d motion = Eigen::Matrix3d::Identity();
  motion(0, 2) = -(frames_[row].y - center.y());
  motion(1, 2) = frames_[row].x - center.x();
  return motion;
}

void PosePreconditioner::FactorGroups(const PoseSystem& system,
                                      const LineObservations& observations, ThreadPool* pool) {
  const std::size_t n = system.diagonal.size();
  group_size_ = std::max(kMinGroupSize, (n + kMaxGroups - 1) / kMaxGroups);
  const std::size_t num_groups = (n + group_size_ - 1) / group_size_;
  group_center_.assign(num_groups, Eigen::Vector2d::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t size = std::min(group_size_, n - GroupOf(i) * group_size_);
    group_center_[GroupOf(i)] += frames_[i].translation() / static_cast<double>(size);
  }
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(num_groups);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  const auto block = [&](Eigen::MatrixXd* m, std::size_t row, std::size_t column) {
    return m->block<3, 3>(3 * static_cast<Eigen::Index>(row),
                          3 * static_cast<Eigen::Index>(column));
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Matrix3d motion = RigidMotion(i);
    block(&matrix, GroupOf(i), GroupOf(i)) += motion.transpose() * system.diagonal[i] * motion;
  }
  for (const PoseCoupling& coupling : system.couplings) {
    const Eigen::Matrix3d projected =
        RigidMotion(coupling.to).transpose() * coupling.block * RigidMotion(coupling.from);
    block(&matrix, GroupOf(coupling.to), GroupOf(coupling.from)) += projected;
    if (GroupOf(coupling.to) == GroupOf(coupling.from)) {
      block(&matrix, GroupOf(coupling.to), GroupOf(coupling.to)) += projected.transpose();
    }
  }
  // Few chunks, as each brings a matrix of its own.
  constexpr std::size_t kNumChunks = 8;
  const std::size_t num_landmarks = observations.num_landmarks();
  const std::size_t landmarks_per_chunk = num_landmarks / kNumChunks + 1;
  std::vector<Eigen::MatrixXd> parts(ThreadPool::NumChunks(num_landmarks, landmarks_per_chunk));
  pool->ForEachChunk(
      num_landmarks, landmarks_per_chunk,
      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        parts[chunk] = Eigen::MatrixXd::Zero(size, size);
        std::vector<GroupCoupling> groups;
        for (std::size_t p = begin; p < end; ++p) {
          groups.clear();
          for (std::size_t i = observations.first_of_landmark[p];
               i < observations.first_of_landmark[p + 1]; ++i) {
            if (system.line_coupling[i].row == PoseSystem::kConstant) continue;
            const std::size_t row = static_cast<std::size_t>(system.line_coupling[i].row);
            if (groups.empty() || groups.back().group != GroupOf(row)) {
              groups.push_back({GroupOf(row), Eigen::Matrix<double, 3, 2>::Zero()});
            }
            groups.back().rows +=
                RigidMotion(row).transpose() * system.line_coupling[i].Rows(system.line_normal[p]);
          }
          for (std::size_t a = 0; a < groups.size(); ++a) {
            for (std::size_t b = 0; b <= a; ++b) {
              block(&parts[chunk], groups[a].group, groups[b].group) -=
                  groups[a].rows * groups[b].rows.transpose();
            }
          }
        }
      });
  for (const Eigen::MatrixXd& part : parts) matrix += part;
  // Rounding must not make a free mode (a component's gauge) indefinite.
  matrix.diagonal() *= 1.0 + 1e-9;
  groups_.compute(matrix);
  has_groups_ = groups_.info() == Eigen::Success;
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
    coarse.segment<3>(at(GroupOf(i))) += RigidMotion(i).transpose() * v.segment<3>(at(i));
  }
  if (has_groups_) {
    groups_.solveInPlace(coarse);
  } else {
    coarse.setZero();
  }
  Eigen::Vector3d above = Eigen::Vector3d::Zero();
  for (std::size_t i = n; i-- > 0;) {
    Eigen::Vector3d x = chain_inverse_[i] * result->segment<3>(at(i));
    if (i + 1 < n) x -= chain_lower_[i + 1].transpose() * above;
    above = x;
    result->segment<3>(at(i)) = x + RigidMotion(i) * coarse.segment<3>(at(GroupOf(i)));
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
  double product_of_residual = residual.dot(preconditioned);
  const double target = relative_tolerance * relative_tolerance * product_of_residual;
  PoseSystemResult result;
  while (result.iterations < max_iterations && product_of_residual > target) {
    system.Apply(observations, direction, pool, &product);
    const double curvature = direction.dot(product);
    if (!(curvature > 0.0)) break;
    const double step = product_of_residual / curvature;
    *x += step * direction;
    residual -= step * product;
    ++result.iterations;
    preconditioner.Apply(residual, &preconditioned);
    const double next = residual.dot(preconditioned);
    direction = preconditioned + (next / product_of_residual) * direction;
    product_of_residual = next;
  }
  result.converged = product_of_residual <= target && x->allFinite();
  return result;
}

}  // namespace plumbline
