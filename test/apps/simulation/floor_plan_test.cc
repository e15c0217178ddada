#include "plumbline/apps/simulation/floor_plan.h"

#include <gtest/gtest.h>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

World WorldOf(const FloorPlan& plan) {
  Building building;
  plan.Furnish(&building);
  return World(building);
}

TEST(FloorPlanTest, WallsHaveTwoFacesAndDoorsCutThemSquare) {
  FloorPlan plan;
  EXPECT_TRUE(plan.empty());
  plan.AddWall({0, 0}, {10, 0}, 0.2);
  EXPECT_FALSE(plan.empty());
  EXPECT_FALSE(plan.CutDoor({4, 1}, {5, 1}));
  EXPECT_TRUE(plan.CutDoor({5, 0}, {4, 0}));
  const World world = WorldOf(plan);
  EXPECT_NEAR(world.CastRay({2, 3}, -kPi / 2), 2.9, 1e-12);
  EXPECT_NEAR(world.CastRay({2, -3}, kPi / 2), 2.9, 1e-12);
  EXPECT_NEAR(world.CastRay({4.5, 0}, kPi), 0.5, 1e-12);
  EXPECT_NEAR(world.CastRay({4.5, 0}, 0.0), 0.5, 1e-12);
  // The outer end reaches half the thickness beyond the centre line.
  EXPECT_NEAR(world.CastRay({12, 0}, kPi), 1.9, 1e-12);
}

TEST(FloorPlanTest, RoomsBoxesAndDiscs) {
  FloorPlan plan;
  plan.AddRoom({0, 0}, {8, 6}, 0.2);
  plan.AddBox(Pose2(4, 3, kPi / 2), {2.0, 1.0});
  plan.AddDisc({6, 1}, 0.5);
  const World world = WorldOf(plan);
  EXPECT_NEAR(world.CastRay({1, 3}, 0.0), 2.5, 1e-12);
  EXPECT_NEAR(world.CastRay({4, 1}, kPi / 2), 1.0, 1e-12);
  EXPECT_NEAR(world.CastRay({1, 1}, 0.0), 4.5, 1e-12);
  EXPECT_NEAR(world.CastRay({1, 5}, 0.0), 6.9, 1e-12);
}

}  // namespace
}  // namespace plumbline
