#include "plumbline/core/point_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

using Neighbor = PointIndex::Neighbor;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All points within a radius by (distance, index), found by looking at each.
std::vector<Neighbor> BruteForce(const std::vector<double>& points, const Eigen::Vector2d& query,
                                 double radius_m) {
  std::vector<Neighbor> neighbors;
  for (std::size_t i = 0; i < points.size() / 2; ++i) {
    const double dx = points[2 * i] - query.x(), dy = points[2 * i + 1] - query.y();
    const double squared = dx * dx + dy * dy;
    if (squared <= radius_m * radius_m) {
      neighbors.push_back({squared, static_cast<std::uint32_t>(i)});
    }
  }
  std::sort(neighbors.begin(), neighbors.end(), [](const Neighbor& a, const Neighbor& b) {
    return std::make_pair(a.squared_distance, a.point) <
           std::make_pair(b.squared_distance, b.point);
  });
  return neighbors;
}

void ExpectSame(const std::vector<Neighbor>& actual, const std::vector<Neighbor>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    EXPECT_EQ(actual[i].point, expected[i].point);
    EXPECT_DOUBLE_EQ(actual[i].squared_distance, expected[i].squared_distance);
  }
}

std::vector<double> RandomPoints(int count, std::mt19937* engine) {
  std::uniform_real_distribution<double> uniform(-3.0, 5.0);
  std::vector<double> points(2 * count);
  for (double& coordinate : points) coordinate = uniform(*engine);
  return points;
}

TEST(PointIndexTest, AgreesWithBruteForce) {
  std::mt19937 engine(3);
  for (const int count : {1, 2, 9, 100, 1000}) {
    const std::vector<double> points = RandomPoints(count, &engine);
    const PointIndex index(points);
    EXPECT_EQ(index.size(), static_cast<std::size_t>(count));
    std::vector<Neighbor> neighbors;
    for (int trial = 0; trial < 50; ++trial) {
      const std::vector<double> q = RandomPoints(1, &engine);
      const Eigen::Vector2d query(q[0], q[1]);
      for (const double radius_m : {0.0, 0.3, 2.0, 20.0}) {
        index.FindWithin(query, radius_m, &neighbors);
        ExpectSame(neighbors, BruteForce(points, query, radius_m));
      }
      std::vector<Neighbor> expected = BruteForce(points, query, kInfinity);
      expected.resize(std::min<std::size_t>(expected.size(), 17));
      index.FindNearest(query, 17, &neighbors);  // The smallest sets hold fewer.
      ExpectSame(neighbors, expected);
    }
  }
}

TEST(PointIndexTest, FindsEveryDuplicate) {
  std::vector<double> points;
  for (int i = 0; i < 40; ++i) points.insert(points.end(), {1.5, -2.5});
  points.insert(points.end(), {1.5, -1.5});
  const PointIndex index(points);
  std::vector<Neighbor> neighbors;
  index.FindWithin({1.5, -2.5}, 0.0, &neighbors);
  ASSERT_EQ(neighbors.size(), 40u);
  for (std::uint32_t i = 0; i < 40; ++i) EXPECT_EQ(neighbors[i].point, i);
  index.FindNearest({1.5, -2.5}, 41, &neighbors);
  ASSERT_EQ(neighbors.size(), 41u);
  EXPECT_EQ(neighbors.back().point, 40u);
  EXPECT_EQ(neighbors.back().squared_distance, 1.0);
  index.FindNearest({1.5, -2.5}, 12, &neighbors);
  ASSERT_EQ(neighbors.size(), 12u);
  for (const Neighbor& neighbor : neighbors) EXPECT_EQ(neighbor.squared_distance, 0.0);
}

TEST(PointIndexTest, TheEdgeOfTheRadiusIsInside) {
  const PointIndex index({3.0, 4.0, 3.0, 4.0000001});
  std::vector<Neighbor> neighbors;
  index.FindWithin({0.0, 0.0}, 5.0, &neighbors);
  ASSERT_EQ(neighbors.size(), 1u);
  EXPECT_EQ(neighbors[0].point, 0u);
}

TEST(PointIndexTest, NothingIsFoundInAnEmptyIndexOrByZeroCount) {
  std::vector<Neighbor> neighbors(3);
  const PointIndex empty({});
  EXPECT_EQ(empty.size(), 0u);
  empty.FindNearest({1.0, 2.0}, 5, &neighbors);
  EXPECT_TRUE(neighbors.empty());
  neighbors.resize(3);
  empty.FindWithin({1.0, 2.0}, 5.0, &neighbors);
  EXPECT_TRUE(neighbors.empty());
  neighbors.resize(3);
  PointIndex({1.0, 2.0}).FindNearest({1.0, 2.0}, 0, &neighbors);
  EXPECT_TRUE(neighbors.empty());
}

TEST(PointIndexTest, AnswersSeveralThreadsAtOnceAndSurvivesAMove) {
  std::mt19937 engine(4);
  const std::vector<double> points = RandomPoints(500, &engine);
  PointIndex original(points);
  const PointIndex index(std::move(original));
  std::vector<std::vector<Neighbor>> found(4);
  std::vector<std::thread> threads;
  for (std::vector<Neighbor>& neighbors : found) {
    threads.emplace_back([&] {
      for (int i = 0; i < 200; ++i) index.FindNearest({0.01 * i, 1.0}, 20, &neighbors);
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::vector<Neighbor> expected = BruteForce(points, {1.99, 1.0}, kInfinity);
  expected.resize(20);
  for (const std::vector<Neighbor>& neighbors : found) ExpectSame(neighbors, expected);
}

}  // namespace
}  // namespace plumbline
