#include "plumbline/apps/simulation/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where a ray meets the building, by another road than the library's: all surfaces are turned into
// a frame whose x axis is the ray.
double CastRayByBruteForce(const Building& building, const Vector2d& origin, double bearing_rad) {
  const double c = std::cos(bearing_rad), s = std::sin(bearing_rad);
  const auto in_ray_frame = [&](const Vector2d& p) {
    const Vector2d d = p - origin;
    return Vector2d(c * d.x() + s * d.y(), c * d.y() - s * d.x());
  };
  double nearest = kInfinity;
  for (const Face& face : building.faces) {
    const Vector2d a = in_ray_frame(face.a), b = in_ray_frame(face.b);
    if ((a.y() > 0.0) == (b.y() > 0.0)) continue;
    const double x = a.x() + (b.x() - a.x()) * a.y() / (a.y() - b.y());
    if (x >= 0.0) nearest = std::min(nearest, x);
  }
  for (const Disc& disc : building.discs) {
    const Vector2d center = in_ray_frame(disc.center);
    if (std::abs(center.y()) > disc.radius_m) continue;
    const double half = std::sqrt(disc.radius_m * disc.radius_m - center.y() * center.y());
    for (const double x : {center.x() - half, center.x() + half}) {
      if (x >= 0.0) nearest = std::min(nearest, x);
    }
  }
  return nearest;
}

Building SquareRoom() {
  Building building;
  building.faces = {{{0, 0}, {4, 0}}, {{4, 0}, {4, 4}}, {{4, 4}, {0, 4}}, {{0, 4}, {0, 0}}};
  return building;
}

TEST(WorldTest, RangesInASquareRoomAreKnownByHand) {
  const World world(SquareRoom());
  const Vector2d origin(1.0, 2.0);
  EXPECT_NEAR(world.CastRay(origin, 0.0), 3.0, 1e-12);
  EXPECT_NEAR(world.CastRay(origin, kPi / 2), 2.0, 1e-12);
  EXPECT_NEAR(world.CastRay(origin, kPi), 1.0, 1e-12);
  EXPECT_NEAR(world.CastRay(origin, kPi / 4), 2.0 * std::sqrt(2.0), 1e-12);  // meets the top wall
  EXPECT_NEAR(world.CastRay(origin, std::atan2(2.0, 3.0)), std::sqrt(13.0), 1e-12);  // the corner
  // From outside.
  EXPECT_NEAR(world.CastRay({-3.0, 1.0}, 0.0), 3.0, 1e-12);
  EXPECT_EQ(world.CastRay({-3.0, 1.0}, kPi), kInfinity);
  EXPECT_EQ(world.CastRay({-3.0, 5.0}, 0.0), kInfinity);
}

TEST(WorldTest, DiscIsMetOnTheNearSideAndFromInsideOnTheFarSide) {
  Building building;
  building.discs = {{{5.0, 0.0}, 1.0}};
  const World world(building);
  EXPECT_NEAR(world.CastRay({0.0, 0.0}, 0.0), 4.0, 1e-12);
  EXPECT_NEAR(world.CastRay({4.5, 0.0}, 0.0), 1.5, 1e-12);
  EXPECT_NEAR(world.CastRay({0.0, 0.6}, 0.0), 4.2, 1e-12);
  EXPECT_EQ(world.CastRay({0.0, 1.01}, 0.0), kInfinity);
}

TEST(WorldTest, ClearanceIsTheDistanceToTheNearestSurface) {
  Building building = SquareRoom();
  building.discs = {{{2.0, 2.0}, 0.5}};
  const World world(building);
  EXPECT_NEAR(world.Clearance({0.25, 2.0}), 0.25, 1e-12);
  EXPECT_NEAR(world.Clearance({1.25, 2.0}), 0.25, 1e-12);
  EXPECT_NEAR(world.Clearance({-3.0, -4.0}), 5.0, 1e-12);  // beyond the ends of both walls
}

TEST(WorldTest, EmptyWorldReflectsNothing) {
  const World world{Building()};
  EXPECT_EQ(world.CastRay({1.0, 2.0}, 0.3), kInfinity);
  EXPECT_EQ(world.Clearance({1.0, 2.0}), kInfinity);
}

TEST(WorldTest, GridAgreesWithBruteForce) {
  NoiseSource random(1, 0);
  const auto anywhere = [&](double low, double high) {
    const double x = low + (high - low) * random.Uniform();
    return Vector2d(x, low + (high - low) * random.Uniform());
  };
  Building building;
  for (int i = 0; i < 80; ++i) {
    const Vector2d a = anywhere(0.0, 20.0);
    building.faces.push_back({a, a + anywhere(-3.0, 3.0)});
  }
  for (int i = 0; i < 20; ++i) {
    building.discs.push_back({anywhere(0.0, 20.0), 0.05 + random.Uniform()});
  }
  const World world(building);
  int num_hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector2d origin = anywhere(-5.0, 25.0);  // some outside of the grid
    const double bearing = 2.0 * kPi * random.Uniform();
    const double expected = CastRayByBruteForce(building, origin, bearing);
    const double actual = world.CastRay(origin, bearing);
    if (std::isfinite(expected)) {
      ++num_hits;
      ASSERT_NEAR(actual, expected, 1e-8) << "ray " << i;
    } else {
      ASSERT_EQ(actual, expected) << "ray " << i;
    }
  }
  EXPECT_GT(num_hits, 10000);
}

TEST(WorldTest, SurfacesOnTheBordersOfCellsAreMet) {
  // Walls every half metre, the size of a cell, and rays along the axes through the cells' corners.
  Building building;
  for (int i = 0; i <= 8; ++i) building.faces.push_back({{0.5 * i, 0.0}, {0.5 * i, 4.0}});
  const World world(building);
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j <= 8; ++j) {
      const Vector2d origin(0.5 * i + 0.2, 0.5 * j);
      EXPECT_NEAR(world.CastRay(origin, 0.0), 0.3, 1e-12) << i << ' ' << j;
      EXPECT_NEAR(world.CastRay(origin, -kPi), 0.2, 1e-12) << i << ' ' << j;
    }
  }
}

}  // namespace
}  // namespace plumbline
