#include "plumbline/solvers/seeding/scan_matcher.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "plumbline/core/options_check.h"
#include "plumbline/factors/robust_loss.h"

namespace plumbline {
namespace {

struct NormalEquations {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double robust_cost = 0.0;  // sum over the points, each in [0, 1]
  int num_matched = 0;
};

NormalEquations Linearize(const LocalMap& map, const SurfacePoints& scan,
                          const Pose2& world_from_robot, double gate_m, double sigma_m) {
  NormalEquations equations;
  const double c = std::cos(world_from_robot.yaw), s = std::sin(world_from_robot.yaw);
  Eigen::Matrix2d rotation;
  rotation << c, -s, s, c;
  // A third of the gate: a correspondence at the gate weighs one hundredth of one on its surface.
  const double scale_squared = gate_m * gate_m / 9.0;
  const GemanMcClure loss{scale_squared};
  const double inverse_variance = 1.0 / (sigma_m * sigma_m);
  for (const SurfacePoint& point : scan) {
    const Eigen::Vector2d arm = rotation * point.position;
    const SurfacePoint in_world{arm + world_from_robot.translation(), rotation * point.normal};
    const SurfacePoint* match = map.Nearest(in_world, gate_m);
    if (match == nullptr) {
      equations.robust_cost += 1.0;
      continue;
    }
    ++equations.num_matched;
    const Eigen::Vector2d& normal = match->normal;
    const double distance = normal.dot(in_world.position - match->position);
    equations.robust_cost += loss.Rho(distance * distance) / scale_squared;
    const Eigen::Vector3d jacobian(normal.x(), normal.y(),
                                   -normal.x() * arm.y() + normal.y() * arm.x());
    const double weight = loss.Weight(distance * distance) * inverse_variance;
    equations.information += weight * jacobian * jacobian.transpose();
    equations.gradient += weight * distance * jacobian;
  }
  return equations;
}

void AddPrediction(const PosePrediction& prediction, const Pose2& world_from_robot,
                   Eigen::Matrix3d* information, Eigen::Vector3d* gradient) {
  const Pose2 error = Between(prediction.world_from_robot, world_from_robot);
  const double c = std::cos(prediction.world_from_robot.yaw);
  const double s = std::sin(prediction.world_from_robot.yaw);
  Eigen::Matrix3d predicted_from_world;
  predicted_from_world << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d weighted = predicted_from_world.transpose() * prediction.information;
  *information += weighted * predicted_from_world;
  *gradient += weighted * Eigen::Vector3d(error.x, error.y, error.yaw);
}

}  // namespace

bool ScanMatchOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(fine_gate_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(coarse_gate_m, >=, fine_gate_m);
  PLUMBLINE_CHECK_OPTION(max_iterations, >, 0);
  PLUMBLINE_CHECK_FINITE_OPTION(sigma_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(step_tolerance, >, 0.0);
  return true;
}

ScanMatch MatchScan(const LocalMap& map, const SurfacePoints& scan,
                    const PosePrediction& prediction, const ScanMatchOptions& options) {
  ScanMatch match;
  match.world_from_robot = prediction.world_from_robot;
  if (scan.empty() || map.points().empty()) return match;
  double gate_m = options.coarse_gate_m;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    Pose2& pose = match.world_from_robot;
    NormalEquations equations = Linearize(map, scan, pose, gate_m, options.sigma_m);
    AddPrediction(prediction, pose, &equations.information, &equations.gradient);
    // The smallest of dampings keeps a featureless scan without prior information solvable.
    equations.information.diagonal().array() += 1e-6;
    const Eigen::Vector3d step = -equations.information.ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    pose.x += step.x();
    pose.y += step.y();
    pose.yaw += step.z();
    const bool at_fine_gate = gate_m <= options.fine_gate_m;
    if (at_fine_gate && step.cwiseAbs().maxCoeff() < options.step_tolerance) break;
    gate_m = std::max(options.fine_gate_m, 0.5 * gate_m);
  }
  const NormalEquations last =
      Linearize(map, scan, match.world_from_robot, options.fine_gate_m, options.sigma_m);
  match.mean_cost = last.robust_cost / static_cast<double>(scan.size());
  match.inlier_ratio = static_cast<double>(last.num_matched) / static_cast<double>(scan.size());
  match.information = last.information;
  return match;
}

}  // namespace plumbline
