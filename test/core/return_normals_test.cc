#include "plumbline/core/return_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace plumbline {
namespace {

constexpr double kNoReturn = 0.0;

// Half-degree steps over 180 degrees, mounted off centre and a quarter turn to the left: what lies
// ahead of the laser lies to the left of the robot.
LaserModel HalfDegreeLaser() {
  LaserModel laser;
  laser.num_beams = 361;
  laser.first_bearing_rad = -0.5 * kPi;
  laser.bearing_step_rad = DegToRad(0.5);
  laser.max_range_m = 8.0;
  laser.robot_from_laser = Pose2(0.3, -0.2, 0.5 * kPi);
  return laser;
}

struct Normal {
  int beam;
  Eigen::Vector2d in_laser;
};

// Scans a scene given as range by beam, and returns the normals turned into the laser's frame.
std::vector<Normal> NormalsOf(const std::function<double(int beam, double bearing_rad)>& range) {
  SlamGraph graph;
  const LaserModel laser = HalfDegreeLaser();
  const int laser_id = graph.AddLaser(laser);
  const int pose_id = graph.AddPose(Pose2(-7.0, 40.0, 2.0), 0.0);
  std::vector<double> ranges;
  for (int b = 0; b < laser.num_beams; ++b) ranges.push_back(range(b, laser.Bearing(b)));
  graph.AddScan(pose_id, laser_id, ranges);

  ThreadPool pool(1);
  std::vector<ReturnNormal> in_robot;
  ExtendReturnNormals(graph, 0, ReturnNormalOptions(), &pool, &in_robot);
  EXPECT_EQ(in_robot.size(), graph.num_returns());
  std::vector<Normal> normals;
  for (std::size_t r = 0; r < in_robot.size(); ++r) {
    const Eigen::Vector2d n = in_robot[r].Direction();
    normals.push_back({graph.Beam(r), {n.y(), -n.x()}});
  }
  return normals;
}

// Distance along a beam to the wall at x = `distance_m` in the frame of the laser.
double WallAhead(double distance_m, double bearing_rad) {
  return distance_m / std::max(1e-9, std::cos(bearing_rad));
}

void ExpectNormal(const Normal& actual, const Eigen::Vector2d& expected) {
  EXPECT_LT((actual.in_laser - expected).norm(), 1e-5) << "beam " << actual.beam;
}

// All along a wall but for its two ends, which may have too few neighbours.
void ExpectWallNormals(const std::vector<Normal>& normals, const Eigen::Vector2d& expected) {
  for (std::size_t r = 1; r + 1 < normals.size(); ++r) ExpectNormal(normals[r], expected);
}

void ExpectNone(const Normal& actual) {
  EXPECT_EQ(actual.in_laser.norm(), 0.0) << "beam " << actual.beam;
}

TEST(ReturnNormals, AWallFacesTheLaser) {
  const std::vector<Normal> normals =
      NormalsOf([](int, double bearing) { return WallAhead(2.0, bearing); });
  ASSERT_GT(normals.size(), 290u);  // Up to 75 degrees to either side.
  ExpectWallNormals(normals, {-1.0, 0.0});
}

TEST(ReturnNormals, ACornerKeepsItsTwoDirections) {
  // Walls x = 2 and y = 2, which meet on the bearing of 45 degrees.
  const std::vector<Normal> normals = NormalsOf([](int, double bearing) {
    return std::min(WallAhead(2.0, bearing), WallAhead(2.0, bearing - 0.5 * kPi));
  });
  int blended = 0;
  for (const Normal& normal : normals) {
    const double bearing = HalfDegreeLaser().Bearing(normal.beam);
    const double along_wall = 2.0 - 2.0 * std::min(std::tan(bearing), 1.0 / std::tan(bearing));
    if (bearing > 0.0 && along_wall < 0.12) {
      ++blended;
      EXPECT_LE(normal.in_laser.dot(BeamEnd(1.0, bearing)), 0.0) << "beam " << normal.beam;
    } else if (normal.beam != normals.front().beam) {
      ExpectNormal(normal,
                   bearing < 0.25 * kPi ? Eigen::Vector2d(-1.0, 0.0) : Eigen::Vector2d(0.0, -1.0));
    }
  }
  EXPECT_LT(blended, 10);
}

TEST(ReturnNormals, ARangeJumpTiltsNothing) {
  const std::vector<Normal> normals =
      NormalsOf([](int, double bearing) { return WallAhead(bearing < 0.0 ? 2.0 : 3.0, bearing); });
  for (const Normal& normal : normals) {
    if (normal.beam > 100 && normal.beam < 260) ExpectNormal(normal, {-1.0, 0.0});
  }
}

TEST(ReturnNormals, AnIsolatedReturnHasNone) {
  // A thin post in front of a wall, and a return with nothing beside it.
  const std::vector<Normal> normals = NormalsOf([](int beam, double bearing) {
    if (beam == 180) return 1.0;
    if (beam == 20) return 4.0;
    return beam > 100 && beam < 260 ? WallAhead(2.0, bearing) : kNoReturn;
  });
  ASSERT_EQ(normals.size(), 160u);
  for (const Normal& normal : normals) {
    if (normal.beam == 180 || normal.beam == 20) {
      ExpectNone(normal);
    } else {
      ExpectNormal(normal, {-1.0, 0.0});
    }
  }
}

TEST(ReturnNormals, AreThoseOfTheWallIfADriverDropsBeams) {
  const auto every = [](int step) {
    return NormalsOf([step](int beam, double bearing) {
      return beam % step == 0 && std::abs(bearing) < 1.0 ? WallAhead(1.0, bearing) : kNoReturn;
    });
  };
  ASSERT_GT(every(2).size(), 100u);
  ExpectWallNormals(every(2), {-1.0, 0.0});
  ASSERT_GT(every(4).size(), 50u);
  ExpectWallNormals(every(4), {-1.0, 0.0});
}

TEST(ReturnNormals, ABushHasNone) {
  // Ranges that jump by 6 cm from beam to beam, half a metre away.
  const std::vector<Normal> normals = NormalsOf([](int beam, double bearing) {
    return WallAhead(0.5, bearing) + (beam % 2 == 0 ? 0.03 : -0.03);
  });
  for (const Normal& normal : normals) {
    if (normal.beam > 150 && normal.beam < 210) ExpectNone(normal);
  }
}

TEST(ReturnNormals, SparseFarSurfaceTakesItsNextNeighbours) {
  // Neighbours are 5 cm apart straight ahead and 9 cm to the sides, beyond the window of 8 cm.
  const std::vector<Normal> normals =
      NormalsOf([](int, double bearing) { return WallAhead(6.0, bearing); });
  ASSERT_GT(normals.size(), 100u);
  ExpectWallNormals(normals, {-1.0, 0.0});
}

TEST(ReturnNormals, TheSameForAnyNumberOfThreads) {
  SlamGraph graph;
  const int laser_id = graph.AddLaser(HalfDegreeLaser());
  const int pose_id = graph.AddPose(Pose2(), 0.0);
  for (int scan = 0; scan < 200; ++scan) {
    std::vector<double> ranges;
    for (int b = 0; b < 361; ++b) {
      ranges.push_back(3.0 + std::sin(0.05 * b + scan) + 0.01 * std::cos(37.0 * b * scan));
    }
    graph.AddScan(pose_id, laser_id, ranges);
  }
  ThreadPool one(1), three(3);
  std::vector<ReturnNormal> by_one, by_three;
  ExtendReturnNormals(graph, 0, ReturnNormalOptions(), &one, &by_one);
  ExtendReturnNormals(graph, 0, ReturnNormalOptions(), &three, &by_three);
  EXPECT_EQ(by_one, by_three);
}

TEST(ReturnNormals, OptionsAreChecked) {
  EXPECT_TRUE(ReturnNormalOptions().Check(nullptr));
  ReturnNormalOptions options;
  options.half_window_m = 0.0;
  EXPECT_FALSE(options.Check(nullptr));
}

TEST(ReturnNormals, WhatMovesHasNone) {
  SlamGraph graph;
  const LaserModel laser = HalfDegreeLaser();
  const int laser_id = graph.AddLaser(laser);
  const int pose_id = graph.AddPose(Pose2(), 0.0);
  std::vector<double> ranges;
  for (int b = 0; b < laser.num_beams; ++b) ranges.push_back(WallAhead(2.0, laser.Bearing(b)));
  graph.AddScan(pose_id, laser_id, ranges);
  ThreadPool pool(1);
  std::vector<ReturnNormal> before;
  ExtendReturnNormals(graph, 0, ReturnNormalOptions(), &pool, &before);
  ASSERT_FALSE(before[100].IsNone());
  graph = std::move(graph).Corrected({{}, {}, {}, {}, {100}});
  std::vector<ReturnNormal> after;
  ExtendReturnNormals(graph, 0, ReturnNormalOptions(), &pool, &after);
  EXPECT_TRUE(after[100].IsNone());
  before[100] = ReturnNormal();
  EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace plumbline
