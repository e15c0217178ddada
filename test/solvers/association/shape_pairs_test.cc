#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/test/core/synthetic_scene.h"

namespace plumbline {
namespace {

std::vector<ShapePair> PairsOf(const SlamGraph& graph, int num_threads = 1) {
  ThreadPool pool(num_threads);
  return FindShapePairs(graph, graph.InitialState().points, SurfaceOf(graph).normals, &pool);
}

std::vector<ShapePair> PairsOf(const SyntheticScene& scene) { return PairsOf(MakeGraph(scene)); }

Eigen::Vector2d AdjacentNormal(const MapState& state, const ShapePair& pair) {
  const auto point = [&](std::size_t id) {
    return Eigen::Vector2d(state.points[2 * id], state.points[2 * id + 1]);
  };
  return SegmentNormal(point(pair.adjacent_previous), point(pair.adjacent_current));
}

int Count(const std::vector<ShapePair>& pairs, ShapeCategory category) {
  return static_cast<int>(std::count_if(
      pairs.begin(), pairs.end(), [&](const ShapePair& p) { return p.category == category; }));
}

/// One scan from the origin.
SyntheticScene Scene(const std::vector<Face>& faces, double range_sigma_m = 0.0) {
  SyntheticScene scene;
  scene.faces = faces;
  scene.poses = {{0.0, 0.0, 0.0}};
  scene.range_sigma_m = range_sigma_m;
  return scene;
}

/// The same beams in the opposite order.
SyntheticScene Clockwise(SyntheticScene scene) {
  scene.laser.first_bearing_rad = kPi;
  scene.laser.bearing_step_rad *= -1.0;
  return scene;
}

// 4 m of wall 1.5 m ahead, beams 1.3 cm apart or more: regions of 0.2 m and up to a beam's spacing,
// 1.3 to 3.6 cm, more; the next one starts a spacing later. That makes 15 to 19 of them.
const Face kWall{{1.5, -2.0}, {1.5, 2.0}};

TEST(ShapePairsTest, AStraightWallIsParallelToItself) {
  for (const SyntheticScene& scene : {Scene({kWall}), Clockwise(Scene({kWall}))}) {
    const SlamGraph graph = MakeGraph(scene);
    const MapState state = graph.InitialState();
    const std::vector<ShapePair> pairs = PairsOf(graph);
    EXPECT_GE(pairs.size(), 14u);
    EXPECT_LE(pairs.size(), 18u);
    EXPECT_EQ(Count(pairs, ShapeCategory::k0), static_cast<int>(pairs.size()));
    for (const ShapePair& pair : pairs) {
      const Eigen::Vector2d previous = MapPoint(state, pair.previous);
      const Eigen::Vector2d current = MapPoint(state, pair.current);
      EXPECT_GE((previous - current).norm(), 0.2);
      EXPECT_LE((previous - current).norm(), 0.24);
      EXPECT_NEAR((AdjacentNormal(state, pair) - SegmentNormal(previous, current)).norm(), 0.0,
                  2e-6);
    }
  }
}

TEST(ShapePairsTest, ANoisyWallIsParallelToItselfOrNothing) {
  const std::vector<ShapePair> pairs = PairsOf(Scene({kWall}, 0.01));
  // A segment's direction is good to sqrt(2) x 1 cm / 0.2 m = 4 deg, so about 1 in 30 pairs falls
  // outside of 10 deg once the fitted normal's 2 deg are added.
  EXPECT_GE(pairs.size(), 10u);
  EXPECT_EQ(Count(pairs, ShapeCategory::k0), static_cast<int>(pairs.size()));
}

TEST(ShapePairsTest, EndsOfSegmentsAreDistinctReturnsInOrder) {
  SyntheticScene scene = Scene({kWall, {{-1.0, -2.0}, {-1.2, 2.0}}}, 0.01);
  scene.poses = {{0.0, 0.0, 0.0}, {0.1, 0.3, 1.0}};
  const SlamGraph graph = MakeGraph(scene);
  const std::vector<ShapePair> pairs = PairsOf(graph);
  ASSERT_GE(pairs.size(), 20u);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_LT(pairs[i].previous, pairs[i].current);
    EXPECT_EQ(graph.ScansOfReturns()[pairs[i].previous], graph.ScansOfReturns()[pairs[i].current]);
    if (i > 0) {
      EXPECT_LT(pairs[i - 1].current, pairs[i].previous);
    }
  }
}

TEST(ShapePairsTest, TheCornerOfARoomIsARightAngleToTheLeft) {
  // Counter-clockwise beams meet x = 2 first; the segments' normals point away from the laser.
  const std::vector<Face> faces = {{{2.0, -1.0}, {2.0, 2.0}}, {{2.0, 2.0}, {-1.0, 2.0}}};
  const std::vector<ShapePair> pairs = PairsOf(Scene(faces));
  EXPECT_EQ(Count(pairs, ShapeCategory::k90), 1);
  EXPECT_EQ(Count(pairs, ShapeCategory::k0), static_cast<int>(pairs.size()) - 1);
  EXPECT_GE(pairs.size(), 20u);
  const std::vector<ShapePair> reversed = PairsOf(Clockwise(Scene(faces)));
  // Beams in the opposite order turn all normals about, and the turn between them backwards.
  EXPECT_EQ(Count(reversed, ShapeCategory::k270), 1);
  EXPECT_EQ(Count(reversed, ShapeCategory::k0), static_cast<int>(reversed.size()) - 1);
}

TEST(ShapePairsTest, TheCornerOfAPillarIsARightAngleToTheRight) {
  const std::vector<ShapePair> pairs =
      PairsOf(Scene({{{1.0, 1.0}, {2.0, 1.0}}, {{1.0, 1.0}, {1.0, 2.0}}}));
  EXPECT_EQ(Count(pairs, ShapeCategory::k270), 1);
  EXPECT_EQ(Count(pairs, ShapeCategory::k0), static_cast<int>(pairs.size()) - 1);
  EXPECT_GE(pairs.size(), 5u);
}

TEST(ShapePairsTest, WallsAtThirtyDegreesAreNotTiedTogether) {
  const Eigen::Vector2d bend(2.0, 0.5);
  const Eigen::Vector2d end = bend + 2.0 * Eigen::Vector2d(-0.5, std::sqrt(0.75));
  const SlamGraph graph = MakeGraph(Scene({{{2.0, -1.5}, bend}, {bend, end}}));
  const MapState state = graph.InitialState();
  const std::vector<ShapePair> pairs = PairsOf(graph);
  EXPECT_GE(pairs.size(), 12u);
  EXPECT_EQ(Count(pairs, ShapeCategory::k0), static_cast<int>(pairs.size()));
  bool below = false, above = false;
  for (const ShapePair& pair : pairs) {
    const Eigen::Vector2d adjacent = AdjacentNormal(state, pair);
    const double turn_rad = std::atan2(adjacent.y(), adjacent.x());
    const bool is_above = MapPoint(state, pair.previous).y() > bend.y();
    // The region across the bend itself may lean either way, its neighbours by no more than 10 deg.
    EXPECT_LE(std::abs(turn_rad - (is_above ? DegToRad(30.0) : 0.0)), DegToRad(11.0));
    (is_above ? above : below) = true;
  }
  EXPECT_TRUE(below && above);
}

TEST(ShapePairsTest, ShortSurfacesGiveNone) {
  std::vector<Face> faces;
  for (int i = 0; i < 16; ++i) {  // 0.15 m each, every other one a metre further away
    const double x = i % 2 == 0 ? 1.5 : 2.5;
    faces.push_back({{x, -1.2 + 0.15 * i}, {x, -1.05 + 0.15 * i}});
  }
  EXPECT_TRUE(PairsOf(Scene(faces)).empty());
}

TEST(ShapePairsTest, NothingIsTiedAcrossAGapOrAStep) {
  // Each piece of 0.3 m holds exactly one region.
  const Face left{{1.5, 0.15}, {1.5, 0.45}}, far_left{{1.5, 1.15}, {1.5, 1.45}};
  const Face stepped{{2.5, 0.75}, {2.5, 1.05}};
  EXPECT_TRUE(PairsOf(Scene({left})).empty());
  EXPECT_TRUE(PairsOf(Scene({left, far_left})).empty());
  EXPECT_TRUE(PairsOf(Scene({left, stepped})).empty());
}

TEST(ShapePairsTest, AllThreadCountsAgree) {
  SyntheticScene scene = Scene({{{2.0, -1.0}, {2.0, 2.0}}, {{2.0, 2.0}, {-1.0, 2.0}}}, 0.01);
  scene.laser = PanoramicLaser(360);
  for (int i = 1; i < 150; ++i) scene.poses.push_back({0.002 * i, 0.003 * i, 0.1 * i});
  const SlamGraph graph = MakeGraph(scene);
  const std::vector<ShapePair> one = PairsOf(graph, 1), three = PairsOf(graph, 3);
  ASSERT_EQ(one.size(), three.size());
  ASSERT_GE(one.size(), 1000u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].previous, three[i].previous);
    EXPECT_EQ(one[i].current, three[i].current);
    EXPECT_EQ(one[i].category, three[i].category);
    EXPECT_EQ(one[i].adjacent_previous, three[i].adjacent_previous);
    EXPECT_EQ(one[i].adjacent_current, three[i].adjacent_current);
  }
}

}  // namespace
}  // namespace plumbline
