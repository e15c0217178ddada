#include "plumbline/apps/simulation/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace plumbline {
namespace {

using Eigen::Vector2d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// About half the width of a corridor: a ray visits few cells, and a cell holds few surfaces.
constexpr double kCellSize = 0.5;
// Bounds the grid's memory in a vast world.
constexpr double kMaxCells = 1e6;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double DistanceToFace(const Face& face, const Vector2d& point) {
  const Vector2d along = face.b - face.a;
  const double share = along.dot(point - face.a) / along.squaredNorm();
  return (point - face.a - std::clamp(share, 0.0, 1.0) * along).norm();
}

double DistanceToDisc(const Disc& disc, const Vector2d& point) {
  return std::abs((point - disc.center).norm() - disc.radius_m);
}

double IntersectFace(const Face& face, const Vector2d& origin, const Vector2d& direction) {
  // A hair's breadth beyond both ends, so that no ray slips through a corner.
  constexpr double kSlack = 1e-12;
  const Vector2d along = face.b - face.a, to_face = face.a - origin;
  const double determinant = Cross(direction, along);
  if (determinant == 0.0) return kInfinity;
  const double distance = Cross(to_face, along) / determinant;
  const double share = Cross(to_face, direction) / determinant;
  const bool hit = distance >= 0.0 && share >= -kSlack && share <= 1.0 + kSlack;
  if (!hit) return kInfinity;
  return distance;
}

double IntersectDisc(const Disc& disc, const Vector2d& origin, const Vector2d& direction) {
  const Vector2d to_center = disc.center - origin;
  const double along = to_center.dot(direction), across = Cross(direction, to_center);
  const double half_chord_squared = disc.radius_m * disc.radius_m - across * across;
  if (half_chord_squared < 0.0) return kInfinity;
  const double half_chord = std::sqrt(half_chord_squared);
  if (along - half_chord >= 0.0) return along - half_chord;
  return along + half_chord >= 0.0 ? along + half_chord : kInfinity;
}

}  // namespace

World::World(Building building) : building_(std::move(building)) { LayGrid(); }

RayHit World::TraceRay(const Vector2d& origin, double bearing_rad) const {
  if (num_surfaces() == 0) return RayHit();
  const Vector2d direction(std::cos(bearing_rad), std::sin(bearing_rad));
  // The stretch of the ray inside the grid.
  double enter = 0.0, leave = kInfinity;
  for (int axis = 0; axis < 2; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < low_[axis] || origin[axis] > high_[axis]) return RayHit();
      continue;
    }
    const double to_low = (low_[axis] - origin[axis]) / direction[axis];
    const double to_high = (high_[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(to_low, to_high));
    leave = std::min(leave, std::max(to_low, to_high));
  }
  return enter <= leave ? WalkGrid(origin, direction, enter) : RayHit();
}

RayHit World::WalkGrid(const Vector2d& origin, const Vector2d& direction, double enter_m) const {
  int cell[2], step[2];
  double next_border[2], cell_length[2];  // along the ray
  for (int axis = 0; axis < 2; ++axis) {
    cell[axis] = CellOf(origin[axis] + enter_m * direction[axis], axis);
    step[axis] = direction[axis] >= 0.0 ? 1 : -1;
    const double border = low_[axis] + (cell[axis] + (step[axis] > 0 ? 1 : 0)) * cell_size_m_;
    const bool moves = direction[axis] != 0.0;
    next_border[axis] = moves ? (border - origin[axis]) / direction[axis] : kInfinity;
    cell_length[axis] = moves ? cell_size_m_ / std::abs(direction[axis]) : kInfinity;
  }
  RayHit nearest;
  while (cell[0] >= 0 && cell[0] < size_[0] && cell[1] >= 0 && cell[1] < size_[1]) {
    const int index = cell[1] * size_[0] + cell[0];
    for (int i = first_[index]; i < first_[index + 1]; ++i) {
      const int id = surfaces_[i];
      const double distance = Intersect(id, origin, direction);
      if (distance >= nearest.distance_m) continue;
      nearest = {distance, id < num_faces() ? &building_.faces[id] : nullptr};
    }
    const int axis = next_border[0] < next_border[1] ? 0 : 1;
    if (nearest.distance_m <= next_border[axis]) break;
    next_border[axis] += cell_length[axis];
    cell[axis] += step[axis];
  }
  return nearest;
}

double World::Clearance(const Vector2d& point) const {
  double nearest = kInfinity;
  for (int id = 0; id < num_surfaces(); ++id) nearest = std::min(nearest, DistanceTo(id, point));
  return nearest;
}

void World::LayGrid() {
  if (num_surfaces() == 0) return;
  low_.setConstant(kInfinity);
  high_.setConstant(-kInfinity);
  for (const Face& face : building_.faces) {
    low_ = low_.cwiseMin(face.a.cwiseMin(face.b));
    high_ = high_.cwiseMax(face.a.cwiseMax(face.b));
  }
  for (const Disc& disc : building_.discs) {
    low_ = low_.cwiseMin((disc.center.array() - disc.radius_m).matrix());
    high_ = high_.cwiseMax((disc.center.array() + disc.radius_m).matrix());
  }
  cell_size_m_ = std::max(kCellSize, (high_ - low_).maxCoeff() / std::sqrt(kMaxCells));
  for (int axis = 0; axis < 2; ++axis) {
    size_[axis] = 1 + static_cast<int>((high_[axis] - low_[axis]) / cell_size_m_);
  }

  std::vector<std::vector<int>> cells(static_cast<std::size_t>(size_[0]) * size_[1]);
  int id = 0;
  for (const Face& face : building_.faces) {
    Rasterise(id++, face.a.cwiseMin(face.b), face.a.cwiseMax(face.b), &cells);
  }
  for (const Disc& disc : building_.discs) {
    const Vector2d reach = Vector2d::Constant(disc.radius_m);
    Rasterise(id++, disc.center - reach, disc.center + reach, &cells);
  }
  first_.push_back(0);
  for (const std::vector<int>& ids : cells) {
    surfaces_.insert(surfaces_.end(), ids.begin(), ids.end());
    first_.push_back(static_cast<int>(surfaces_.size()));
  }
}

void World::Rasterise(int id, const Vector2d& low, const Vector2d& high,
                      std::vector<std::vector<int>>* cells) const {
  // Half the diagonal of a cell, and a margin for surfaces that lie on a border between cells.
  const double reach = cell_size_m_ * (std::sqrt(0.5) + 1e-6);
  constexpr double kMargin = 1e-6;
  for (int y = CellOf(low.y() - kMargin, 1); y <= CellOf(high.y() + kMargin, 1); ++y) {
    for (int x = CellOf(low.x() - kMargin, 0); x <= CellOf(high.x() + kMargin, 0); ++x) {
      const Vector2d center = low_ + cell_size_m_ * Vector2d(x + 0.5, y + 0.5);
      if (DistanceTo(id, center) <= reach) (*cells)[y * size_[0] + x].push_back(id);
    }
  }
}

int World::CellOf(double coordinate_m, int axis) const {
  const double cell = std::floor((coordinate_m - low_[axis]) / cell_size_m_);
  return static_cast<int>(std::clamp(cell, 0.0, size_[axis] - 1.0));
}

double World::DistanceTo(int id, const Vector2d& point) const {
  return id < num_faces() ? DistanceToFace(building_.faces[id], point)
                          : DistanceToDisc(building_.discs[id - num_faces()], point);
}

double World::Intersect(int id, const Vector2d& origin, const Vector2d& direction) const {
  return id < num_faces() ? IntersectFace(building_.faces[id], origin, direction)
                          : IntersectDisc(building_.discs[id - num_faces()], origin, direction);
}

}  // namespace plumbline
