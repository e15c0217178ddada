#include "plumbline/solvers/reduced/pose_system.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "plumbline/core/pose_frame.h"

namespace plumbline {
namespace {

constexpr std::size_t kPosesPerChunk = 128;

// Landmarks share poses: each part of them has sums of its own over the poses, which are added up
// in the end. So whatever belongs to an observation is read once, in the order in which it lies.
constexpr std::size_t kNumParts = 16;

// Relative to the diagonal: enough to keep what no term sees where it is, and far softer than the
// bending modes of a long corridor.
constexpr double kDamping = 1e-8;

// One observation's residuals about a line, by the unknowns they depend on. The cost is
//   1/2 [ weight distance^2 + n_r^T scatter n_r ],  n_r the normal in the frame of the robot.
struct Linearized {
  double weight;
  double distance;
  Eigen::Vector3d by_pose;  // of the distance
  Eigen::Vector2d by_line;  // of the distance: by the normal's angle and the offset
  double turn_curvature;    // of the scatter's part, by the angle between surface and robot
  double turn_gradient;

  Linearized(const LineObservation& observation, const LineLandmark& landmark,
             const PoseFrame& frame) {
    const Eigen::Vector2d& normal = landmark.normal;
    const Eigen::Vector2d from_robot = frame.Rotate(observation.centroid());
    const Eigen::Vector2d point = from_robot + frame.translation() - landmark.origin;
    weight = observation.weight;
    distance = normal.dot(point) - landmark.offset_m;
    by_pose << normal, normal.dot(TurnedLeft(from_robot));
    by_line << TurnedLeft(normal).dot(point), -1.0;
    const Eigen::Vector2d normal_in_robot = frame.RotateBack(normal);
    const Eigen::Vector2d tangent = TurnedLeft(normal_in_robot);
    turn_curvature = tangent.dot(observation.ScatterTimes(tangent));
    turn_gradient = tangent.dot(observation.ScatterTimes(normal_in_robot));
  }

  Eigen::Matrix2d LineBlock() const {
    Eigen::Matrix2d block = weight * by_line * by_line.transpose();
    block(0, 0) += turn_curvature;
    return block;
  }
  LineCoupling Coupling(int row) const {
    const Eigen::Vector2d along_normal = weight * by_line;
    return {along_normal, by_pose.z() * along_normal - Eigen::Vector2d(turn_curvature, 0.0), row};
  }
};

// What observations say of one pose: the six entries of the lower triangle of its block, and the
// gradient.
struct PoseSum {
  double xx = 0.0, yx = 0.0, yy = 0.0, turn_x = 0.0, turn_y = 0.0, turn_turn = 0.0;
  double gradient_x = 0.0, gradient_y = 0.0, gradient_turn = 0.0;

  void Add(const Linearized& linear) {
    const double x = linear.by_pose.x(), y = linear.by_pose.y(), turn = linear.by_pose.z();
    const double wx = linear.weight * x, wy = linear.weight * y, wturn = linear.weight * turn;
    xx += wx * x;
    yx += wx * y;
    yy += wy * y;
    turn_x += wx * turn;
    turn_y += wy * turn;
    turn_turn += wturn * turn + linear.turn_curvature;
    gradient_x += wx * linear.distance;
    gradient_y += wy * linear.distance;
    gradient_turn += wturn * linear.distance - linear.turn_gradient;
  }
  Eigen::Matrix3d Block() const {
    return (Eigen::Matrix3d() << xx, yx, turn_x, yx, yy, turn_y, turn_x, turn_y, turn_turn)
        .finished();
  }
  Eigen::Vector3d Gradient() const { return {gradient_x, gradient_y, gradient_turn}; }
};

Eigen::Matrix2d Symmetric(const Eigen::Vector3d& upper) {
  return (Eigen::Matrix2d() << upper[0], upper[1], upper[1], upper[2]).finished();
}

// What all returns say of the lines of shared landmarks, per slot: the upper triangles.
std::vector<Eigen::Vector3d> SumSharedLineBlocks(const LineObservations& observations,
                                                 const std::vector<LineLandmark>& landmarks,
                                                 const std::vector<PoseFrame>& frames) {
  return observations.shared.Sum<3>([&](std::size_t p) -> Eigen::Vector3d {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (std::size_t i = observations.first_of_landmark[p];
         i < observations.first_of_landmark[p + 1]; ++i) {
      const LineObservation& observation = observations.observations[i];
      sum += Linearized(observation, landmarks[p], frames[observation.pose]).LineBlock();
    }
    return {sum(0, 0), sum(0, 1), sum(1, 1)};
  });
}

// The parts have about as many observations each. Landmarks that only other processes have observed
// belong to one of them, too.
std::size_t FirstLandmarkOfPart(const LineObservations& observations, std::size_t part) {
  if (part == kNumParts) return observations.num_landmarks();
  const std::size_t first_observation = observations.observations.size() * part / kNumParts;
  const auto landmark =
      std::lower_bound(observations.first_of_landmark.begin(),
                       observations.first_of_landmark.end() - 1, first_observation);
  return static_cast<std::size_t>(landmark - observations.first_of_landmark.begin());
}

// What terms say of poses, by rows of a system.
class RowEquations final : public PoseEquations {
 public:
  RowEquations(const PoseTerms& terms, PoseSystem* system) : terms_(terms), system_(*system) {}

  void Add(int pose, const Eigen::Matrix3d& block, const Eigen::Vector3d& gradient) override {
    const int row = system_.row_of_pose[pose];
    if (row == PoseSystem::kConstant) return;
    system_.diagonal[row] += block;
    system_.gradient.segment<3>(3 * row) += gradient;
  }
  // Rows have the order of their poses.
  void AddCoupling(int a, int b, const Eigen::Matrix3d& block) override {
    const int from = system_.row_of_pose[a], to = system_.row_of_pose[b];
    if (from == PoseSystem::kConstant && to == PoseSystem::kConstant) return;
    if (from == PoseSystem::kConstant) {
      AddForeign(a, to, block);
    } else if (to == PoseSystem::kConstant) {
      AddForeign(b, from, block.transpose());
    } else {
      system_.couplings.push_back({from, to, block});
    }
  }

 private:
  void AddForeign(int pose, int row, const Eigen::Matrix3d& block) {
    if (terms_.is_constant[pose]) return;
    system_.foreign_couplings.push_back({system_.rank_of_pose[pose], pose, row, block});
  }

  const PoseTerms& terms_;
  PoseSystem& system_;
};

}  // namespace

void PoseSystem::Linearize(const LineObservations& observations,
                           const std::vector<LineLandmark>& landmarks, const PoseTerms& terms,
                           const std::vector<double>& poses, const std::vector<PoseFrame>& frames,
                           ThreadPool* pool) {
  NumberRows(terms);
  diagonal.assign(pose_of_row.size(), Eigen::Matrix3d::Zero());
  gradient = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(pose_of_row.size()));
  couplings.clear();
  foreign_couplings.clear();
  AddObservations(observations, landmarks, frames, pool);
  by_observations = diagonal;
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

void PoseSystem::NumberRows(const PoseTerms& terms) {
  const std::size_t num_poses = terms.is_constant.size();
  pose_of_row.clear();
  row_of_pose.assign(num_poses, kConstant);
  peers = nullptr;
  if (terms.shared_graph != nullptr) {
    peers = terms.shared_graph->peers();
    rank_of_pose = terms.shared_graph->rank_of_pose();
    place_of_pose.assign(num_poses, kConstant);
  }
  int num_places = 0;
  for (std::size_t pose = 0; pose < num_poses; ++pose) {
    if (terms.is_constant[pose]) continue;
    if (peers != nullptr) {
      place_of_pose[pose] = num_places++;
      if (rank_of_pose[pose] != peers->rank()) continue;
    }
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
  if (peers == nullptr) return moved;
  const Eigen::VectorXd steps = ByPose(step);
  for (std::size_t pose = 0; pose < place_of_pose.size(); ++pose) {
    if (place_of_pose[pose] == kConstant || rank_of_pose[pose] == peers->rank()) continue;
    for (std::size_t i = 3 * pose; i < 3 * pose + 3; ++i) {
      moved[i] += steps[static_cast<Eigen::Index>(i)];
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
  // Each pose has a row in one process only, so that the sums are exact.
  if (peers != nullptr) peers->Sum(by_pose.data(), static_cast<std::size_t>(by_pose.size()));
  return by_pose;
}

void PoseSystem::AddObservations(const LineObservations& observations,
                                 const std::vector<LineLandmark>& landmarks,
                                 const std::vector<PoseFrame>& frames, ThreadPool* pool) {
  line_coupling.resize(observations.observations.size());
  line_normal.resize(landmarks.size());
  line_whitening.assign(landmarks.size(), Eigen::Matrix2d::Zero());
  const std::vector<Eigen::Vector3d> shared_line_blocks =
      SumSharedLineBlocks(observations, landmarks, frames);
  std::vector<std::vector<PoseSum>> sums(kNumParts);
  pool->ForEachChunk(kNumParts, 1, [&](std::size_t part, std::size_t, std::size_t) {
    sums[part].resize(pose_of_row.size());
    const std::size_t end = FirstLandmarkOfPart(observations, part + 1);
    for (std::size_t p = FirstLandmarkOfPart(observations, part); p < end; ++p) {
      const std::size_t first = observations.first_of_landmark[p];
      const std::size_t last = observations.first_of_landmark[p + 1];
      line_normal[p] = landmarks[p].normal;
      Eigen::Matrix2d line_block = Eigen::Matrix2d::Zero();
      for (std::size_t i = first; i < last; ++i) {
        const LineObservation& observation = observations.observations[i];
        const Linearized linear(observation, landmarks[p], frames[observation.pose]);
        line_block += linear.LineBlock();
        const int row = row_of_pose[observation.pose];
        line_coupling[i] = linear.Coupling(row);
        if (row == kConstant) continue;
        sums[part][row].Add(linear);
      }
      const int slot = observations.shared.SlotOf(p);
      if (slot != SharedLandmarks::kNotShared) line_block = Symmetric(shared_line_blocks[slot]);
      // K_p = (cross block) L^-T with line_block = L L^T.
      const Eigen::LLT<Eigen::Matrix2d> llt(line_block);
      if (llt.info() == Eigen::Success) {
        line_whitening[p] = Eigen::Matrix2d(llt.matrixU())
                                .triangularView<Eigen::Upper>()
                                .solve(Eigen::Matrix2d::Identity());
      }
      for (std::size_t i = first; i < last; ++i) {
        LineCoupling& coupling = line_coupling[i];
        coupling.along_normal = line_whitening[p].transpose() * coupling.along_normal;
        coupling.turn = line_whitening[p].transpose() * coupling.turn;
      }
    }
  });
  pool->ForEachChunk(
      diagonal.size(), kPosesPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
          for (const std::vector<PoseSum>& part : sums) {
            diagonal[row] += part[row].Block();
            gradient.segment<3>(3 * static_cast<Eigen::Index>(row)) += part[row].Gradient();
          }
        }
      });
}

void PoseSystem::AddPoseTerms(const PoseTerms& terms, const std::vector<double>& poses) {
  RowEquations equations(terms, this);
  for (const auto& term : terms.terms) term->AddEquations(poses.data(), &equations);
  std::stable_sort(couplings.begin(), couplings.end(),
                   [](const PoseCoupling& a, const PoseCoupling& b) {
                     return std::tie(a.from, a.to) < std::tie(b.from, b.to);
                   });
  // Of terms in the order of the energy, which is the same everywhere.
  std::stable_sort(
      foreign_couplings.begin(), foreign_couplings.end(),
      [](const ForeignCoupling& a, const ForeignCoupling& b) { return a.rank < b.rank; });
}

void PoseSystem::HoldLines() {
  for (LineCoupling& coupling : line_coupling) {
    coupling.along_normal.setZero();
    coupling.turn.setZero();
  }
}

Eigen::Vector2d PoseSystem::LineOf(const LineObservations& observations, std::size_t p,
                                   const Eigen::VectorXd& v) const {
  const Eigen::Vector2d normal = line_normal[p];
  Eigen::Vector2d line = Eigen::Vector2d::Zero();
  for (std::size_t i = observations.first_of_landmark[p]; i < observations.first_of_landmark[p + 1];
       ++i) {
    const LineCoupling& coupling = line_coupling[i];
    if (coupling.row == kConstant) continue;
    const double* of_row = v.data() + 3 * static_cast<Eigen::Index>(coupling.row);
    line += (normal.x() * of_row[0] + normal.y() * of_row[1]) * coupling.along_normal +
            of_row[2] * coupling.turn;
  }
  return line;
}

void PoseSystem::AddForeignPoses(const Eigen::VectorXd& v, Eigen::VectorXd* result) const {
  std::vector<std::vector<double>> to_rank(peers->size()), from_rank;
  for (const ForeignCoupling& coupling : foreign_couplings) {
    const double* of_row = v.data() + 3 * static_cast<Eigen::Index>(coupling.row);
    to_rank[coupling.rank].insert(to_rank[coupling.rank].end(), of_row, of_row + 3);
  }
  peers->Swap(to_rank, &from_rank);
  std::vector<std::size_t> next(peers->size(), 0);
  for (const ForeignCoupling& coupling : foreign_couplings) {
    std::size_t& at = next[coupling.rank];
    result->segment<3>(3 * static_cast<Eigen::Index>(coupling.row)) +=
        coupling.block * Eigen::Map<const Eigen::Vector3d>(&from_rank[coupling.rank][at]);
    at += 3;
  }
}

void PoseSystem::Apply(const LineObservations& observations, const Eigen::VectorXd& v,
                       ThreadPool* pool, Eigen::VectorXd* result) const {
  const std::vector<Eigen::Vector2d> shared_lines =
      observations.shared.Sum<2>([&](std::size_t p) { return LineOf(observations, p, v); });
  // The couplings of a landmark are at hand still when its K_p is applied to K_p^T v.
  part_sums_.resize(kNumParts);
  pool->ForEachChunk(kNumParts, 1, [&](std::size_t part, std::size_t, std::size_t) {
    Eigen::VectorXd& sums = part_sums_[part];
    sums.setZero(v.size());
    const std::size_t end = FirstLandmarkOfPart(observations, part + 1);
    for (std::size_t p = FirstLandmarkOfPart(observations, part); p < end; ++p) {
      const std::size_t first = observations.first_of_landmark[p];
      const std::size_t last = observations.first_of_landmark[p + 1];
      const Eigen::Vector2d normal = line_normal[p];
      const int slot = observations.shared.SlotOf(p);
      const Eigen::Vector2d line =
          slot == SharedLandmarks::kNotShared ? LineOf(observations, p, v) : shared_lines[slot];
      for (std::size_t i = first; i < last; ++i) {
        const LineCoupling& coupling = line_coupling[i];
        if (coupling.row == kConstant) continue;
        double* of_row = sums.data() + 3 * static_cast<Eigen::Index>(coupling.row);
        const double along_normal = coupling.along_normal.dot(line);
        of_row[0] += along_normal * normal.x();
        of_row[1] += along_normal * normal.y();
        of_row[2] += coupling.turn.dot(line);
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
  if (peers != nullptr) AddForeignPoses(v, result);
}

}  // namespace plumbline
