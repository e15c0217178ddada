#include "plumbline/apps/benchmark/known_walls.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>

#include "plumbline/factors/motion_factor.h"
#include "plumbline/factors/surface_noise.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

// The surface that a return belongs to: a wall's line, or a circle.
struct KnownSurface {
  bool exists = false;
  Vector2d origin = Vector2d::Zero();  // on the line, or the circle's centre [m]
  Vector2d normal = Vector2d::Zero();  // of the line; zero for a circle
  double radius_m = 0.0;

  // Distance [m] of a point and the direction in which it grows.
  double Distance(const Vector2d& point, Vector2d* gradient) const {
    const Vector2d arm = point - origin;
    *gradient = normal.isZero() ? Vector2d(arm.normalized()) : normal;
    return gradient->dot(arm) - radius_m;
  }
};

double DistanceToFace(const Face& face, const Vector2d& point) {
  const Vector2d along = face.b - face.a;
  const double share = std::clamp((point - face.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (face.a + share * along - point).norm();
}

KnownSurface SurfaceAt(const Building& building, const Vector2d& hit) {
  KnownSurface surface;
  if (!hit.allFinite()) return surface;
  surface.exists = true;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Face& face : building.faces) {
    const double distance_m = DistanceToFace(face, hit);
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    const Vector2d along = (face.b - face.a).normalized();
    surface.origin = face.a;
    surface.normal = {-along.y(), along.x()};
  }
  for (const Disc& disc : building.discs) {
    const double distance_m = std::abs((hit - disc.center).norm() - disc.radius_m);
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    surface.origin = disc.center;
    surface.normal.setZero();
    surface.radius_m = disc.radius_m;
  }
  return surface;
}

// Least squares over all poses but the first, in the frame of the building.
class Localiser {
 public:
  Localiser(const SyntheticDrive& drive, const FactorOptions& factors)
      : drive_(drive), factors_(factors), noise_(NoiseOf(factors)) {
    noise_.surface_variance = 0.0;
    const LaserReturns& returns = drive.graph.returns();
    for (std::size_t r = 0; r < returns.size(); ++r) {
      const Vector2d& hit = drive.log.scans[returns.scan[r]].hits[returns.beam[r]];
      surfaces_.push_back(SurfaceAt(drive.building, hit));
    }
    for (const SimulatedScan& scan : drive.log.scans) poses_.push_back(scan.odom_from_robot);
  }

  MapEstimate Run() {
    // From an odometry that is metres off; the distances are all but linear in the poses.
    constexpr int kMaxIterations = 50;
    for (int i = 0; i < kMaxIterations && Step() > 1e-9; ++i) {
    }
    MapEstimate map;
    const Pose2 map_from_world = poses_.front().Inverse();
    for (const Pose2& pose : poses_) map.poses.push_back(Between(poses_.front(), pose));
    for (std::size_t r = 0; r < surfaces_.size(); ++r) {
      const Vector2d point = map_from_world * PointOf(r);
      map.points.insert(map.points.end(), {point.x(), point.y()});
    }
    return map;
  }

 private:
  // Returns the length of the step [m] and [rad].
  double Step() {
    const Eigen::Index size = 3 * static_cast<Eigen::Index>(poses_.size());
    information_ = Eigen::MatrixXd::Zero(size, size);
    gradient_ = Eigen::VectorXd::Zero(size);
    for (std::size_t r = 0; r < surfaces_.size(); ++r) AddReturn(r);
    for (const OdometryConstraint& step : drive_.graph.odometry()) AddOdometry(step);
    const Eigen::Index free = size - 3;
    const Eigen::VectorXd step =
        -information_.bottomRightCorner(free, free).ldlt().solve(gradient_.tail(free));
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      const auto row = 3 * static_cast<Eigen::Index>(i - 1);
      poses_[i].x += step[row];
      poses_[i].y += step[row + 1];
      poses_[i].yaw += step[row + 2];
    }
    return step.norm();
  }

  void AddReturn(std::size_t r) {
    if (!surfaces_[r].exists) return;
    const int i = PoseOf(r);
    const Vector2d point = poses_[i] * drive_.graph.PointInRobot(r);
    Vector2d normal;
    const double distance = surfaces_[r].Distance(point, &normal);
    const Vector2d arm = point - poses_[i].translation();
    const Eigen::Vector3d jacobian(normal.x(), normal.y(),
                                   normal.y() * arm.x() - normal.x() * arm.y());
    const double weight = 1.0 / noise_.BeamVariance(BeamOf(r), normal);
    information_.block<3, 3>(3 * i, 3 * i) += weight * jacobian * jacobian.transpose();
    gradient_.segment<3>(3 * i) += weight * distance * jacobian;
  }

  void AddOdometry(const OdometryConstraint& step) {
    const MotionResidual residual = MakeMotionResidual(step.from_from_to, factors_.motion);
    const Pose2 &from = poses_[step.from], &to = poses_[step.to];
    const double from_block[] = {from.x, from.y, from.yaw}, to_block[] = {to.x, to.y, to.yaw};
    Eigen::Vector3d error;
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_from, by_to;
    residual.Evaluate(from_block, to_block, error.data(), by_from.data(), by_to.data());
    const int a = 3 * step.from, b = 3 * step.to;
    information_.block<3, 3>(a, a) += by_from.transpose() * by_from;
    information_.block<3, 3>(b, b) += by_to.transpose() * by_to;
    information_.block<3, 3>(a, b) += by_from.transpose() * by_to;
    information_.block<3, 3>(b, a) += by_to.transpose() * by_from;
    gradient_.segment<3>(a) += by_from.transpose() * error;
    gradient_.segment<3>(b) += by_to.transpose() * error;
  }

  // On its surface, where the beam's noise puts it: the end of the beam, moved along C n.
  Vector2d PointOf(std::size_t r) const {
    Vector2d point = poses_[PoseOf(r)] * drive_.graph.PointInRobot(r);
    if (!surfaces_[r].exists) return point;
    Vector2d normal;
    const double distance = surfaces_[r].Distance(point, &normal);
    const Vector2d beam = BeamOf(r), along = beam.normalized(), across(-along.y(), along.x());
    const Vector2d pull =
        noise_.range_variance * along.dot(normal) * along +
        noise_.bearing_variance * beam.squaredNorm() * across.dot(normal) * across;
    return point - pull * distance / noise_.BeamVariance(beam, normal);
  }

  int PoseOf(std::size_t r) const { return drive_.graph.scan(drive_.graph.returns().scan[r]).pose; }
  // From the laser to the end of the beam [m], in the frame of the building.
  Vector2d BeamOf(std::size_t r) const {
    const int scan = drive_.graph.returns().scan[r];
    const Pose2& robot_from_laser = drive_.graph.LaserOfScan(scan).robot_from_laser;
    const Vector2d in_robot = drive_.graph.PointInRobot(r) - robot_from_laser.translation();
    return Pose2(0.0, 0.0, poses_[PoseOf(r)].yaw) * in_robot;
  }

  const SyntheticDrive& drive_;
  const FactorOptions& factors_;
  SurfaceNoise noise_;
  std::vector<KnownSurface> surfaces_;  // per return
  std::vector<Pose2> poses_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
};

}  // namespace

MapEstimate LocaliseAgainstTruth(const SyntheticDrive& drive, const FactorOptions& factors) {
  return Localiser(drive, factors).Run();
}

}  // namespace plumbline
