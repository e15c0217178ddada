#include "plumbline/apps/simulation/building_generator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "plumbline/apps/simulation/drive.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

std::vector<Vector2d> CornersOf(const Building& building) {
  std::vector<Vector2d> corners;
  for (const Face& face : building.faces) corners.insert(corners.end(), {face.a, face.b});
  for (const Disc& disc : building.discs) corners.push_back(disc.center);
  for (const Waypoint& waypoint : building.path) corners.push_back(waypoint.position);
  return corners;
}

// Plans the drives of the seeds from 1 on and returns the shortest and the longest [m].
std::pair<double, double> LengthsOfDrives(BuildingKind kind, int num_seeds) {
  std::pair<double, double> range(1e9, 0.0);
  for (int seed = 1; seed <= num_seeds; ++seed) {
    Drive drive;
    const Status status = Drive::Plan(World(GenerateBuilding(kind, seed)), DriveOptions(), &drive);
    EXPECT_TRUE(status.ok()) << status.message();
    range.first = std::min(range.first, drive.length_m());
    range.second = std::max(range.second, drive.length_m());
  }
  return range;
}

// Distances between the eastern jambs of neighbouring doors on the south side of the southern
// corridor, to 1 cm.
std::vector<double> DoorPitches(const Building& building) {
  const World world(building);
  const Vector2d start = building.path[0].position;
  const double to_east = world.CastRay(start, 0.0);
  const double to_wall = world.CastRay(start + Vector2d(-0.9, 0.0), -kPi / 2);
  std::vector<double> pitches;
  double last_jamb = NAN;
  bool in_door = false;
  for (double x = -0.9; x < to_east; x += 0.01) {
    const bool open = world.CastRay(start + Vector2d(x, 0.0), -kPi / 2) > to_wall + 0.3;
    if (in_door && !open) {
      if (!std::isnan(last_jamb)) pitches.push_back(x - last_jamb);
      last_jamb = x;
    }
    in_door = open;
  }
  return pitches;
}

TEST(BuildingGeneratorTest, NamesOfKindsAreReadBack) {
  for (const BuildingKind kind : kBuildingKinds) {
    BuildingKind read = BuildingKind::kRandom;
    EXPECT_TRUE(FromString(ToString(kind), &read));
    EXPECT_EQ(read, kind);
  }
  BuildingKind kind;
  EXPECT_FALSE(FromString("castle", &kind));
}

TEST(BuildingGeneratorTest, TheSeedDecidesTheBuilding) {
  for (const BuildingKind kind : kBuildingKinds) {
    const Building building = GenerateBuilding(kind, 7);
    EXPECT_EQ(CornersOf(building), CornersOf(GenerateBuilding(kind, 7)));
    EXPECT_NE(CornersOf(building), CornersOf(GenerateBuilding(kind, 8)));
  }
}

TEST(BuildingGeneratorTest, TheRobotTouchesNothing) {
  for (const BuildingKind kind :
       {BuildingKind::kRandom, BuildingKind::kRepetitive, BuildingKind::kHall, BuildingKind::kRound,
        BuildingKind::kSlanted}) {
    const auto [shortest, longest] = LengthsOfDrives(kind, 200);
    EXPECT_GT(shortest, 60.0);
    EXPECT_LT(longest, 150.0);
  }
  const auto [shortest, longest] = LengthsOfDrives(BuildingKind::kLongCorridor, 1);
  EXPECT_GT(shortest, 1900.0);
  EXPECT_LT(longest, 2200.0);
}

TEST(BuildingGeneratorTest, LargeBuildingsGrowWithTheDrive) {
  std::vector<double> widths;
  for (const double length_m : {50.0, 1000.0, 4000.0}) {
    const Building building = GenerateLargeBuilding(length_m, 1);
    Drive drive;
    const Status status = Drive::Plan(World(building), DriveOptions(), &drive);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_GT(drive.length_m(), 0.95 * length_m);  // curves cut the corners
    EXPECT_LT(drive.length_m(), length_m + 60.0);
    const auto is_west = [](const Vector2d& a, const Vector2d& b) { return a.x() < b.x(); };
    const std::vector<Vector2d> corners = CornersOf(building);
    widths.push_back(std::max_element(corners.begin(), corners.end(), is_west)->x());
    double east_m = 0.0;  // of the path
    for (const Waypoint& waypoint : building.path) east_m = std::max(east_m, waypoint.position.x());
    EXPECT_GT(east_m, widths.back() - 8.0);
  }
  EXPECT_LT(widths[0], 35.0);
  EXPECT_NEAR(widths[2] / widths[1], 4.0, 0.4);
}

TEST(BuildingGeneratorTest, RepetitiveDoorsKeepToOnePitch) {
  const std::vector<double> pitches = DoorPitches(GenerateBuilding(BuildingKind::kRepetitive, 1));
  ASSERT_GE(pitches.size(), 4u);
  for (const double pitch : pitches) EXPECT_NEAR(pitch, pitches[0], 0.015);
}

TEST(BuildingGeneratorTest, RandomDoorsDoNot) {
  const std::vector<double> pitches = DoorPitches(GenerateBuilding(BuildingKind::kRandom, 1));
  ASSERT_GE(pitches.size(), 3u);
  const auto [low, high] = std::minmax_element(pitches.begin(), pitches.end());
  EXPECT_GT(*high - *low, 0.3);
}

TEST(BuildingGeneratorTest, NichesOfTheLongCorridorAreFourMetresApart) {
  const std::vector<double> pitches = DoorPitches(GenerateBuilding(BuildingKind::kLongCorridor, 1));
  ASSERT_GT(pitches.size(), 55u);
  for (const double pitch : pitches) EXPECT_NEAR(pitch, pitches[0], 0.015);
  EXPECT_NEAR(pitches[0], 4.0, 0.1);
}

}  // namespace
}  // namespace plumbline
