#include "plumbline/apps/pictures/map_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

bool IsMagenta(std::uint32_t rgb) { return rgb == 0xff00ffu; }

/// A robot that drives from (0, 0) to (length_m, 0) in a round room around each of 11 stops.
SlamGraph MakeGraph(double length_m) {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = 720;
  laser.bearing_step_rad = 2.0 * kPi / 720;
  const int laser_id = graph.AddLaser(laser);
  for (int i = 0; i <= 10; ++i) {
    const int pose = graph.AddPose({0.1 * i * length_m, 0.0, 0.0}, i);
    graph.AddScan(pose, laser_id, std::vector<double>(720, 3.0));
  }
  return graph;
}

class MapPictureTest : public testing::Test {
 protected:
  Picture Draw(const SlamGraph& graph, const MapState& state) {
    const Status status = WriteMapPicture(path_, graph, state, options_);
    EXPECT_TRUE(status.ok()) << status.message();
    return Picture(path_);
  }
  Picture Draw(const SlamGraph& graph) { return Draw(graph, graph.InitialState()); }

  const std::string folder_ = TempFolder();
  const std::string path_ = folder_ + "map.png";
  MapPictureOptions options_;
};

TEST_F(MapPictureTest, PixelsAreOfOneSizeInBothDirections) {
  // 10 m of path, 3 m of room around it, 0.5 m of margin at each side: 17 x 7 m, at 1 cm.
  const Picture picture = Draw(MakeGraph(10.0));
  EXPECT_NEAR(picture.width, 1700 + 40, 2);
  EXPECT_NEAR(picture.height, 700 + 100, 2);
  // The line from (0, 0), whose start the green dot hides, to (10, 0).
  const Box line = picture.Around(IsRed), dot = picture.Around(IsGreen);
  EXPECT_NEAR(line.right - dot.center_x(), 1000.0, 2.0);
  EXPECT_LE(line.height(), 4);
  EXPECT_NEAR(dot.center_x(), 20 + 350, 2.0);
  EXPECT_NEAR(dot.center_y(), 44 + 350, 2.0);
  EXPECT_GT(picture.Count(IsBlack), 500);
  EXPECT_GT(picture.Count(IsWhite), picture.width * picture.height * 9 / 10);
}

TEST_F(MapPictureTest, TellsWhereTheMapIs) {
  MapArea area;
  const SlamGraph graph = MakeGraph(10.0);
  ASSERT_TRUE(WriteMapPicture(path_, graph, graph.InitialState(), options_, &area).ok());
  const Picture picture(path_);
  const Box dot = picture.Around(IsGreen);  // at (0, 0)
  EXPECT_NEAR(area.left_px + area.raster.Column(0.0), dot.center_x(), 1.0);
  EXPECT_NEAR(area.top_px + area.raster.Row(0.0), dot.center_y(), 1.0);
  EXPECT_EQ(area.raster.pixel_m, 0.01);
  EXPECT_LT(area.top_px + area.raster.height, picture.height);
  const MapArea before = area;
  EXPECT_FALSE(WriteMapPicture(path_, SlamGraph(), MapState(), options_, &area).ok());
  EXPECT_EQ(area.raster.width, before.raster.width);
}

TEST_F(MapPictureTest, LargeMapsTakeCoarserPixelsOfANiceSize) {
  // 206 m and 6.18 m of margin at both sides over 2400 px need 9.1 cm: 10 cm.
  const Picture picture = Draw(MakeGraph(200.0));
  EXPECT_NEAR(picture.width, 2184 + 40, 2);
  options_.max_side_px = 500;  // 43.7 cm: 50 cm; the picture keeps room for its title.
  EXPECT_EQ(Draw(MakeGraph(200.0)).width, 640);
}

TEST_F(MapPictureTest, FarOutliersDoNotShrinkTheMap) {
  const SlamGraph graph = MakeGraph(10.0);
  MapState state = graph.InitialState();
  for (int i = 0; i < 5; ++i) {
    state.points[2 * 1000 * i] = 1e6;
    state.points[2 * 1000 * i + 1] = -1e6;
  }
  state.points[100] = std::numeric_limits<double>::quiet_NaN();
  const Picture picture = Draw(graph, state);
  EXPECT_NEAR(picture.width, 1700 + 40, 12);
  EXPECT_NEAR(picture.height, 700 + 100, 12);
}

TEST_F(MapPictureTest, TheTrajectoryIsAlwaysInside) {
  SlamGraph graph = MakeGraph(10.0);
  graph.AddPose({10.0, 15.0, 0.0}, 11.0);  // Sees nothing.
  const Picture picture = Draw(graph);
  const Box line = picture.Around(IsRed);
  EXPECT_NEAR(line.height(), 1500, 4);
  EXPECT_GT(line.top, 44);
}

TEST_F(MapPictureTest, SingleHitsAreVisibleBesideAWallOfMany) {
  const SlamGraph graph = MakeGraph(0.0);  // Every return eleven times at one place.
  MapState state = graph.InitialState();
  for (std::size_t i = 0; i < 20; ++i) {
    state.points[2 * i] = 0.05 * i;
    state.points[2 * i + 1] = 0.5;
  }
  const Picture picture = Draw(graph, state);
  // Black is what the fullest pixels have, 11 or more hits: log(2) / log(12) of darkness or more
  // for a single one.
  int num_gray = 0;
  for (std::uint32_t pixel : picture.rgb) {
    const std::uint32_t gray = pixel & 0xffu;
    num_gray += pixel == gray * 0x010101u && gray >= 100 && gray <= 204;
  }
  EXPECT_GE(num_gray, 20);
}

TEST_F(MapPictureTest, TheSameInputGivesTheSameBytes) {
  options_.title = "a title";
  options_.overlays.resize(1);
  options_.overlays[0].points = {{1.0, 0.0}, {2.0, 0.5}};
  const SlamGraph graph = MakeGraph(5.0);
  Draw(graph);
  const std::string first = ReadFile(path_);
  Draw(graph);
  EXPECT_EQ(ReadFile(path_), first);
  EXPECT_EQ(NumFilesIn(folder_), 1);
}

TEST_F(MapPictureTest, OverlaysLieWhereTheyBelongAndHaveALegend) {
  const SlamGraph graph = MakeGraph(10.0);
  MapOverlay overlay;
  overlay.color = {1.0, 0.0, 1.0};
  overlay.label = "marks";
  overlay.style = OverlayStyle::kLinks;
  overlay.points = {{2.0, 1.0}, {8.0, -1.0}};
  options_.overlays = {overlay};
  const Picture links = Draw(graph);
  EXPECT_NEAR(links.height, 700 + 100 + 30, 2);
  // 1 px = 1 cm, (0, 0) is at (370, 394); the dots at the ends have a radius of 3 px. The sample in
  // the legend ends left of x = 80 and below the map, at y = 744.
  const auto on_map = [](const Picture& picture) {
    return picture.Around(IsMagenta, Box{80, picture.width, 0, 744});
  };
  EXPECT_NEAR(on_map(links).left, 570 - 3, 2);
  EXPECT_NEAR(on_map(links).right, 1170 + 3, 2);
  EXPECT_NEAR(on_map(links).top, 294 - 3, 2);
  EXPECT_NEAR(on_map(links).bottom, 494 + 3, 2);
  EXPECT_GT(links.Around(IsMagenta).bottom, links.height - 30);
  // The path is gray now.
  EXPECT_EQ(links.Count([](std::uint32_t rgb) { return Channel(rgb, 16) > 80 + Channel(rgb, 0); }),
            0);

  overlay.style = OverlayStyle::kDashedLinks;
  options_.overlays = {overlay};
  const Picture dashes = Draw(graph);
  EXPECT_LT(dashes.Count(IsMagenta), 0.7 * links.Count(IsMagenta));

  overlay.style = OverlayStyle::kRings;
  overlay.points = {{4.0, 0.0}};
  options_.overlays = {overlay, overlay};
  const Picture rings = Draw(graph);
  EXPECT_NEAR(rings.height, 700 + 100 + 60, 2);
  EXPECT_NEAR(on_map(rings).center_x(), 770, 1.0);
  EXPECT_NEAR(on_map(rings).center_y(), 394, 1.0);
  EXPECT_NEAR(on_map(rings).height(), 20, 2);
}

TEST_F(MapPictureTest, OverlaysEndWithTheMap) {
  MapOverlay overlay;
  overlay.color = {1.0, 0.0, 1.0};
  overlay.points = {{5.0, 0.0}, {5.0, -100.0}};
  options_.overlays = {overlay};
  const Picture picture = Draw(MakeGraph(10.0));
  EXPECT_LE(picture.Around(IsMagenta, Box{80, picture.width, 0, picture.height}).bottom, 746);
}

TEST_F(MapPictureTest, AGraphWithoutReturnsIsATrajectory) {
  SlamGraph graph;
  graph.AddPose({7.0, 7.0, 0.0}, 0.0);
  EXPECT_GT(Draw(graph).Count(IsGreen), 50);
}

TEST_F(MapPictureTest, BadInputIsRefusedAndLeavesNoFile) {
  const SlamGraph graph = MakeGraph(1.0);
  const MapState sound = graph.InitialState();
  const auto error_of = [&](const MapState& state) {
    return WriteMapPicture(path_, graph, state, options_).message();
  };
  EXPECT_THAT(error_of(MapState()), HasSubstr("no poses"));
  options_.max_side_px = 5;
  EXPECT_THAT(error_of(sound), HasSubstr("max_side_px = 5"));
  options_ = MapPictureOptions();
  MapState bad = sound;
  bad.poses[3] = 1e200;
  EXPECT_THAT(error_of(bad), HasSubstr("from the origin"));
  bad.poses[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of(bad), HasSubstr("pose 1"));
  options_.title = "not UTF-8: \xff";
  EXPECT_FALSE(WriteMapPicture(path_, graph, sound, options_).ok());
  EXPECT_EQ(NumFilesIn(folder_), 0);
  EXPECT_EQ(WriteMapPicture(folder_ + "none/map.png", graph, sound, MapPictureOptions()).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
