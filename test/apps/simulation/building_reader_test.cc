#include "plumbline/apps/simulation/building_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "plumbline/apps/simulation/drive.h"
#include "plumbline/core/angle.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

Status Read(const std::string& content, Building* building) {
  const std::string path = TempFolder() + "b.world";
  WriteFile(path, content);
  return ReadBuilding(path, building);
}

std::string ErrorOf(const std::string& content) {
  Building building;
  const Status status = Read(content, &building);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(building.faces.empty());
  return status.message();
}

World WorldOf(const std::string& content) {
  Building building;
  const Status status = Read(content, &building);
  EXPECT_TRUE(status.ok()) << status.message();
  return World(building);
}

TEST(BuildingReaderTest, WallHasTwoFacesAndReachesBeyondItsEnds) {
  const World world = WorldOf("thickness 0.2\nwall 0 0 4 0\n");
  EXPECT_EQ(world.building().faces.size(), 4u);
  EXPECT_NEAR(world.CastRay({2.0, 3.0}, -kPi / 2), 2.9, 1e-12);
  EXPECT_NEAR(world.CastRay({2.0, -3.0}, kPi / 2), 2.9, 1e-12);
  EXPECT_NEAR(world.CastRay({5.0, 0.0}, -kPi), 0.9, 1e-12);
}

TEST(BuildingReaderTest, RoomHasClosedCornersAndTheDefaultThickness) {
  const World world = WorldOf("  room 1 1 5 4   # two opposite corners\r\n\n");
  EXPECT_NEAR(world.CastRay({2.0, 2.0}, 0.0), 2.95, 1e-12);
  EXPECT_NEAR(world.CastRay({2.0, 2.0}, kPi), 0.95, 1e-12);
  EXPECT_NEAR(world.CastRay({0.0, 0.0}, kPi / 4), 0.95 * std::sqrt(2.0), 1e-12);
}

TEST(BuildingReaderTest, DoorOpensEveryWallOfTheFileAlongItsSegment) {
  // Two rooms share the wall x = 4, which is therefore there twice; the second one comes last.
  const World world = WorldOf("room 0 0 4 3\ndoor 4 1 4 2\nroom 4 0 8 3\n");
  EXPECT_NEAR(world.CastRay({2.0, 1.5}, 0.0), 5.95, 1e-12);
  EXPECT_NEAR(world.CastRay({2.0, 0.99}, 0.0), 1.95, 1e-12);
  EXPECT_NEAR(world.CastRay({2.0, 2.01}, 0.0), 1.95, 1e-12);
  EXPECT_NEAR(world.CastRay({4.0, 1.5}, kPi / 2), 0.5, 1e-12);  // the frame, cut square
}

TEST(BuildingReaderTest, DoorOpensASlantedWall) {
  const World world = WorldOf("wall 0 0 3 4\ndoor 0.9 1.2 1.5 2.0\n");
  EXPECT_EQ(world.CastRay({1.2 - 0.8, 1.6 + 0.6}, std::atan2(-0.6, 0.8)),
            std::numeric_limits<double>::infinity());
  EXPECT_NEAR(world.CastRay({2.4 - 0.8, 3.2 + 0.6}, std::atan2(-0.6, 0.8)), 0.95, 1e-12);
}

TEST(BuildingReaderTest, BoxAndCircle) {
  const World world = WorldOf("box 2 1 2 1 90\ncircle 6 1 0.5\n");
  EXPECT_NEAR(world.CastRay({0.0, 1.0}, 0.0), 1.5, 1e-12);
  EXPECT_NEAR(world.CastRay({2.0, -2.0}, kPi / 2), 2.0, 1e-12);
  EXPECT_NEAR(world.CastRay({4.0, 1.0}, 0.0), 1.5, 1e-12);
}

TEST(BuildingReaderTest, PathKeepsOrderAndLines) {
  const World world = WorldOf("circle 9 9 1\npath 1 2\n# ...\npath 3 4\n");
  const std::vector<Waypoint>& path = world.building().path;
  ASSERT_EQ(path.size(), 2u);
  EXPECT_EQ(path[1].position, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(path[0].line, 2u);
  EXPECT_EQ(path[1].line, 4u);
}

TEST(BuildingReaderTest, ErrorsNameFileLineAndField) {
  EXPECT_THAT(ErrorOf("# a\nwall 0 0 4 x\n"), HasSubstr("b.world:2: wall field 'y2': 'x'"));
  EXPECT_THAT(ErrorOf("room 0 0 4\n"), HasSubstr("b.world:1: room field 'y2': is missing"));
  EXPECT_THAT(ErrorOf("wall 0 0 4 4 4\n"), HasSubstr("b.world:1: wall field 'end of line': '4'"));
  EXPECT_THAT(ErrorOf("\n\nwal 0 0 4 4\n"), HasSubstr("b.world:3: unknown keyword 'wal'"));
  EXPECT_THAT(ErrorOf("wall 1 1 1 1\n"), HasSubstr("b.world:1: wall field 'x2'"));
  EXPECT_THAT(ErrorOf("room 0 0 0 4\n"), HasSubstr("b.world:1: room field 'x2'"));
  EXPECT_THAT(ErrorOf("thickness 0\n"), HasSubstr("b.world:1: thickness field 't': '0'"));
  EXPECT_THAT(ErrorOf("box 0 0 1 -1 0\n"), HasSubstr("b.world:1: box field 'depth': '-1'"));
  EXPECT_THAT(ErrorOf("circle 0 0 inf\n"), HasSubstr("b.world:1: circle field 'radius': 'inf'"));
  EXPECT_THAT(ErrorOf("path 0 0\npath 0 0\n"), HasSubstr("b.world:2: path field 'x'"));
}

TEST(BuildingReaderTest, DegenerateBuildingsAreRefused) {
  EXPECT_THAT(ErrorOf("wall 0 0 4 0\n\ndoor 1 0.5 2 0.5\n"), HasSubstr("b.world:3: door: no wall"));
  EXPECT_THAT(ErrorOf("wall 0 0 4 0\ndoor 5 0 6 0\n"), HasSubstr("b.world:2: door: no wall"));
  EXPECT_THAT(ErrorOf("path 0 0\npath 1 0\n"), EndsWith("b.world: no wall, room, box or circle"));
  EXPECT_THAT(ErrorOf("circle 5 5 1\npath 0 0\n"), HasSubstr("b.world:2: path: "));
  Building building;
  EXPECT_EQ(ReadBuilding(TempFolder() + "none.world", &building).code(), StatusCode::kNotFound);
}

TEST(BuildingReaderTest, EmbeddedBuildingCanBeDriven) {
  Building building;
  Status status = ReadBuilding(PLUMBLINE_WORLD, &building);
  ASSERT_TRUE(status.ok()) << status.message();
  Drive drive;
  status = Drive::Plan(World(building), DriveOptions(), &drive);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_GT(drive.length_m(), 60.0);
  EXPECT_LT(drive.length_m(), 90.0);
}

}  // namespace
}  // namespace plumbline
