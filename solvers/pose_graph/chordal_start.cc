#include "plumbline/solvers/pose_graph/chordal_start.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

// A linear residual between two unknown vectors: to - gain * from - offset.
struct LinearEdge {
  int from = 0;
  int to = 0;
  Eigen::Matrix2d gain = Eigen::Matrix2d::Identity();
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity();
};

Eigen::Matrix2d Rotation(double yaw) {
  Eigen::Matrix2d rotation;
  rotation << std::cos(yaw), -std::sin(yaw), std::sin(yaw), std::cos(yaw);
  return rotation;
}

// Number of each unknown in the normal equations; -1 for the fixed poses.
std::vector<int> NumberUnknowns(std::size_t num_poses, const std::vector<int>& fixed) {
  std::vector<int> numbers(num_poses, 0);
  for (const int pose : fixed) numbers[pose] = -1;
  int next = 0;
  for (int& number : numbers) {
    if (number == 0) number = next++;
  }
  return numbers;
}

// Weighted sum of squares of linear residuals, as the equations of its minimum.
class NormalEquations {
 public:
  // values: one per pose; those of poses without a number are given.
  NormalEquations(const std::vector<int>& numbers, std::vector<Eigen::Vector2d>* values)
      : numbers_(numbers), values_(*values) {
    for (const int number : numbers) num_unknowns_ += number >= 0;
    right_ = Eigen::VectorXd::Zero(2 * num_unknowns_);
  }

  void Add(const LinearEdge& edge) {
    const int from = numbers_[edge.from], to = numbers_[edge.to];
    const Eigen::Matrix2d& w = edge.information;
    // The residual is to - gain * from less what is known.
    Eigen::Vector2d known = edge.offset;
    if (from < 0) known += edge.gain * values_[edge.from];
    if (to < 0) known -= values_[edge.to];
    if (from >= 0) {
      AddBlock(from, from, edge.gain.transpose() * w * edge.gain);
      right_.segment<2>(2 * from) -= edge.gain.transpose() * w * known;
    }
    if (to >= 0) {
      AddBlock(to, to, w);
      right_.segment<2>(2 * to) += w * known;
    }
    if (from >= 0 && to >= 0) {
      AddBlock(to, from, -w * edge.gain);
      AddBlock(from, to, -edge.gain.transpose() * w);
    }
  }

  // False, with the values untouched, if the residuals do not determine all unknowns.
  bool Solve() {
    if (num_unknowns_ == 0) return true;
    SparseMatrix matrix(2 * num_unknowns_, 2 * num_unknowns_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLLT<SparseMatrix> cholesky(matrix);
    if (cholesky.info() != Eigen::Success) return false;
    const Eigen::VectorXd solution = cholesky.solve(right_);
    if (!solution.allFinite()) return false;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      if (numbers_[i] >= 0) values_[i] = solution.segment<2>(2 * numbers_[i]);
    }
    return true;
  }

 private:
  void AddBlock(int row, int column, const Eigen::Matrix2d& block) {
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) entries_.emplace_back(2 * row + i, 2 * column + j, block(i, j));
    }
  }

  const std::vector<int>& numbers_;
  std::vector<Eigen::Vector2d>& values_;
  int num_unknowns_ = 0;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

}  // namespace

bool ChordalStart(const std::vector<RelativePoseConstraint>& edges, const std::vector<int>& fixed,
                  std::vector<Pose2>* world_from_pose) {
  const std::vector<int> numbers = NumberUnknowns(world_from_pose->size(), fixed);
  std::vector<Eigen::Vector2d> headings, positions;
  for (const Pose2& pose : *world_from_pose) {
    headings.emplace_back(std::cos(pose.yaw), std::sin(pose.yaw));
    positions.push_back(pose.translation());
  }
  NormalEquations of_headings(numbers, &headings), of_positions(numbers, &positions);
  for (const RelativePoseConstraint& edge : edges) {
    of_headings.Add({edge.from, edge.to, Rotation(edge.from_from_to.yaw), Eigen::Vector2d::Zero(),
                     Eigen::Matrix2d::Identity() / edge.covariance(2, 2)});
  }
  if (!of_headings.Solve()) return false;
  const auto yaw_of = [&](int pose) { return std::atan2(headings[pose].y(), headings[pose].x()); };
  for (const RelativePoseConstraint& edge : edges) {
    const Eigen::Matrix2d world_from_from = Rotation(yaw_of(edge.from));
    const Eigen::Matrix2d information = edge.covariance.topLeftCorner<2, 2>().inverse();
    of_positions.Add({edge.from, edge.to, Eigen::Matrix2d::Identity(),
                      world_from_from * edge.from_from_to.translation(),
                      world_from_from * information * world_from_from.transpose()});
  }
  if (!of_positions.Solve()) return false;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] < 0) continue;
    (*world_from_pose)[i] = {positions[i].x(), positions[i].y(), yaw_of(static_cast<int>(i))};
  }
  return true;
}

}  // namespace plumbline
