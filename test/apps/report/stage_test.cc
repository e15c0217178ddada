#include "plumbline/apps/report/stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/test/core/synthetic_scene.h"

namespace plumbline {
namespace {

Stage MakeStage(const std::string& name, double thickness_m, double entropy) {
  Stage stage;
  stage.name = name;
  stage.quality = {thickness_m, entropy, 1000};
  return stage;
}

TEST(StageTableTest, WithoutTruth) {
  EXPECT_EQ(StageTable({MakeStage("odometry", 0.0503, -3.537),
                        MakeStage("refined, optimised points", 0.00237, -4.39849)}),
            "                           wall thickness  map entropy\n"
            "odometry                          50.3 mm       -3.537\n"
            "refined, optimised points          2.4 mm       -4.398\n");
}

TEST(StageTableTest, AMapTooSparseToBeMeasured) {
  Stage stage;
  stage.name = "odometry";
  EXPECT_EQ(StageTable({stage}),
            "                           wall thickness  map entropy\n"
            "odometry                                -            -\n");
}

TEST(StageTableTest, WithTruth) {
  Stage stage = MakeStage("seed", 0.0118, -3.7444);
  stage.error = TruthError{0.5011, DegToRad(3.98), 1.0};
  EXPECT_EQ(StageTable({stage}),
            "                           wall thickness  map entropy   pose error heading error   "
            "map error\n"
            "seed                              11.8 mm       -3.744     501.1 mm     3.980 deg   "
            "1000.0 mm\n");
  stage.error->mean_point_error_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(StageTable({stage}), testing::EndsWith("     3.980 deg           -\n"));
}

TEST(MeasureStageTest, MeasuresTheMapAsItStands) {
  SyntheticScene scene;
  scene.faces = {{{-3, -2}, {3, -2}}, {{3, -2}, {3, 2}}, {{3, 2}, {-3, 2}}, {{-3, 2}, {-3, -2}}};
  scene.poses = {{0, 0, 0}, {0.5, 0, 0.1}, {0.5, 0.4, 0.2}};
  const SlamGraph graph = MakeGraph(scene);
  MapState state = graph.InitialState();
  Truth truth;
  for (const Pose2& pose : scene.poses) truth.trajectory.push_back({0.0, pose});
  truth.points = state.points;
  ThreadPool pool(1);

  const Stage exact = MeasureStage("exact", graph, state, &truth, &pool);
  EXPECT_EQ(exact.name, "exact");
  EXPECT_LT(exact.quality.wall_thickness_m, 1e-6);
  ASSERT_TRUE(exact.error.has_value());
  EXPECT_LT(exact.error->mean_point_error_m, 1e-9);

  state.points[1] += 0.3;
  const Stage moved = MeasureStage("moved", graph, state, &truth, &pool);
  EXPECT_NEAR(moved.error->mean_point_error_m,
              0.3 / (0.5 * static_cast<double>(state.points.size())), 1e-9);
  EXPECT_FALSE(MeasureStage("no truth", graph, state, nullptr, &pool).error.has_value());
}

TEST(MeasureStageTest, AStateWithoutPointsHasThemWhereTheMeasurementsPutThem) {
  SyntheticScene scene;
  scene.faces = {{{-3, -2}, {3, -2}}, {{3, -2}, {3, 2}}, {{3, 2}, {-3, 2}}, {{-3, 2}, {-3, -2}}};
  scene.poses = {{0, 0, 0}, {0.5, 0, 0.1}, {0.5, 0.4, 0.2}};
  const SlamGraph graph = MakeGraph(scene);
  Truth truth;
  for (const Pose2& pose : scene.poses) truth.trajectory.push_back({0.0, pose});
  truth.points = graph.InitialState().points;
  MapState state;
  state.poses = graph.initial_poses();
  state.poses[4] += 0.02;
  const MapState with_points{state.poses, graph.MeasuredMap(state.poses)};
  ThreadPool pool(1);
  const Stage lacking = MeasureStage("", graph, state, &truth, &pool),
              having = MeasureStage("", graph, with_points, &truth, &pool);
  EXPECT_EQ(lacking.quality.wall_thickness_m, having.quality.wall_thickness_m);
  EXPECT_EQ(lacking.quality.mean_map_entropy, having.quality.mean_map_entropy);
  EXPECT_EQ(lacking.error->mean_point_error_m, having.error->mean_point_error_m);
  EXPECT_GT(lacking.error->mean_point_error_m, 1e-3);
}

}  // namespace
}  // namespace plumbline
