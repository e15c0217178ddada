#include "plumbline/core/map_points.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "plumbline/test/core/synthetic_scene.h"

namespace plumbline {
namespace {

std::vector<double> AsArray(const MapPoints& points) {
  std::vector<double> array;
  points.ForEach([&](std::size_t i, double x, double y) {
    EXPECT_EQ(2 * i, array.size());
    array.insert(array.end(), {x, y});
  });
  EXPECT_EQ(array.size(), 2 * points.size());
  return array;
}

void ExpectEachIs(const std::vector<double>& expected, const MapPoints& points) {
  EXPECT_EQ(AsArray(points), expected);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points.At(i).x(), expected[2 * i]);
    EXPECT_EQ(points.At(i).y(), expected[2 * i + 1]);
  }
}

SlamGraph GraphOfARoom() {
  SyntheticScene scene;
  scene.faces = {{{-3, -2}, {3, -2}}, {{3, -2}, {3, 2}}, {{3, 2}, {-3, 2}}, {{-3, 2}, {-3, -2}}};
  scene.poses = {{0, 0, 0}, {0.5, 0, 0.1}, {0.5, 0.4, 0.2}};
  return MakeGraph(scene);
}

std::vector<double> Disturbed(const SlamGraph& graph) {
  std::vector<double> poses = graph.initial_poses();
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] += 0.1 / (1.0 + static_cast<double>(i));
  return poses;
}

TEST(MapPoints, AreThoseOfAnArray) {
  const std::vector<double> array = {1.0, 2.0, -3.0, 4.5, 0.0, -0.25};
  ExpectEachIs(array, array);
  const std::vector<double> none;
  EXPECT_EQ(MapPoints(none).size(), 0u);
}

TEST(MapPoints, AreBitForBitWhereTheMeasurementsPutThem) {
  const SlamGraph graph = GraphOfARoom();
  const std::vector<double> poses = Disturbed(graph);
  const std::vector<double> measured = graph.MeasuredMap(poses);
  EXPECT_EQ(measured.size(), 2 * graph.num_returns());
  ExpectEachIs(measured, MapPoints(graph, poses));
}

TEST(MapPoints, OfAStateAreItsOwnIfItHasThem) {
  const SlamGraph graph = GraphOfARoom();
  MapState state;
  state.poses = Disturbed(graph);
  state.points = graph.MeasuredMap(state.poses);
  for (double& coordinate : state.points) coordinate += 0.125;
  ExpectEachIs(state.points, MapPoints(graph, state));
  state.points.clear();
  ExpectEachIs(graph.MeasuredMap(state.poses), MapPoints(graph, state));
}

TEST(MapPoints, OfAGraphWithoutReturnsAreNone) {
  const SlamGraph graph;
  const std::vector<double> poses;
  EXPECT_TRUE(AsArray(MapPoints(graph, poses)).empty());
}

}  // namespace
}  // namespace plumbline
