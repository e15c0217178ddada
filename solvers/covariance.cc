#include "plumbline/solvers/covariance.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/pose_preconditioner.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/reduced/unanchored_components.h"
#include "plumbline/solvers/solver_input.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {
namespace {

// Of the right-hand side, in the preconditioner's norm: eight digits of the covariance.
constexpr double kTolerance = 1e-8;
constexpr int kMaxIterations = 2000;
// Of a variance: damping that explains more of it stands for what nothing holds, as a pose along a
// bare corridor.
constexpr double kMaxShareOfDamping = 0.01;
// A kilometre squared: rounding of exactly straight walls.
constexpr double kUnheldVariance = 1e6;

Status CheckPairs(const SlamGraph& graph, const std::vector<PosePair>& pairs) {
  for (const PosePair& pair : pairs) {
    for (const int pose : {pair.a, pair.b}) {
      if (pose >= 0 && pose < graph.num_poses()) continue;
      return Status::InvalidArgument("covariance of pose " + std::to_string(pose) +
                                     ", but the graph has " + std::to_string(graph.num_poses()) +
                                     " poses");
    }
  }
  return Status::Ok();
}

// The reduced solver's linear system at a state of the poses.
class PosteriorSystem {
 public:
  PosteriorSystem(const SolverOptions& options, const SlamGraph& graph,
                  const std::vector<double>& poses)
      : pool_(options.num_threads), frames_(FramesOf(poses)) {
    const FactorOptions& factors = options.factors;
    const MeasuredSurface surface = MeasureSurface(graph, NormalOptionsFor(factors.beam), &pool_);
    LineLandmarks cut = CutIntoLandmarks(graph, poses, surface,
                                         LandmarkOptionsFor(factors, options.association), &pool_);
    ReturnCompressor compressor(graph, NoiseOf(factors), &pool_);
    observations_ = compressor.LayOut(cut.landmarks.size(), cut.landmark_of_return);
    const GemanMcClure loss = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
    // Weights and lines depend on each other; the second time they are settled.
    for (int i = 0; i < 2; ++i) {
      compressor.Weigh(cut.landmarks, frames_, loss, &observations_);
      FitLandmarkLines(observations_, frames_, &pool_, &cut.landmarks);
    }
    const PoseTerms terms(graph, factors);
    unanchored_components_ = FindUnanchoredComponents(observations_, terms);
    system_.Linearize(observations_, cut.landmarks, terms, poses, frames_, &pool_);
  }

  Status CheckHeld() const {
    if (unanchored_components_.empty()) return Status::Ok();
    return Status::InvalidArgument("nothing ties pose " +
                                   std::to_string(unanchored_components_.front()) +
                                   " to a fixed pose: its covariance is infinite");
  }

  // The three columns of the inverse that belong to a pose, rows of all poses.
  Status Columns(int pose, Eigen::MatrixX3d* columns) {
    if (!preconditioner_) preconditioner_.emplace(system_, observations_, frames_, &pool_);
    columns->setZero(3 * static_cast<Eigen::Index>(frames_.size()), 3);
    const int row = system_.row_of_pose[pose];
    if (row == PoseSystem::kConstant) return Status::Ok();
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(system_.gradient.size()), x;
    for (int axis = 0; axis < 3; ++axis) {
      unit[3 * row + axis] = 1.0;
      const PoseSystemResult result = SolvePoseSystem(system_, observations_, *preconditioner_,
                                                      unit, kTolerance, kMaxIterations, &pool_, &x);
      unit[3 * row + axis] = 0.0;
      if (!result.converged) {
        return Status::Unavailable("the covariance of pose " + std::to_string(pose) +
                                   " did not converge in " + std::to_string(result.iterations) +
                                   " iterations");
      }
      // What the damping explains of a variance x' S x.
      const double by_damping = x.dot(system_.damping.cwiseProduct(x));
      const double variance = x[3 * row + axis];
      if (by_damping > kMaxShareOfDamping * variance || variance > kUnheldVariance) {
        return Status::InvalidArgument("nothing holds pose " + std::to_string(pose) +
                                       " in every direction: its covariance is infinite");
      }
      columns->col(axis) = system_.ByPose(x);
    }
    return Status::Ok();
  }

 private:
  ThreadPool pool_;
  const std::vector<PoseFrame> frames_;
  LineObservations observations_;
  PoseSystem system_;
  std::vector<int> unanchored_components_;
  std::optional<PosePreconditioner> preconditioner_;
};

Status ComputeCovariances(const SolverOptions& options, const SlamGraph& graph,
                          const MapState& state, const std::vector<PosePair>& pairs,
                          std::vector<Eigen::Matrix3d>* covariances) {
  const DefaultFloatEnvironment float_environment;
  PLUMBLINE_RETURN_IF_ERROR(CheckSolverInput(options, graph, state));
  PLUMBLINE_RETURN_IF_ERROR(CheckPairs(graph, pairs));
  for (const CustomFactor& factor : graph.factors()) {
    if (factor.points.empty()) continue;
    return Status::InvalidArgument("factor \"" + factor.name +
                                   "\" sees points, which covariances of poses leave out");
  }
  PosteriorSystem system(options, graph, state.poses);
  PLUMBLINE_RETURN_IF_ERROR(system.CheckHeld());
  std::map<int, std::vector<std::size_t>> pairs_of_pose;
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs_of_pose[pairs[i].a].push_back(i);
  std::vector<Eigen::Matrix3d> result(pairs.size());
  Eigen::MatrixX3d columns;
  for (const auto& [pose, indices] : pairs_of_pose) {
    PLUMBLINE_RETURN_IF_ERROR(system.Columns(pose, &columns));
    for (const std::size_t i : indices) {
      const Eigen::Matrix3d block = columns.middleRows<3>(3 * pairs[i].b).transpose();
      // Symmetric but for the last digits of the iteration.
      result[i] = pairs[i].b == pose ? Eigen::Matrix3d(0.5 * (block + block.transpose())) : block;
    }
  }
  covariances->swap(result);
  return Status::Ok();
}

}  // namespace

Status ComputePoseCovariances(const SolverOptions& options, const SlamGraph& graph,
                              const MapState& state, const std::vector<PosePair>& pairs,
                              std::vector<Eigen::Matrix3d>* covariances) {
  return CatchExceptions(
      [&] { return ComputeCovariances(options, graph, state, pairs, covariances); });
}

Eigen::Matrix3d RelativePoseCovariance(const Pose2& world_from_a, const Pose2& world_from_b,
                                       const Eigen::Matrix3d& aa, const Eigen::Matrix3d& ab,
                                       const Eigen::Matrix3d& bb) {
  const Pose2 a_from_b = Between(world_from_a, world_from_b);
  const double c = std::cos(world_from_a.yaw), s = std::sin(world_from_a.yaw);
  Eigen::Matrix3d by_b;
  by_b << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d by_a = -by_b;
  by_a(0, 2) = a_from_b.y;
  by_a(1, 2) = -a_from_b.x;
  const Eigen::Matrix3d mixed = by_a * ab * by_b.transpose();
  return by_a * aa * by_a.transpose() + mixed + mixed.transpose() + by_b * bb * by_b.transpose();
}

}  // namespace plumbline
