#ifndef PLUMBLINE_APPS_SIMULATION_FLOOR_PLAN_H_
#define PLUMBLINE_APPS_SIMULATION_FLOOR_PLAN_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/apps/simulation/world.h"
#include "plumbline/core/pose2.h"

namespace plumbline {

/// The drawing of a floor, from which the surfaces of a building follow. Lengths in m, world frame.
///
/// A wall is a solid bar with two faces and two ends. It reaches half its thickness beyond either
/// end of its centre line, so that walls which meet close the corner; a door cuts it square.
class FloorPlan {
 public:
  /// Two points closer than this are one [m].
  static constexpr double kMinLength = 1e-6;

  /// The centre line runs from a to b, which differ.
  void AddWall(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double thickness_m);

  /// Four walls: a rectangle given by two opposite corners, which differ in x and in y.
  void AddRoom(const Eigen::Vector2d& a, const Eigen::Vector2d& c, double thickness_m);

  /// Opens every wall drawn so far that runs along the segment from a to b, and hangs a sliding
  /// door there. Returns whether there is such a wall.
  bool CutDoor(const Eigen::Vector2d& a, const Eigen::Vector2d& b);

  /// A rectangle around the origin of its frame, `size` along the axes.
  void AddBox(const Pose2& world_from_box, const Eigen::Vector2d& size);

  void AddDisc(const Eigen::Vector2d& center, double radius_m);

  bool empty() const { return walls_.empty() && furniture_.empty() && discs_.empty(); }

  /// Puts the surfaces of all that is drawn into a building and leaves its name and path alone.
  void Furnish(Building* building) const;

 private:
  struct Wall {
    Eigen::Vector2d a, b;  // of the centre line
    double half_thickness_m;
    double overhang_a_m, overhang_b_m;  // how far the bar reaches beyond a and b
  };

  static bool CutWall(const Eigen::Vector2d& door_a, const Eigen::Vector2d& door_b,
                      const Wall& wall, std::vector<Wall>* rest);

  std::vector<Wall> walls_;
  std::vector<Face> furniture_;
  std::vector<Disc> discs_;
  std::vector<Face> doors_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_FLOOR_PLAN_H_
