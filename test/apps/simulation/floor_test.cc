#include "plumbline/apps/simulation/floor.h"

#include <gtest/gtest.h>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// 16 m x 16 m, all rooms alike and empty. Corridors at y = 4 and 12, cross corridors at x = 4 and
// 12, all 2 m wide; five rooms of 3.2 m along each outer side.
FloorStyle Plain() {
  FloorStyle style;
  style.block_widths_m = {3.0, 6.0, 3.0};
  for (double& depth : style.row_depths_m) depth = 3.0;
  style.corridor_width_m = style.cross_corridor_width_m = 2.0;
  style.room_width_m = 3.0;
  style.drive_length_m = 40.0;
  return style;
}

double PathLength(const Building& building) {
  double length = 0.0;
  for (std::size_t i = 1; i < building.path.size(); ++i) {
    length += (building.path[i].position - building.path[i - 1].position).norm();
  }
  return length;
}

TEST(FloorTest, SurfacesLieWhereTheStyleSays) {
  const World world(MakeFloor(Plain(), 1));
  // Through the door of the third room onto the outer wall, 0.3 m thick.
  EXPECT_NEAR(world.CastRay({8.0, 4.0}, -kPi / 2), 3.85, 1e-12);
  EXPECT_NEAR(world.CastRay({6.4, 4.0}, -kPi / 2), 0.94, 1e-12);
  EXPECT_NEAR(world.CastRay({1.0, 4.0}, 0.0), 14.85, 1e-12);
  EXPECT_NEAR(world.CastRay({4.0, 8.0}, 0.0), 0.94, 1e-12);
  // Through the door of a room of the core onto the wall between its rows, 0.1 m thick.
  EXPECT_NEAR(world.CastRay({6.5, 4.0}, kPi / 2), 3.95, 1e-12);
  EXPECT_NEAR(world.CastRay({6.5, 12.0}, -kPi / 2), 3.95, 1e-12);
  // A partition between two rooms of the northern side.
  EXPECT_NEAR(world.CastRay({8.0, 14.0}, 0.0), 1.55, 1e-12);
}

TEST(FloorTest, DriveGoesOnUntilItHasClosedALoopAndIsLongEnough) {
  FloorStyle style = Plain();
  // 3 m to the first crossing, then 8 m from one to the next: 35 m close the loop.
  EXPECT_NEAR(PathLength(MakeFloor(style, 1)), 43.0, 1e-12);
  style.drive_length_m = 1.0;
  EXPECT_NEAR(PathLength(MakeFloor(style, 1)), 35.0, 1e-12);
  // Into rooms as well: 2.2 m or 2.8 m from the corridor's middle to theirs, and back.
  style.visit_probability = 1.0;
  const double visits_m = PathLength(MakeFloor(style, 1)) - 35.0;
  EXPECT_NEAR(visits_m, 2 * 2 * 2.8, 1e-12);
}

TEST(FloorTest, CoreAndNichesLeaveNoRoomToVisit) {
  FloorStyle style = Plain();
  for (double& depth : style.row_depths_m) depth = 0.5;
  style.core_depth_m = 5.0;
  style.visit_probability = 1.0;
  const Building building = MakeFloor(style, 1);
  EXPECT_NEAR(PathLength(building), 43.0, 1e-12);
  // Corridors at y = 1.5 and 9.5; the niche of the core ends at its back wall.
  EXPECT_NEAR(World(building).CastRay({6.5, 1.5}, kPi / 2), 1.45, 1e-12);
}

}  // namespace
}  // namespace plumbline
