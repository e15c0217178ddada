#include "plumbline/apps/io/map_raster.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(MapRasterTest, HitsAreCountedPerPixelAndWhatIsOutsideIsNot) {
  MapRaster raster;
  raster.pixel_m = 1.0;
  raster.left_m = 10.0;
  raster.top_m = 2.0;
  raster.width = 2;
  raster.height = 2;
  const std::vector<double> points = {10.5, 1.5, 10.9, 1.1, 11.5, 0.5, 9.9,  1.0,
                                      12.0, 1.0, 10.5, 2.1, kNaN, 1.0, 10.5, kNaN};
  EXPECT_THAT(CountHits(points, raster), ElementsAre(2u, 0u, 0u, 1u));
}

TEST(MapRasterTest, WhatMovesCanBeLeftOut) {
  LaserModel laser;
  laser.num_beams = 3;
  laser.first_bearing_rad = -0.5;
  laser.bearing_step_rad = 0.5;
  SlamGraph graph;
  const int laser_id = graph.AddLaser(laser);
  const int pose = graph.AddPose(Pose2(), 0.0);
  graph.AddScan(pose, laser_id, {5.0, 5.0, 5.0});
  graph = std::move(graph).Corrected({{}, {}, {}, {}, {1}});
  const MapRaster raster{2.0, 4.0, 3.0, 1, 3};
  const MapState state = graph.InitialState();
  const MapPoints points(graph, state);
  EXPECT_THAT(CountHits(points, raster), ElementsAre(1u, 1u, 1u));
  EXPECT_THAT(CountHitsAtRest(graph, points, raster), ElementsAre(1u, 0u, 1u));
}

TEST(MapRasterTest, OneProcessGetsTheHitsOfAll) {
  RunOnPeers(3, [](const Peers& peers) {
    const auto rank = static_cast<std::uint32_t>(peers.rank());
    std::vector<std::uint32_t> hits = {rank, 0, 5, 0};
    GatherHits(&peers, 1, &hits);
    if (rank == 1) {
      EXPECT_THAT(hits, ElementsAre(3u, 0u, 15u, 0u));
    } else {
      EXPECT_THAT(hits, IsEmpty());
    }
  });
  std::vector<std::uint32_t> alone = {1, 2};
  GatherHits(nullptr, 0, &alone);
  EXPECT_THAT(alone, ElementsAre(1u, 2u));
}

TEST(MapRasterTest, BlackIsWhatTheFullestTenthHas) {
  EXPECT_EQ(BlackLevel({0, 0, 0}), 1.0);
  std::vector<std::uint32_t> hits(1000, 0);
  for (std::uint32_t i = 1; i <= 100; ++i) hits[5 * i] = i;
  EXPECT_EQ(BlackLevel(hits), 90.0);
  const std::vector<std::uint8_t> gray = DensityImage({0, 1, 45, 90, 500}, 90.0);
  EXPECT_EQ(gray[0], 255);
  EXPECT_LT(gray[1], 255 - 40);
  EXPECT_LT(gray[2], gray[1]);
  EXPECT_EQ(gray[3], 0);
  EXPECT_EQ(gray[4], 0);
}

TEST(MapRasterTest, TheExtentHoldsTheTrajectoryAndMostPoints) {
  std::vector<double> points;
  for (int i = 0; i <= 1000; ++i) points.insert(points.end(), {0.01 * i, 1.0});
  points.insert(points.end(), {1e12, 1.0, kNaN, kNaN});
  MapExtent extent;
  ASSERT_TRUE(FindExtent(points, {{0.0, 5.0, 0.0}}, 0.01, &extent).ok());
  EXPECT_NEAR(extent.x.low, -0.5, 0.2);
  EXPECT_NEAR(extent.x.high, 10.5, 0.2);
  EXPECT_NEAR(extent.y.low, 0.5, 1e-9);
  EXPECT_NEAR(extent.y.high, 5.5, 1e-9);
  EXPECT_EQ(FindExtent(points, {}, 0.0, &extent).code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace plumbline
