#include "plumbline/apps/benchmark/known_walls.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>

#include "plumbline/core/pose_frame.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/factors/surface_noise.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

// The surface that a return belongs to: a wall's line, or a circle.
struct KnownSurface {
  bool exists = false;
  int wall = -1;                       // of a line: index among the walls
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

Vector2d NormalOf(const Face& face) {
  const Vector2d along = (face.b - face.a).normalized();
  return {-along.y(), along.x()};
}

// For every face the first one that is in line with it and looks the same way.
std::vector<int> NumberWalls(const std::vector<Face>& faces) {
  std::vector<int> walls(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Vector2d normal = NormalOf(faces[f]);
    const auto is_in_line = [&](const Face& other) {
      return NormalOf(other).dot(normal) > 1.0 - 1e-9 &&
             std::abs(normal.dot(other.a - faces[f].a)) < 1e-3;
    };
    const auto found = std::find_if(faces.begin(), faces.begin() + f, is_in_line);
    walls[f] = found == faces.begin() + f ? static_cast<int>(f) : walls[found - faces.begin()];
  }
  return walls;
}

KnownSurface SurfaceAt(const Building& building, const std::vector<int>& walls,
                       const Vector2d& hit) {
  KnownSurface surface;
  if (!hit.allFinite()) return surface;
  surface.exists = true;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < building.faces.size(); ++f) {
    const Face& face = building.faces[f];
    const double distance_m = DistanceToFace(face, hit);
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    surface.wall = walls[f];
    surface.origin = face.a;
    surface.normal = NormalOf(face);
  }
  for (const Disc& disc : building.discs) {
    const double distance_m = std::abs((hit - disc.center).norm() - disc.radius_m);
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    surface.wall = -1;
    surface.origin = disc.center;
    surface.normal.setZero();
    surface.radius_m = disc.radius_m;
  }
  return surface;
}

// A wall that is not told: where its line is now.
struct FreeWall {
  Vector2d pivot = Vector2d::Zero();  // on the line, amid its returns
  Vector2d normal = Vector2d::Zero();
  Vector2d true_normal = Vector2d::Zero();
  double turned_rad = 0.0, moved_m = 0.0;  // from the truth
};

// Least squares over all poses but the first, in the frame of the building, and over its walls.
class Localiser {
 public:
  Localiser(const SyntheticDrive& drive, const FactorOptions& factors)
      : drive_(drive), factors_(factors), noise_(NoiseOf(factors)) {
    noise_.surface_variance = 0.0;
    const std::vector<int> walls = NumberWalls(drive.building.faces);
    for (std::size_t r = 0; r < drive.graph.num_returns(); ++r) {
      const Vector2d& hit = drive.log.scans[drive.graph.ScanOfReturn(r)].hits[drive.graph.Beam(r)];
      surfaces_.push_back(SurfaceAt(drive.building, walls, hit));
    }
    NumberSeenWalls();
    for (const SimulatedScan& scan : drive.log.scans) poses_.push_back(scan.odom_from_robot);
  }

  // All walls are known: from an odometry that is metres off.
  void FindPoses() { Iterate(); }

  // From the poses and walls that are there.
  void FreeWalls(bool know_directions) {
    walls_.resize(num_walls_);
    std::vector<int> num_returns(num_walls_, 0);
    for (std::size_t r = 0; r < surfaces_.size(); ++r) {
      KnownSurface& surface = surfaces_[r];
      if (!surface.exists) continue;
      surface.exists = surface.wall >= 0;
      if (!surface.exists) continue;
      FreeWall& wall = walls_[surface.wall];
      const Vector2d point = poses_[PoseOf(r)] * drive_.graph.PointInRobot(r);
      wall.normal = wall.true_normal = surface.normal;
      wall.pivot += point - surface.normal * surface.normal.dot(point - surface.origin);
      ++num_returns[surface.wall];
    }
    for (int w = 0; w < num_walls_; ++w) walls_[w].pivot /= std::max(num_returns[w], 1);
    turn_weight_ = know_directions ? kHeld : 1.0 / (0.3 * 0.3);
    Iterate();
  }

  MapEstimate Map() const {
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
  static constexpr double kHeld = 1e12;  // information of what does not move

  // In the order of their first returns: what nobody sees would make the dense system larger.
  void NumberSeenWalls() {
    std::map<int, int> numbers;
    for (KnownSurface& surface : surfaces_) {
      if (surface.wall < 0) continue;
      surface.wall = numbers.emplace(surface.wall, static_cast<int>(numbers.size())).first->second;
    }
    num_walls_ = static_cast<int>(numbers.size());
  }

  // The distances are all but linear in the poses.
  void Iterate() {
    constexpr int kMaxIterations = 50;
    for (int i = 0; i < kMaxIterations && Step() > 1e-9; ++i) {
    }
  }

  Eigen::Index PoseRow(int pose) const { return 3 * static_cast<Eigen::Index>(pose); }
  // Of a wall's turn; its move follows.
  Eigen::Index WallRow(int wall) const {
    return PoseRow(static_cast<int>(poses_.size())) + 2 * static_cast<Eigen::Index>(wall);
  }

  // Returns the length of the step [m] and [rad].
  double Step() {
    const Eigen::Index size = WallRow(static_cast<int>(walls_.size()));
    information_ = Eigen::MatrixXd::Zero(size, size);
    gradient_ = Eigen::VectorXd::Zero(size);
    for (std::size_t r = 0; r < surfaces_.size(); ++r) AddReturn(r);
    for (const OdometryConstraint& step : drive_.graph.odometry()) AddOdometry(step);
    for (std::size_t w = 0; w < walls_.size(); ++w) HoldWall(static_cast<int>(w));
    const Eigen::Index free = size - 3;
    const Eigen::VectorXd step =
        -information_.bottomRightCorner(free, free).ldlt().solve(gradient_.tail(free));
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      const Eigen::Index row = PoseRow(static_cast<int>(i)) - 3;
      poses_[i].x += step[row];
      poses_[i].y += step[row + 1];
      poses_[i].yaw += step[row + 2];
    }
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      const Eigen::Index row = WallRow(static_cast<int>(w)) - 3;
      MoveWall(step[row], step[row + 1], &walls_[w]);
    }
    return step.norm();
  }

  static void MoveWall(double turn_rad, double move_m, FreeWall* wall) {
    wall->turned_rad += turn_rad;
    wall->moved_m += move_m;
    wall->pivot += move_m * wall->normal;
    wall->normal = Pose2(0.0, 0.0, turn_rad) * wall->normal;
  }

  // Weakly, or no solution would be there for a wall that one return hits.
  void HoldWall(int wall) {
    const Eigen::Index row = WallRow(wall);
    information_(row, row) += turn_weight_;
    gradient_[row] += turn_weight_ * walls_[wall].turned_rad;
    information_(row + 1, row + 1) += 1.0;
    gradient_[row + 1] += walls_[wall].moved_m;
  }

  // Distance [m] of a point from the surface of a return as it is now.
  double DistanceOf(std::size_t r, const Vector2d& point, Vector2d* normal) const {
    if (walls_.empty()) return surfaces_[r].Distance(point, normal);
    const FreeWall& wall = walls_[surfaces_[r].wall];
    *normal = wall.normal;
    return wall.normal.dot(point - wall.pivot);
  }

  void AddReturn(std::size_t r) {
    if (!surfaces_[r].exists) return;
    const int i = PoseOf(r);
    const Vector2d point = poses_[i] * drive_.graph.PointInRobot(r);
    Vector2d normal;
    const double distance = DistanceOf(r, point, &normal);
    const Vector2d arm = point - poses_[i].translation();
    const Eigen::Vector3d jacobian(normal.x(), normal.y(),
                                   normal.y() * arm.x() - normal.x() * arm.y());
    // By the true direction, or a wall would turn towards beams that graze it, to weigh more.
    const Vector2d known = walls_.empty() ? normal : walls_[surfaces_[r].wall].true_normal;
    const Vector2d beam = BeamOf(r);
    const double weight = 1.0 / noise_.BeamVariance(beam.norm(), beam.normalized(), known);
    const Eigen::Index row = PoseRow(i);
    information_.block<3, 3>(row, row) += weight * jacobian * jacobian.transpose();
    gradient_.segment<3>(row) += weight * distance * jacobian;
    if (walls_.empty()) return;
    const FreeWall& wall = walls_[surfaces_[r].wall];
    const Eigen::Vector2d by_wall(TurnedLeft(wall.normal).dot(point - wall.pivot), -1.0);
    const Eigen::Index wall_row = WallRow(surfaces_[r].wall);
    information_.block<2, 2>(wall_row, wall_row) += weight * by_wall * by_wall.transpose();
    information_.block<2, 3>(wall_row, row) += weight * by_wall * jacobian.transpose();
    information_.block<3, 2>(row, wall_row) += weight * jacobian * by_wall.transpose();
    gradient_.segment<2>(wall_row) += weight * distance * by_wall;
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
    const double distance = DistanceOf(r, point, &normal);
    const Vector2d beam = BeamOf(r);
    const Vector2d pull = noise_.BeamCovarianceTimes(beam.norm(), beam.normalized(), normal);
    return point - pull * distance / pull.dot(normal);
  }

  int PoseOf(std::size_t r) const { return drive_.graph.scan(drive_.graph.ScanOfReturn(r)).pose; }
  // From the laser to the end of the beam [m], in the frame of the building.
  Vector2d BeamOf(std::size_t r) const {
    const int scan = drive_.graph.ScanOfReturn(r);
    const Pose2& robot_from_laser = drive_.graph.LaserOfScan(scan).robot_from_laser;
    const Vector2d in_robot = drive_.graph.PointInRobot(r) - robot_from_laser.translation();
    return Pose2(0.0, 0.0, poses_[PoseOf(r)].yaw) * in_robot;
  }

  const SyntheticDrive& drive_;
  const FactorOptions& factors_;
  SurfaceNoise noise_;
  std::vector<KnownSurface> surfaces_;  // per return
  int num_walls_ = 0;
  std::vector<FreeWall> walls_;  // empty: all are told
  double turn_weight_ = 0.0;
  std::vector<Pose2> poses_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
};

}  // namespace

MapEstimate EstimateGivenTruth(const SyntheticDrive& drive, const FactorOptions& factors,
                               Told told) {
  Localiser localiser(drive, factors);
  localiser.FindPoses();
  if (told != Told::kWalls) localiser.FreeWalls(told == Told::kDirections);
  return localiser.Map();
}

}  // namespace plumbline
