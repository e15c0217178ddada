#include "plumbline/solvers/front_end/local_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <tuple>
#include <utility>

namespace plumbline {
namespace {

const Eigen::Vector2d kUp(0.0, 1.0);
const Eigen::Vector2d kRight(1.0, 0.0);

// Points strewn over a square of 3 m about the origin, with normals in all directions.
SurfacePoints Strewn(int num_points, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return random() / 4294967296.0; };
  SurfacePoints points;
  for (int i = 0; i < num_points; ++i) {
    const double angle = 2.0 * kPi * uniform();
    const double x = 3.0 * uniform() - 1.5, y = 3.0 * uniform() - 1.5;
    points.push_back({{x, y}, {std::cos(angle), std::sin(angle)}});
  }
  return points;
}

// By looking at every point of the map.
const SurfacePoint* NearestOfAll(const LocalMap& map, const SurfacePoint& query, double reach_m) {
  const SurfacePoint* nearest = nullptr;
  for (const SurfacePoint& point : map.points()) {
    const double distance_m = (point.position - query.position).norm();
    if (distance_m >= reach_m || point.normal.dot(query.normal) < std::sqrt(0.5)) continue;
    nearest = &point;
    reach_m = distance_m;
  }
  return nearest;
}

TEST(LocalMap, AveragesPointsOfOneCellAndDirection) {
  LocalMap map(0.1);
  const SurfacePoints first{{{1.02, 2.02}, kUp}}, second{{{0.04, 0.06}, kUp}};
  // The second scan is seen from (1, 2): its point falls into the same cell, at (1.04, 2.06).
  map.Rebuild(std::vector<const SurfacePoints*>{&first, &second}, {Pose2(), Pose2(1.0, 2.0, 0.0)});
  ASSERT_EQ(map.points().size(), 1u);
  EXPECT_NEAR(map.points()[0].position.x(), 1.03, 1e-12);
  EXPECT_NEAR(map.points()[0].position.y(), 2.04, 1e-12);
}

TEST(LocalMap, KeepsTheTwoFacesOfAWallApart) {
  LocalMap map(0.1);
  const SurfacePoints scan{{{1.02, 2.02}, kUp}, {{1.04, 2.04}, -kUp}};
  map.Rebuild({&scan}, {Pose2()});
  EXPECT_EQ(map.points().size(), 2u);
  const SurfacePoint* nearest = map.Nearest({{1.02, 2.02}, -kUp}, 0.5);
  ASSERT_NE(nearest, nullptr);
  EXPECT_NEAR(nearest->position.y(), 2.04, 1e-12);
}

TEST(LocalMap, AveragesLikeASearchForEqualCells) {
  const SurfacePoints scan = Strewn(5000, 1);
  LocalMap map(0.1);
  map.Rebuild({&scan}, {Pose2()});
  std::map<std::tuple<int, int, int>, std::pair<Eigen::Vector2d, int>> cells;
  for (const SurfacePoint& point : scan) {
    // Octants centred on the axes and the diagonals.
    const double turns = std::atan2(point.normal.y(), point.normal.x()) / (2.0 * kPi);
    const int octant = static_cast<int>(std::floor(8.0 * turns + 0.5)) & 7;
    const Eigen::Vector2d at = (point.position / 0.1).array().floor();
    auto& [sum, count] =
        cells
            .try_emplace({static_cast<int>(at.x()), static_cast<int>(at.y()), octant},
                         Eigen::Vector2d::Zero(), 0)
            .first->second;
    sum += point.position;
    ++count;
  }
  ASSERT_EQ(map.points().size(), cells.size());
  for (const auto& [cell, sum_and_count] : cells) {
    const Eigen::Vector2d mean = sum_and_count.first / sum_and_count.second;
    const bool found = std::any_of(
        map.points().begin(), map.points().end(),
        [&](const SurfacePoint& point) { return (point.position - mean).norm() < 1e-12; });
    EXPECT_TRUE(found) << mean.transpose();
  }
}

TEST(LocalMap, FindsTheNearestOfAllWithAndWithoutHint) {
  const SurfacePoints scan = Strewn(1500, 2);
  LocalMap map(0.03);
  map.Rebuild({&scan}, {Pose2()});
  int num_found = 0, num_missed = 0;
  for (SurfacePoint query : Strewn(500, 3)) {
    query.position *= 1.3;  // some lie outside the map
    for (const double reach_m : {0.05, 0.5, 5.0}) {
      const SurfacePoint* nearest = NearestOfAll(map, query, reach_m);
      ++(nearest != nullptr ? num_found : num_missed);
      EXPECT_EQ(map.Nearest(query, reach_m), nearest);
      for (const int hint : {0, 1, 2}) {
        EXPECT_EQ(map.Nearest(query, reach_m, &map.points()[500 * hint]), nearest);
      }
    }
  }
  EXPECT_GT(num_found, 500);
  EXPECT_GT(num_missed, 100);
}

TEST(LocalMap, ForgetsWhatItHeldBefore) {
  const SurfacePoints scan = Strewn(300, 4), other{{{0.5, 0.5}, kUp}};
  LocalMap map(0.1);
  map.Rebuild({&scan}, {Pose2()});
  map.Rebuild({&other}, {Pose2()});
  ASSERT_EQ(map.points().size(), 1u);
  EXPECT_EQ(map.Nearest({{0.0, 0.0}, kUp}, 5.0), &map.points()[0]);
  const SurfacePoints none;
  map.Rebuild({&none}, {Pose2()});
  EXPECT_TRUE(map.points().empty());
  EXPECT_EQ(map.Nearest({{0.0, 0.0}, kUp}, 5.0), nullptr);
}

TEST(LocalMap, LeavesOutWhatIsFarOff) {
  const SurfacePoints scan{{{1.0, 0.0}, kUp}, {{1e6, 0.0}, kUp}};
  LocalMap map(0.1);
  map.Rebuild({&scan}, {Pose2(100.0, 0.0, 0.0)});
  ASSERT_EQ(map.points().size(), 1u);
  EXPECT_NEAR(map.points()[0].position.x(), 101.0, 1e-12);
}

TEST(LocalMap, TurnsPointsAndNormalsWithTheRobot) {
  LocalMap map(0.1);
  const SurfacePoints scan{{{1.0, 0.0}, kRight}};
  map.Rebuild({&scan}, {Pose2(0.0, 0.0, kPi / 2.0)});
  ASSERT_EQ(map.points().size(), 1u);
  EXPECT_NEAR((map.points()[0].position - kUp).norm(), 0.0, 1e-12);
  EXPECT_NEAR((map.points()[0].normal - kUp).norm(), 0.0, 1e-12);
}

TEST(LocalMap, FindsNothingBeyondTheRadiusOrInAnEmptyMap) {
  LocalMap map(0.1);
  EXPECT_EQ(map.Nearest({{0.0, 0.0}, kUp}, 1.0), nullptr);
  const SurfacePoints scan{{{0.0, 0.0}, kUp}, {{2.0, 0.0}, kUp}};
  map.Rebuild({&scan}, {Pose2()});
  EXPECT_EQ(map.Nearest({{1.0, 0.0}, kUp}, 0.9), nullptr);
  EXPECT_EQ(map.Nearest({{-50.0, 70.0}, kUp}, 0.9), nullptr);
  const SurfacePoint* nearest = map.Nearest({{1.2, 0.0}, kUp}, 0.9);
  ASSERT_NE(nearest, nullptr);
  EXPECT_EQ(nearest->position.x(), 2.0);
}

TEST(LocalMap, ANeighborIsTheSameWithinItsMargin) {
  const SurfacePoints scan = Strewn(2000, 3), queries = Strewn(100, 4);
  LocalMap map(0.1);
  map.Rebuild({&scan}, {Pose2()});
  std::mt19937 random(5);
  const auto uniform = [&] { return 2.0 * (random() / 4294967296.0) - 1.0; };
  int num_found = 0, num_missing = 0;
  for (const double reach_m : {0.02, 0.2}) {
    for (const SurfacePoint& query : queries) {
      const LocalMap::Neighbor neighbor = map.NearestWithMargin(query, reach_m);
      ASSERT_EQ(neighbor.point, NearestOfAll(map, query, reach_m));
      ASSERT_GE(neighbor.margin_m, 0.0);
      if (neighbor.margin_m == 0.0) continue;
      for (int i = 0; i < 10; ++i) {
        const double direction = kPi * uniform(), turn = LocalMap::kMarginRad * uniform();
        const double moved_m = 0.999 * neighbor.margin_m * std::abs(uniform());
        SurfacePoint moved = Pose2(0.0, 0.0, turn) * query;
        moved.position =
            query.position + moved_m * Eigen::Vector2d(std::cos(direction), std::sin(direction));
        const SurfacePoint* nearest = NearestOfAll(map, moved, reach_m);
        if (neighbor.point == nullptr) {
          ASSERT_EQ(nearest, nullptr);
          ++num_missing;
          continue;
        }
        const bool is_in_reach = (neighbor.point->position - moved.position).norm() < reach_m;
        if (!is_in_reach || !LocalMap::FacesAlike(moved, *neighbor.point)) continue;
        ASSERT_EQ(nearest, neighbor.point);
        ++num_found;
      }
    }
  }
  EXPECT_GT(num_found, 300);
  EXPECT_GT(num_missing, 300);
}

}  // namespace
}  // namespace plumbline
