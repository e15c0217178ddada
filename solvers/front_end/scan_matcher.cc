#include "plumbline/solvers/front_end/scan_matcher.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/robust_loss.h"

namespace plumbline {
namespace {

// A gate's correspondences have settled when a step moves the points by less than this share of it.
constexpr double kSettledGateShare = 0.1;

double RootMeanSquareRange(const SurfacePoints& scan) {
  double sum = 0.0;
  for (const SurfacePoint& point : scan) sum += point.position.squaredNorm();
  return std::sqrt(sum / static_cast<double>(scan.size()));
}

// The surfaces' normals are known to about this [rad].
constexpr double kNormalSigmaRad = 0.10;

struct NormalEquations {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double robust_cost = 0.0;  // sum of squared whitened distances under the loss
  int num_matched = 0;
};

// The point of the map that is nearest to a point of the scan, as an iteration has found it. The
// search for it takes most of the time of a match.
class Correspondence {
 public:
  // Null if there is none within the gate, which must not be wider than before.
  const SurfacePoint* Update(const LocalMap& map, const SurfacePoint& in_world, double yaw,
                             double gate_m, bool moves_little) {
    if (Holds(in_world, yaw, gate_m)) return neighbor_.point;
    if (moves_little) {
      neighbor_ = map.NearestWithMargin(in_world, gate_m, neighbor_.point);
    } else {
      neighbor_ = {map.Nearest(in_world, gate_m, neighbor_.point), 0.0};
    }
    searched_at_ = in_world.position;
    searched_yaw_ = yaw;
    return neighbor_.point;
  }

 private:
  bool Holds(const SurfacePoint& in_world, double yaw, double gate_m) const {
    const auto square = [](double x) { return x * x; };
    if (std::abs(yaw - searched_yaw_) > LocalMap::kMarginRad ||
        (in_world.position - searched_at_).squaredNorm() >= square(neighbor_.margin_m)) {
      return false;
    }
    const SurfacePoint* point = neighbor_.point;
    return point == nullptr ||
           ((point->position - in_world.position).squaredNorm() < square(gate_m) &&
            LocalMap::FacesAlike(in_world, *point));
  }

  LocalMap::Neighbor neighbor_;
  Eigen::Vector2d searched_at_ = Eigen::Vector2d::Zero();
  double searched_yaw_ = 0.0;
};

// correspondences: of the scan's points, as the iteration before left them; brought up to date.
NormalEquations Linearize(const LocalMap& map, const SurfacePoints& scan,
                          const Pose2& world_from_robot, double gate_m, double sigma_m,
                          bool moves_little, std::vector<Correspondence>* correspondences) {
  NormalEquations equations;
  const FrameChange world_from_scan(world_from_robot);
  // A third of the gate: a correspondence at the gate weighs one hundredth of one on its surface.
  const double scale_squared = gate_m * gate_m / 9.0;
  const GemanMcClure loss{scale_squared};
  const double inverse_variance = 1.0 / (sigma_m * sigma_m);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const SurfacePoint in_world = world_from_scan * scan[i];
    const SurfacePoint* match =
        (*correspondences)[i].Update(map, in_world, world_from_robot.yaw, gate_m, moves_little);
    if (match == nullptr) {
      equations.robust_cost += scale_squared * inverse_variance;
      continue;
    }
    ++equations.num_matched;
    const Eigen::Vector2d& normal = match->normal;
    const double distance = normal.dot(in_world.position - match->position);
    equations.robust_cost += loss.Rho(distance * distance) * inverse_variance;
    const Eigen::Vector2d arm = in_world.position - world_from_robot.translation();
    const Eigen::Vector3d jacobian(normal.x(), normal.y(),
                                   -normal.x() * arm.y() + normal.y() * arm.x());
    const double weight = loss.Weight(distance * distance) * inverse_variance;
    equations.information += weight * jacobian * jacobian.transpose();
    equations.gradient += weight * distance * jacobian;
  }
  return equations;
}

// Takes away what the equations owe to the noise of their normals. A normal that is off by an angle
// a seems to say a^2 as much along its surface as it says across it: the two walls of a bare
// corridor would hold the robot back.
void DropNormalNoise(NormalEquations* equations) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(equations->information.topLeftCorner<2, 2>());
  const double weak = axes.eigenvalues()(0), strong = axes.eigenvalues()(1);
  const double spurious = kNormalSigmaRad * kNormalSigmaRad * strong;
  const double share = weak > spurious ? 1.0 - spurious / weak : 0.0;
  const Eigen::Vector2d direction = axes.eigenvectors().col(0);
  const Eigen::Matrix2d along = direction * direction.transpose();
  equations->gradient.head<2>() -= (1.0 - share) * along * equations->gradient.head<2>();
  Eigen::Matrix3d shrink = Eigen::Matrix3d::Identity();
  shrink.topLeftCorner<2, 2>() -= (1.0 - std::sqrt(share)) * along;
  equations->information = shrink * equations->information * shrink;
}

// Returns the squared Mahalanobis distance from the prediction.
double AddPrediction(const PosePrediction& prediction, const Pose2& world_from_robot,
                     Eigen::Matrix3d* information, Eigen::Vector3d* gradient) {
  const Pose2 error = Between(prediction.world_from_robot, world_from_robot);
  const double yaw = prediction.world_from_robot.yaw;
  const Eigen::Vector3d in_predicted(error.x, error.y, error.yaw);
  const Eigen::Vector3d pull = prediction.information * in_predicted;
  *information += RotateAxes(prediction.information, yaw);
  gradient->head<2>() += Pose2(0.0, 0.0, yaw) * Eigen::Vector2d(pull.head<2>());
  gradient->z() += pull.z();
  return in_predicted.dot(pull);
}

}  // namespace

ScanMatch MatchScan(const LocalMap& map, const SurfacePoints& scan,
                    const PosePrediction& prediction, const ScanMatchOptions& options) {
  ScanMatch match;
  match.world_from_robot = prediction.world_from_robot;
  if (scan.empty() || map.points().empty()) return match;
  const double lever_m = RootMeanSquareRange(scan);
  std::vector<Correspondence> correspondences(scan.size());
  double gate_m = options.coarse_gate_m, moved_m = gate_m;
  for (int iteration = 0; iteration <= options.max_iterations; ++iteration) {
    const bool is_last = iteration == options.max_iterations;
    if (is_last) gate_m = options.fine_gate_m;
    Pose2& pose = match.world_from_robot;
    NormalEquations equations = Linearize(map, scan, pose, gate_m, options.sigma_m,
                                          moved_m < LocalMap::kMostMarginM, &correspondences);
    DropNormalNoise(&equations);
    // Told before the step: the one that ends the iterations is too small to change the fit.
    match.inlier_ratio =
        static_cast<double>(equations.num_matched) / static_cast<double>(scan.size());
    match.information = equations.information;
    match.chi2 = equations.robust_cost +
                 AddPrediction(prediction, pose, &equations.information, &equations.gradient);
    if (is_last) break;
    // The smallest of dampings keeps a featureless scan without prior information solvable.
    equations.information.diagonal().array() += 1e-6;
    const Eigen::Vector3d step = -equations.information.ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    pose.x += step.x();
    pose.y += step.y();
    pose.yaw += step.z();
    // How far the step moves a typical point. A gate narrows only once its own correspondences
    // have settled: narrowed earlier, it would cut off the ones that still pull the right way.
    moved_m = std::hypot(step.x(), step.y()) + lever_m * std::abs(step.z());
    const bool at_fine_gate = gate_m <= options.fine_gate_m;
    match.converged = at_fine_gate && moved_m < options.step_tolerance_m;
    if (match.converged) break;
    if (moved_m < kSettledGateShare * gate_m) gate_m = std::max(options.fine_gate_m, 0.5 * gate_m);
  }
  return match;
}

std::vector<ScanMatch> MatchInWindow(const LocalMap& map, const SurfacePoints& scan,
                                     const SearchWindow& window) {
  constexpr double kSearchCellM = 0.1;  // the matcher does the rest
  constexpr double kMinScore = 0.3;
  constexpr int kMaxPlaces = 5;
  constexpr PeakSize kPlaceSize{0.5, 0.3};
  std::vector<ScanMatch> matches;
  if (scan.empty() || map.points().empty()) return matches;
  const CorrelativeMatcher search(map.points(), kSearchCellM, window.half_width_m);
  for (const CorrelativeMatch& place :
       search.SearchPeaks(scan, window, kMinScore, kMaxPlaces, kPlaceSize)) {
    PosePrediction start;
    start.world_from_robot = place.map_from_scan;
    matches.push_back(MatchScan(map, scan, start, ScanMatchOptions()));
  }
  return matches;
}

ScanMatch MeasureFit(const LocalMap& map, const SurfacePoints& scan, const Pose2& world_from_robot,
                     const ScanMatchOptions& options) {
  PosePrediction prediction;
  prediction.world_from_robot = world_from_robot;
  ScanMatchOptions without_steps = options;
  without_steps.max_iterations = 0;
  return MatchScan(map, scan, prediction, without_steps);
}

}  // namespace plumbline
