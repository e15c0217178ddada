#include "plumbline/apps/simulation/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plumbline {
namespace {

using Eigen::Vector2d;

// How far a door may lie beside the centre line of the wall that it opens: what rounding to
// centimetres does to the coordinates of a slanted wall.
constexpr double kDoorTolerance = 0.01;

// A rectangle whose sides run from low to high along the axes of a frame.
void AddRectangle(const Pose2& world_from_frame, const Vector2d& low, const Vector2d& high,
                  std::vector<Face>* faces) {
  const Vector2d corners[] = {
      world_from_frame * low, world_from_frame * Vector2d(high.x(), low.y()),
      world_from_frame * high, world_from_frame * Vector2d(low.x(), high.y())};
  for (int i = 0; i < 4; ++i) faces->push_back({corners[i], corners[(i + 1) % 4]});
}

}  // namespace

void FloorPlan::AddWall(const Vector2d& a, const Vector2d& b, double thickness_m) {
  const double half = 0.5 * thickness_m;
  walls_.push_back({a, b, half, half, half});
}

void FloorPlan::AddRoom(const Vector2d& a, const Vector2d& c, double thickness_m) {
  const Vector2d b(c.x(), a.y()), d(a.x(), c.y());
  AddWall(a, b, thickness_m);
  AddWall(b, c, thickness_m);
  AddWall(c, d, thickness_m);
  AddWall(d, a, thickness_m);
}

bool FloorPlan::CutDoor(const Vector2d& a, const Vector2d& b) {
  std::vector<Wall> rest;
  bool opened = false;
  for (const Wall& wall : walls_) opened = CutWall(a, b, wall, &rest) || opened;
  walls_ = std::move(rest);
  if (opened) doors_.push_back({a, b});
  return opened;
}

void FloorPlan::AddBox(const Pose2& world_from_box, const Vector2d& size) {
  AddRectangle(world_from_box, -0.5 * size, 0.5 * size, &furniture_);
}

void FloorPlan::AddDisc(const Vector2d& center, double radius_m) {
  discs_.push_back({center, radius_m});
}

void FloorPlan::Furnish(Building* building) const {
  building->faces = furniture_;
  building->discs = discs_;
  building->doors = doors_;
  for (const Wall& wall : walls_) {
    const Vector2d along = wall.b - wall.a;
    const Pose2 world_from_wall(wall.a.x(), wall.a.y(), std::atan2(along.y(), along.x()));
    AddRectangle(world_from_wall, {-wall.overhang_a_m, -wall.half_thickness_m},
                 {along.norm() + wall.overhang_b_m, wall.half_thickness_m}, &building->faces);
  }
}

// Puts what the door leaves of the wall into `rest`. Returns whether the door lies in the wall.
bool FloorPlan::CutWall(const Vector2d& door_a, const Vector2d& door_b, const Wall& wall,
                        std::vector<Wall>* rest) {
  const double length = (wall.b - wall.a).norm();
  const Vector2d along = (wall.b - wall.a) / length;
  const Vector2d across(-along.y(), along.x());
  const Vector2d to_a = door_a - wall.a, to_b = door_b - wall.a;
  const double begin = std::min(to_a.dot(along), to_b.dot(along));
  const double end = std::max(to_a.dot(along), to_b.dot(along));
  const bool opens = std::abs(to_a.dot(across)) <= kDoorTolerance &&
                     std::abs(to_b.dot(across)) <= kDoorTolerance &&
                     std::min(end, length) - std::max(begin, 0.0) > kMinLength;
  if (!opens) {
    rest->push_back(wall);
    return false;
  }
  if (begin > kMinLength) {
    rest->push_back(
        {wall.a, wall.a + begin * along, wall.half_thickness_m, wall.overhang_a_m, 0.0});
  }
  if (end < length - kMinLength) {
    rest->push_back({wall.a + end * along, wall.b, wall.half_thickness_m, 0.0, wall.overhang_b_m});
  }
  return true;
}

}  // namespace plumbline
