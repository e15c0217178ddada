#ifndef PLUMBLINE_APPS_SIMULATION_WORLD_H_
#define PLUMBLINE_APPS_SIMULATION_WORLD_H_

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace plumbline {

/// A straight piece of surface that reflects laser light, visible from both sides [m].
struct Face {
  Eigen::Vector2d a, b;
  bool is_glass = false;  ///< sends light back only where it is met head-on
};

/// A round surface: a pillar, a table.
struct Disc {
  Eigen::Vector2d center;  ///< [m]
  double radius_m = 0.0;
};

/// A point that the robot drives to.
struct Waypoint {
  Eigen::Vector2d position;  ///< [m]
  std::size_t line = 0;      ///< of the building's file, or its number in the path; for messages
};

/// A building's surfaces and the path through it, all in the world frame.
struct Building {
  std::string name;  ///< the file, or what it was made of; for messages
  std::vector<Face> faces;
  std::vector<Disc> discs;
  /// Leaves of sliding doors as they are when shut. They stand open, out of sight, unless a
  /// simulation has them move.
  std::vector<Face> doors;
  std::vector<Waypoint> path;  ///< in driving order
};

/// Where a ray ends.
struct RayHit {
  double distance_m = std::numeric_limits<double>::infinity();
  const Face* face = nullptr;  ///< of the world; null if it meets a disc, or nothing
};

/// A building with its surfaces sorted into a uniform grid, so that a ray meets only those on its
/// way. Immutable, and safe to read from several threads.
class World {
 public:
  explicit World(Building building);

  const Building& building() const { return building_; }

  /// The first surface from `origin` in the direction `bearing_rad` (counted from the world's x
  /// axis, counter-clockwise). From inside a disc the ray meets its far side. A face seen exactly
  /// edge-on is missed. Doors are not looked at.
  RayHit TraceRay(const Eigen::Vector2d& origin, double bearing_rad) const;

  /// The distance [m] to it; infinity if there is none.
  double CastRay(const Eigen::Vector2d& origin, double bearing_rad) const {
    return TraceRay(origin, bearing_rad).distance_m;
  }

  /// Distance [m] from `point` to the nearest surface; infinity in an empty world. Goes through all
  /// surfaces.
  double Clearance(const Eigen::Vector2d& point) const;

 private:
  void LayGrid();
  /// Lists the surface `id` in the cells between two corners that it may touch.
  void Rasterise(int id, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                 std::vector<std::vector<int>>* cells) const;
  /// From cell to cell along a ray that enters the grid after `enter_m` (Amanatides & Woo 1987).
  RayHit WalkGrid(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction,
                  double enter_m) const;
  int CellOf(double coordinate_m, int axis) const;

  int num_faces() const { return static_cast<int>(building_.faces.size()); }
  int num_surfaces() const { return num_faces() + static_cast<int>(building_.discs.size()); }
  double DistanceTo(int id, const Eigen::Vector2d& point) const;
  double Intersect(int id, const Eigen::Vector2d& origin, const Eigen::Vector2d& direction) const;

  Building building_;
  // A surface's id is its index in building_.faces, or that of a disc plus the number of faces.
  // Cell (x, y) holds surfaces_[first_[c]] .. surfaces_[first_[c + 1] - 1], c = y * size_[0] + x.
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero(), high_ = Eigen::Vector2d::Zero();
  double cell_size_m_ = 0.0;
  int size_[2] = {0, 0};
  std::vector<int> first_;
  std::vector<int> surfaces_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_WORLD_H_
