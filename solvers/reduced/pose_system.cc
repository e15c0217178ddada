#include "plumbline/solvers/reduced/pose_system.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/pose_frame.h"

namespace plumbline {
namespace {

constexpr std::size_t kPatchesPerChunk = 256;
constexpr std::size_t kPosesPerChunk = 128;

// Patches share poses: each part of them has sums of its own over the poses, which are added up in
// the end. So whatever belongs to a sighting is read once, in the order in which it lies.
constexpr std::size_t kNumParts = 16;

// Relative to the diagonal: enough to keep what no term sees where it is, and far softer than the
// bending modes of a long corridor.
constexpr double kDamping = 1e-8;

// One sighting's residuals about a line, by the unknowns they depend on. The cost is
//   1/2 [ weight distance^2 + n_r^T scatter n_r ],  n_r the normal in the frame of the robot.
struct Linearized {
  double weight;
  double distance;
  Eigen::Vector3d by_pose;  // of the distance
  Eigen::Vector2d by_line;  // of the distance: by the normal's angle and the offset
  double turn_curvature;    // of the scatter's part, by the angle between surface and robot
  double turn_gradient;

  Linearized(const PatchSighting& sighting, const SurfacePatch& patch, const PoseFrame& frame) {
    const Eigen::Vector2d& normal = patch.normal;
    const Eigen::Vector2d from_robot = frame.Rotate(sighting.centroid);
    const Eigen::Vector2d point = from_robot + frame.translation() - patch.origin;
    weight = sighting.weight;
    distance = normal.dot(point) - patch.offset_m;
    by_pose << normal, normal.dot(TurnedLeft(from_robot));
    by_line << TurnedLeft(normal).dot(point), -1.0;
    const Eigen::Vector2d normal_in_robot = frame.RotateBack(normal);
    const Eigen::Vector2d tangent = TurnedLeft(normal_in_robot);
    turn_curvature = tangent.dot(sighting.ScatterTimes(tangent));
    turn_gradient = tangent.dot(sighting.ScatterTimes(normal_in_robot));
  }

  Eigen::Matrix3d PoseBlock() const {
    Eigen::Matrix3d block = weight * by_pose * by_pose.transpose();
    block(2, 2) += turn_curvature;
    return block;
  }
  Eigen::Matrix2d LineBlock() const {
    Eigen::Matrix2d block = weight * by_line * by_line.transpose();
    block(0, 0) += turn_curvature;
    return block;
  }
  Eigen::Matrix<double, 3, 2> CrossBlock() const {
    Eigen::Matrix<double, 3, 2> block = weight * by_pose * by_line.transpose();
    block(2, 0) -= turn_curvature;
    return block;
  }
  Eigen::Vector3d PoseGradient() const {
    Eigen::Vector3d gradient = weight * distance * by_pose;
    gradient.z() -= turn_gradient;
    return gradient;
  }
};

// The parts have about as many sightings each.
std::size_t FirstPatchOfPart(const PatchSightings& sightings, std::size_t part) {
  const std::size_t first_sighting = sightings.sightings.size() * part / kNumParts;
  const auto patch = std::lower_bound(sightings.first_of_patch.begin(),
                                      sightings.first_of_patch.end() - 1, first_sighting);
  return static_cast<std::size_t>(patch - sightings.first_of_patch.begin());
}

// Moments of the sightings of patch `p` in the world, about the patch's origin, and what its shape
// terms add to them.
PointMoments WorldMoments(const PatchSightings& sightings, std::size_t p, const SurfacePatch& patch,
                          const std::vector<PoseFrame>& frames) {
  PointMoments moments;
  for (std::size_t i = sightings.first_of_patch[p]; i < sightings.first_of_patch[p + 1]; ++i) {
    const PatchSighting& s = sightings.sightings[i];
    const PoseFrame& f = frames[s.pose];
    const Eigen::Vector2d point = f.Rotate(s.centroid) + f.translation() - patch.origin;
    moments.Add(point.x(), point.y(), s.weight);
    const double cc = f.c * f.c, ss = f.s * f.s, cs = f.c * f.s;
    moments.xx += cc * s.xx - 2.0 * cs * s.xy + ss * s.yy;
    moments.xy += cs * (s.xx - s.yy) + (cc - ss) * s.xy;
    moments.yy += ss * s.xx + 2.0 * cs * s.xy + cc * s.yy;
  }
  // The shape terms are quadratic in the normal, as the scatter is.
  moments.xx += patch.shape_xx;
  moments.xy += patch.shape_xy;
  moments.yy += patch.shape_yy;
  return moments;
}

}  // namespace

double FitPatchLines(const PatchSightings& sightings, const std::vector<PoseFrame>& frames,
                     ThreadPool* pool, std::vector<SurfacePatch>* patches) {
  std::vector<double> costs(ThreadPool::NumChunks(patches->size(), kPatchesPerChunk), 0.0);
  pool->ForEachChunk(patches->size(), kPatchesPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t p = begin; p < end; ++p) {
                         SurfacePatch& patch = (*patches)[p];
                         const PointMoments moments = WorldMoments(sightings, p, patch, frames);
                         if (moments.weight <= 0.0) continue;
                         const LineFit fit = FitLine(moments);
                         patch.normal = fit.normal;
                         patch.offset_m = fit.normal.dot(fit.centroid);
                         costs[chunk] += 0.5 * moments.weight * fit.smaller_eigenvalue;
                       }
                     });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

double PatchLineCost(const PatchSightings& sightings, const std::vector<PoseFrame>& frames,
                     const std::vector<SurfacePatch>& patches, ThreadPool* pool) {
  std::vector<double> costs(ThreadPool::NumChunks(patches.size(), kPatchesPerChunk), 0.0);
  pool->ForEachChunk(
      patches.size(), kPatchesPerChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
          const Eigen::Vector2d& n = patches[p].normal;
          const double c = patches[p].offset_m;
          const PointMoments m = WorldMoments(sightings, p, patches[p], frames);
          costs[chunk] +=
              0.5 * (n.x() * n.x() * m.xx + 2.0 * n.x() * n.y() * m.xy + n.y() * n.y() * m.yy -
                     2.0 * c * (n.x() * m.x + n.y() * m.y) + c * c * m.weight);
        }
      });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

void PoseSystem::Linearize(const PatchSightings& sightings,
                           const std::vector<SurfacePatch>& patches, const PoseTerms& terms,
                           const std::vector<double>& poses, const std::vector<PoseFrame>& frames,
                           ThreadPool* pool) {
  NumberRows(terms.is_constant);
  diagonal.assign(pose_of_row.size(), Eigen::Matrix3d::Zero());
  gradient = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(pose_of_row.size()));
  couplings.clear();
  AddSightings(sightings, patches, frames, pool);
  by_sightings = diagonal;
  AddPoseTerms(terms, poses);
  damping.resize(gradient.size());
  for (std::size_t row = 0; row < diagonal.size(); ++row) {
    for (int i = 0; i < 3; ++i) {
      double& entry = diagonal[row](i, i);
      // Or a pose that nothing sees.
      const double added = entry > 0.0 ? kDamping * entry : 1.0 - entry;
      damping[3 * static_cast<Eigen::Index>(row) + i] = added;
      entry += added;
    }
  }
}

void PoseSystem::NumberRows(const std::vector<char>& is_constant) {
  pose_of_row.clear();
  row_of_pose.assign(is_constant.size(), kConstant);
  for (std::size_t pose = 0; pose < is_constant.size(); ++pose) {
    if (is_constant[pose]) continue;
    row_of_pose[pose] = static_cast<int>(pose_of_row.size());
    pose_of_row.push_back(static_cast<int>(pose));
  }
}

std::vector<double> PoseSystem::Moved(const std::vector<double>& poses,
                                      const Eigen::VectorXd& step) const {
  std::vector<double> moved = poses;
  for (std::size_t row = 0; row < pose_of_row.size(); ++row) {
    for (int i = 0; i < 3; ++i) {
      moved[3 * pose_of_row[row] + i] += step[3 * static_cast<Eigen::Index>(row) + i];
    }
  }
  return moved;
}

Eigen::MatrixXd PoseSystem::ByPose(const Eigen::MatrixXd& by_row) const {
  Eigen::MatrixXd by_pose =
      Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(row_of_pose.size()), by_row.cols());
  for (std::size_t row = 0; row < pose_of_row.size(); ++row) {
    by_pose.middleRows<3>(3 * pose_of_row[row]) =
        by_row.middleRows<3>(3 * static_cast<Eigen::Index>(row));
  }
  return by_pose;
}

void PoseSystem::AddSightings(const PatchSightings& sightings,
                              const std::vector<SurfacePatch>& patches,
                              const std::vector<PoseFrame>& frames, ThreadPool* pool) {
  struct PoseSum {
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  };
  line_coupling.resize(sightings.sightings.size());
  line_whitening.assign(patches.size(), Eigen::Matrix2d::Zero());
  std::vector<std::vector<PoseSum>> sums(kNumParts);
  pool->ForEachChunk(kNumParts, 1, [&](std::size_t part, std::size_t, std::size_t) {
    sums[part].resize(pose_of_row.size());
    const std::size_t end = FirstPatchOfPart(sightings, part + 1);
    for (std::size_t p = FirstPatchOfPart(sightings, part); p < end; ++p) {
      const std::size_t first = sightings.first_of_patch[p];
      const std::size_t last = sightings.first_of_patch[p + 1];
      const Eigen::Vector2d tangent = TurnedLeft(patches[p].normal);
      Eigen::Matrix2d line_block = Eigen::Matrix2d::Zero();
      line_block(0, 0) = tangent.dot(patches[p].ShapeTimes(tangent));
      for (std::size_t i = first; i < last; ++i) {
        const PatchSighting& sighting = sightings.sightings[i];
        const Linearized linear(sighting, patches[p], frames[sighting.pose]);
        line_block += linear.LineBlock();
        const int row = row_of_pose[sighting.pose];
        line_coupling[i].row = row;
        if (row == kConstant) continue;
        line_coupling[i].rows = linear.CrossBlock();
        PoseSum& sum = sums[part][row];
        sum.block += linear.PoseBlock();
        sum.gradient += linear.PoseGradient();
      }
      // K_p = (cross block) L^-T with line_block = L L^T.
      const Eigen::LLT<Eigen::Matrix2d> llt(line_block);
      if (llt.info() == Eigen::Success) {
        line_whitening[p] = Eigen::Matrix2d(llt.matrixU())
                                .triangularView<Eigen::Upper>()
                                .solve(Eigen::Matrix2d::Identity());
      }
      for (std::size_t i = first; i < last; ++i) {
        if (line_coupling[i].row != kConstant) line_coupling[i].rows *= line_whitening[p];
      }
    }
  });
  pool->ForEachChunk(
      diagonal.size(), kPosesPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
          for (const std::vector<PoseSum>& part : sums) {
            diagonal[row] += part[row].block;
            gradient.segment<3>(3 * static_cast<Eigen::Index>(row)) += part[row].gradient;
          }
        }
      });
}

void PoseSystem::AddPoseTerms(const PoseTerms& terms, const std::vector<double>& poses) {
  using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Eigen::Vector3d residual;
  RowMajor3d d_a, d_b;
  for (const std::vector<PoseEdge>* edges : {&terms.motions, &terms.relative_poses}) {
    for (const PoseEdge& edge : *edges) {
      edge.residual.Evaluate(&poses[3 * edge.from], &poses[3 * edge.to], residual.data(),
                             d_a.data(), d_b.data());
      const int from = row_of_pose[edge.from], to = row_of_pose[edge.to];
      if (from != kConstant) {
        diagonal[from] += d_a.transpose() * d_a;
        gradient.segment<3>(3 * from) += d_a.transpose() * residual;
      }
      if (to != kConstant) {
        diagonal[to] += d_b.transpose() * d_b;
        gradient.segment<3>(3 * to) += d_b.transpose() * residual;
      }
      if (from == kConstant || to == kConstant) continue;
      if (from < to) {
        couplings.push_back({from, to, d_b.transpose() * d_a});
      } else {
        couplings.push_back({to, from, d_a.transpose() * d_b});
      }
    }
  }
  std::stable_sort(couplings.begin(), couplings.end(),
                   [](const PoseCoupling& a, const PoseCoupling& b) {
                     return std::tie(a.from, a.to) < std::tie(b.from, b.to);
                   });
}

void PoseSystem::HoldLines() {
  for (LineCoupling& coupling : line_coupling) coupling.rows.setZero();
}

void PoseSystem::Apply(const PatchSightings& sightings, const Eigen::VectorXd& v, ThreadPool* pool,
                       Eigen::VectorXd* result) const {
  // The couplings of a patch are at hand still when its K_p is applied to K_p^T v.
  part_sums_.resize(kNumParts);
  pool->ForEachChunk(kNumParts, 1, [&](std::size_t part, std::size_t, std::size_t) {
    Eigen::VectorXd& sums = part_sums_[part];
    sums.setZero(v.size());
    const std::size_t end = FirstPatchOfPart(sightings, part + 1);
    for (std::size_t p = FirstPatchOfPart(sightings, part); p < end; ++p) {
      const std::size_t first = sightings.first_of_patch[p];
      const std::size_t last = sightings.first_of_patch[p + 1];
      Eigen::Vector2d line = Eigen::Vector2d::Zero();
      for (std::size_t i = first; i < last; ++i) {
        const LineCoupling& coupling = line_coupling[i];
        if (coupling.row == kConstant) continue;
        line += coupling.rows.transpose() * v.segment<3>(3 * coupling.row);
      }
      for (std::size_t i = first; i < last; ++i) {
        const LineCoupling& coupling = line_coupling[i];
        if (coupling.row == kConstant) continue;
        sums.segment<3>(3 * coupling.row) += coupling.rows * line;
      }
    }
  });
  result->resize(v.size());
  pool->ForEachChunk(diagonal.size(), kPosesPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t row = begin; row < end; ++row) {
                         const Eigen::Index at = 3 * static_cast<Eigen::Index>(row);
                         Eigen::Vector3d sum = diagonal[row] * v.segment<3>(at);
                         for (const Eigen::VectorXd& part : part_sums_) sum -= part.segment<3>(at);
                         result->segment<3>(at) = sum;
                       }
                     });
  for (const PoseCoupling& coupling : couplings) {
    const auto from = 3 * static_cast<Eigen::Index>(coupling.from);
    const auto to = 3 * static_cast<Eigen::Index>(coupling.to);
    result->segment<3>(to) += coupling.block * v.segment<3>(from);
    result->segment<3>(from) += coupling.block.transpose() * v.segment<3>(to);
  }
}

}  // namespace plumbline
