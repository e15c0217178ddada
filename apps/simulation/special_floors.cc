#include "plumbline/apps/simulation/special_floors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plumbline/apps/simulation/floor_plan.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/laser_scan.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

constexpr double kWallM = 0.2, kDoorM = 1.0;

double DistanceToSegment(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
  const double share = (point - a).dot(b - a) / (b - a).squaredNorm();
  return (a + std::clamp(share, 0.0, 1.0) * (b - a) - point).norm();
}

double DistanceToPath(const Vector2d& point, const std::vector<Vector2d>& path) {
  double nearest = (point - path[0]).norm();
  for (std::size_t i = 1; i < path.size(); ++i) {
    nearest = std::min(nearest, DistanceToSegment(point, path[i - 1], path[i]));
  }
  return nearest;
}

void SetPath(const std::vector<Vector2d>& path, Building* building) {
  for (const Vector2d& point : path) building->path.push_back({point, building->path.size() + 1});
}

class Ring {
 public:
  Ring(const RingStyle& style, NoiseSource* source) : source_(source) {
    const double pitch = 2.0 * kPi / style.num_sides;
    for (int i = 0; i < style.num_sides; ++i) {
      const double angle = (i + 0.6 * style.irregularity * (source->Uniform() - 0.5)) * pitch;
      const double radius = 8.0 * (1.0 + 0.4 * style.irregularity * (source->Uniform() - 0.5));
      corners_.push_back(BeamEnd(radius, angle));
    }
  }

  Building Build() {
    // About ten rooms whatever the number of sides, none of them where two corners meet.
    const int rooms = 10;
    for (int i = 0; i < num_sides(); ++i) {
      plan_.AddWall(At(i, 0.0, -kHalfWidthM), At(i, 1.0, -kHalfWidthM), kWallM);
      plan_.AddWall(At(i, 0.0, kHalfWidthM), At(i, 1.0, kHalfWidthM), kWallM);
      plan_.AddWall(At(i, 0.0, kOutsideM), At(i, 1.0, kOutsideM), kWallM);
    }
    for (int room = 0; room < rooms; ++room) {
      const double place =
          (room + source_->Uniform(-0.25, 0.25)) * num_sides() / rooms + num_sides();
      AddPartition(place);
      AddDoor(place + (0.5 + source_->Uniform(-0.1, 0.1)) * num_sides() / rooms);
      AddFurniture(place + 0.3 * num_sides() / rooms);
      AddFurniture(place + 0.7 * num_sides() / rooms);
      AddPillar(place);
    }
    Building building;
    plan_.Furnish(&building);
    SetPath(Path(), &building);
    return building;
  }

 private:
  static constexpr double kHalfWidthM = 1.3, kOutsideM = 5.0;  // off the corridor's middle line

  int num_sides() const { return static_cast<int>(corners_.size()); }

  // A point `share` along a side, and this far off the middle line, outwards along the ray.
  Vector2d At(int side, double share, double outwards_m) const {
    const auto corner = [&](int i) {
      const Vector2d& at = corners_[i % num_sides()];
      return Vector2d(at * (1.0 + outwards_m / at.norm()));
    };
    return corner(side) + share * (corner(side + 1) - corner(side));
  }
  // The same of a place counted in sides.
  Vector2d At(double place, double outwards_m) const {
    const double side = std::floor(place);
    return At(static_cast<int>(side), place - side, outwards_m);
  }

  void AddPartition(double place) {
    plan_.AddWall(At(place, kHalfWidthM), At(place, kOutsideM), 0.5 * kWallM);
  }

  // In the middle of a side where the sides are short, so that it does not reach around a corner.
  void AddDoor(double place) {
    const int side = static_cast<int>(place);
    const Vector2d a = At(side, 0.0, kHalfWidthM), b = At(side, 1.0, kHalfWidthM);
    const double half = std::min(0.45, 0.5 * kDoorM / (b - a).norm());
    const double middle = std::clamp(place - side, half + 0.05, 0.95 - half);
    plan_.CutDoor(a + (middle - half) * (b - a), a + (middle + half) * (b - a));
  }

  void AddFurniture(double place) {
    const Vector2d at = At(place, source_->Uniform(2.4, 4.2));
    plan_.AddBox(Pose2(at.x(), at.y(), source_->Uniform(0.0, kPi)),
                 {source_->Uniform(0.5, 1.6), source_->Uniform(0.4, 0.7)});
  }

  // At the inner wall.
  void AddPillar(double place) {
    plan_.AddDisc(At(place, -kHalfWidthM), source_->Uniform(0.15, 0.4));
  }

  std::vector<Vector2d> Path() const {
    std::vector<Vector2d> path = {At(0, 0.5, 0.0)};
    const int num_corners = num_sides() + num_sides() / 2;
    for (int i = 1; i <= num_corners; ++i) path.push_back(At(i, 0.0, 0.0));
    path.push_back(At(num_corners, 0.5, 0.0));
    return path;
  }

  NoiseSource* source_;
  FloorPlan plan_;
  std::vector<Vector2d> corners_;  // of the corridor's middle line
};

}  // namespace

Building MakeHall(NoiseSource* source) {
  constexpr double kWidthM = 40.0, kDepthM = 30.0, kClearM = 1.5;
  FloorPlan plan;
  plan.AddRoom({0.0, 0.0}, {kWidthM, kDepthM}, kWallM);
  std::vector<Vector2d> path;
  const auto add = [&](double x, double y) {
    path.emplace_back(x + source->Uniform(-2.0, 2.0), y + source->Uniform(-2.0, 2.0));
  };
  for (int round = 0; round < 2; ++round) {
    add(7.0, 7.0);
    add(20.0, 7.0);
    add(33.0, 7.0);
    add(33.0, 23.0);
    if (round == 1) break;
    add(20.0, 23.0);
    add(7.0, 23.0);
  }
  for (int i = 0; i < 60; ++i) {
    const Vector2d at(source->Uniform(1.0, kWidthM - 1.0), source->Uniform(1.0, kDepthM - 1.0));
    const double kind = source->Uniform(), size = source->Uniform(0.3, 1.5);
    const double turn = source->Uniform(0.0, kPi);
    if (DistanceToPath(at, path) < kClearM) continue;
    if (kind < 0.5) {
      plan.AddDisc(at, 0.3 * size);
    } else {
      plan.AddBox(Pose2(at.x(), at.y(), turn), {size, 0.6});
    }
  }
  Building building;
  plan.Furnish(&building);
  SetPath(path, &building);
  return building;
}

Building MakeRing(const RingStyle& style, NoiseSource* source) {
  return Ring(style, source).Build();
}

}  // namespace plumbline
