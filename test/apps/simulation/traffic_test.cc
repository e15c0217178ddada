#include "plumbline/apps/simulation/traffic.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/simulator.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

// A corridor with a door in its southern wall, driven through from west to east.
Building Corridor() {
  Building building;
  building.faces = {{{0, -1}, {20, -1}}, {{0, 1}, {20, 1}}};
  building.doors = {{{9.5, -1}, {10.5, -1}}};
  building.path = {{{1, 0}, 1}, {{19, 0}, 2}};
  return building;
}

Drive PlanDrive(const Building& building) {
  Drive drive;
  EXPECT_TRUE(Drive::Plan(World(building), DriveOptions(), &drive).ok());
  return drive;
}

TEST(TrafficTest, PeopleWalkAroundTheRobotAndKeepOffIt) {
  const Building building = Corridor();
  const Drive drive = PlanDrive(building);
  TrafficOptions options;
  options.num_people = 10;
  const Traffic traffic(building, drive, options, 1);
  std::size_t num_seen = 0;
  for (double t = 0.0; t < drive.duration_s(); t += 0.5) {
    const Vector2d robot = drive.WorldFromRobot(t).translation();
    const World moving = traffic.At(t, robot);
    EXPECT_TRUE(moving.building().faces.empty());
    for (const Disc& person : moving.building().discs) {
      const double distance = (person.center - robot).norm();
      EXPECT_GE(distance - person.radius_m, 0.5);
      EXPECT_LE(distance, 4.5);
      ++num_seen;
    }
  }
  EXPECT_GT(num_seen, 200u);
}

TEST(TrafficTest, TheSeedDecides) {
  const Building building = Corridor();
  const Drive drive = PlanDrive(building);
  const Vector2d robot = drive.WorldFromRobot(10.0).translation();
  const auto first_person = [&](std::uint64_t seed) {
    const World moving = Traffic(building, drive, {10, false}, seed).At(10.0, robot);
    return moving.building().discs.front().center;
  };
  EXPECT_EQ(first_person(1), first_person(1));
  EXPECT_NE(first_person(1), first_person(2));
}

TEST(TrafficTest, DoorsShutAndOpenButNotInTheRobotsFace) {
  const Building building = Corridor();
  const Drive drive = PlanDrive(building);
  const Traffic traffic(building, drive, {0, true}, 1);
  int num_shut = 0, num_open = 0;
  for (double t = 0.0; t < 300.0; t += 1.0) {
    const std::size_t num_faces = traffic.At(t, {1, 0}).building().faces.size();
    (num_faces == 1 ? num_shut : num_open) += 1;
    EXPECT_TRUE(traffic.At(t, {10, 0}).building().faces.empty());
  }
  EXPECT_GT(num_shut, 50);
  EXPECT_GT(num_open, 50);
  EXPECT_TRUE(Traffic(building, drive, {10, false}, 1).At(10.0, {1, 0}).building().faces.empty());
}

TEST(TrafficTest, RefusesANegativeNumberOfPeople) {
  SimulationOptions options;
  options.traffic.num_people = -1;
  std::string error;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_NE(error.find("traffic.num_people"), std::string::npos) << error;
}

}  // namespace
}  // namespace plumbline
