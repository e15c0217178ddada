#include "plumbline/apps/simulation/special_floors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// Directions of the longer walls, modulo a right angle, to 1 degree.
std::set<int> WallDirections(const Building& building) {
  std::set<int> directions;
  for (const Face& face : building.faces) {
    const Eigen::Vector2d along = face.b - face.a;
    if (along.norm() < 1.0) continue;
    const double degrees = RadToDeg(std::atan2(along.y(), along.x()));
    directions.insert(static_cast<int>(std::lround(degrees + 360.0)) % 90);
  }
  return directions;
}

TEST(SpecialFloorsTest, FewWallsOfARingAreAtRightAngles) {
  NoiseSource round_source(1, 2), slanted_source(1, 2);
  EXPECT_GT(WallDirections(MakeRing({32, 0.0}, &round_source)).size(), 10u);
  EXPECT_GT(WallDirections(MakeRing({7, 0.5}, &slanted_source)).size(), 5u);
}

TEST(SpecialFloorsTest, ARingIsClosedAndHasDoors) {
  NoiseSource source(3, 2);
  const Building ring = MakeRing({32, 0.0}, &source);
  EXPECT_GE(ring.doors.size(), 8u);
  const World world(ring);
  for (double bearing = 0.0; bearing < 2.0 * kPi; bearing += 0.01) {
    EXPECT_LT(world.CastRay(ring.path.front().position, bearing), 30.0);
  }
}

TEST(SpecialFloorsTest, MostOfAHallIsFarAway) {
  NoiseSource source(1, 2);
  const World world(MakeHall(&source));
  int num_far = 0, num_rays = 0;
  for (const Waypoint& waypoint : world.building().path) {
    for (double bearing = 0.0; bearing < 2.0 * kPi; bearing += 0.02, ++num_rays) {
      const double range = world.CastRay(waypoint.position, bearing);
      EXPECT_LT(range, 50.0);
      num_far += range > 8.0 ? 1 : 0;
    }
  }
  EXPECT_GT(num_far, num_rays / 2);
}

}  // namespace
}  // namespace plumbline
