#include "plumbline/apps/figures/map_figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include "plumbline/apps/figures/map_layout.h"
#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool IsBlue(std::uint32_t rgb) { return Channel(rgb, 0) > 60 + Channel(rgb, 16); }
bool IsVermilion(std::uint32_t rgb) { return Channel(rgb, 16) > 150 + Channel(rgb, 0); }
bool IsGreenish(std::uint32_t rgb) {
  return Channel(rgb, 8) > 60 + Channel(rgb, 16) && Channel(rgb, 8) > 20 + Channel(rgb, 0);
}

// The outline of a room, length_m x 4 m, around the origin.
MapPanel Room(double length_m) {
  MapPanel panel;
  panel.title = "room";
  for (double t = -0.5; t <= 0.5; t += 0.001) {
    for (const double side : {-0.5, 0.5}) {
      panel.points.insert(panel.points.end(), {t * length_m, side * 4.0});
      panel.points.insert(panel.points.end(), {side * length_m, t * 4.0});
    }
  }
  panel.trajectory = {{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  return panel;
}

class MapFigureTest : public testing::Test {
 protected:
  Picture Draw() {
    const Status status = WriteMapFigure(path_, figure_, options_);
    EXPECT_TRUE(status.ok()) << status.message();
    return Picture(path_);
  }
  MapLayout Layout() const {
    // What a room of 10 x 4 m takes, with a margin of 0.5 m.
    return LayOutMaps(figure_, {{-5.5, 5.5}, {-2.5, 2.5}}, options_);
  }
  void ExpectRefused(const std::string& message) {
    const Status status = WriteMapFigure(path_, figure_, options_);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr(message));
    EXPECT_EQ(NumFilesIn(folder_), 0);
  }

  const std::string folder_ = TempFolder();
  const std::string path_ = folder_ + "maps.png";
  MapFigure figure_;
  MapFigureOptions options_;
};

TEST_F(MapFigureTest, AllPanelsHaveOneScaleWhateverTheyHold) {
  figure_.panels = {Room(10.0), Room(6.0)};
  options_.width_px = 1600;
  const Picture picture = Draw();
  EXPECT_EQ(picture.width, 1600);
  // The path is 2 m long in either panel, and in the middle of it.
  const Box left = picture.Around(IsBlue, Box{0, 800, 0, picture.height});
  const Box right = picture.Around(IsBlue, Box{800, 1600, 0, picture.height});
  EXPECT_NEAR(right.right - right.left, left.right - left.left, 1);
  EXPECT_NEAR(right.center_x() - left.center_x(), 800.0, 1.0);
  EXPECT_EQ(right.center_y(), left.center_y());
  const double pixel_m = 2.0 / (left.right - left.left);
  EXPECT_NEAR(pixel_m, Layout().map.raster.pixel_m, 0.02 * pixel_m);
}

TEST_F(MapFigureTest, ScaleIsTheSameInBothDirections) {
  figure_.panels = {Room(10.0)};
  figure_.panels[0].trajectory = {{-1.0, -1.0, 0.0}, {1.0, 1.0, 0.0}};
  const Picture picture = Draw();
  const Box path = picture.Around(IsBlue);
  EXPECT_NEAR(path.right - path.left, path.height(), 2);
}

TEST_F(MapFigureTest, DetailsHaveALargerScaleInCommon) {
  figure_.panels = {Room(10.0), Room(10.0)};
  figure_.details = {{{0.0, 0.0}, 2.0, 1.0}, {{5.0, 2.0}, 1.0, 1.0}};
  const MapLayout layout = Layout();
  ASSERT_EQ(layout.details.size(), 2u);
  EXPECT_EQ(layout.details[0].raster.pixel_m, layout.details[1].raster.pixel_m);
  EXPECT_LT(layout.details[0].raster.pixel_m, 0.6 * layout.map.raster.pixel_m);
  EXPECT_NEAR(layout.details[0].raster.width, 2 * layout.details[1].raster.width, 1);
  EXPECT_NEAR(layout.details[0].raster.height, layout.details[1].raster.height, 1);
  // Frames in the whole map, and nowhere else.
  const Picture picture = Draw();
  EXPECT_EQ(picture.height, layout.height_px);
  const Box map{0, 1200, 0, layout.map.top_px + layout.map.raster.height + 5};
  EXPECT_GT(picture.Around(IsVermilion, map).height(), 50);
  const Box below{0, 1200, map.bottom, picture.height};
  EXPECT_LT(picture.Around(IsVermilion, below).height(), 0);
  // The path runs through the first detail from edge to edge.
  const Box path = picture.Around(IsBlue, below);
  EXPECT_NEAR(path.right - path.left, layout.details[0].raster.width, 3);
}

TEST_F(MapFigureTest, WhatIsTrueLiesUnderThePoints) {
  figure_.panels = {Room(10.0)};
  EXPECT_EQ(Draw().Count(IsGreenish), 0);
  figure_.panels[0].truth_lines = {{{-4.0, 1.0}, {4.0, 1.0}}};
  const int free = Draw().Count(IsGreenish);
  EXPECT_GT(free, 1000);
  figure_.panels[0].truth_lines = {{{-5.0, 2.0}, {5.0, 2.0}}};  // on the wall
  EXPECT_LT(Draw().Count(IsGreenish), 1.5 * free);
  EXPECT_GT(Draw().Count(IsBlack), 1500);
}

TEST_F(MapFigureTest, PointsAreSquaresOfTheGivenSide) {
  MapPanel panel;
  panel.points = {-3.0, -2.0, 3.0, 2.0, 0.5, 0.3};
  figure_.panels = {panel};
  const Picture single = Draw();
  options_.point_px = 5;
  const Picture squares = Draw();
  // Two of the points are on the edge of the extent, with a margin around.
  EXPECT_EQ(squares.Count(IsBlack) - single.Count(IsBlack), 3 * (25 - 1));
}

TEST_F(MapFigureTest, AllPanelsShareOneExposure) {
  MapPanel faint = Room(10.0), dark = Room(10.0);
  faint.trajectory = dark.trajectory = {};
  for (int i = 0; i < 30; ++i) {
    dark.points.insert(dark.points.end(), faint.points.begin(), faint.points.end());
  }
  figure_.panels = {faint, dark};
  const Picture picture = Draw();
  const MapLayout layout = Layout();
  // The upper wall, away from axes.
  const int row = layout.map.top_px + static_cast<int>(layout.map.raster.Row(2.0));
  const auto darkest = [&](int left) {
    int level = 255;
    for (int y = row - 3; y <= row + 3; ++y) {
      for (int x = left + 400; x < left + 900; ++x) {
        level = std::min(level, Channel(picture.rgb[y * picture.width + x], 0));
      }
    }
    return level;
  };
  EXPECT_GT(darkest(0), 100);
  EXPECT_LT(darkest(1200), 30);
}

TEST_F(MapFigureTest, TheSameFigureGivesTheSameBytes) {
  figure_.panels = {Room(10.0), Room(8.0)};
  figure_.details = {{{5.0, 2.0}, 1.0, 1.0}};
  Draw();
  const std::string first = ReadFile(path_);
  Draw();
  EXPECT_EQ(ReadFile(path_), first);
}

TEST_F(MapFigureTest, BadInputIsRefusedAndLeavesNoFile) {
  ExpectRefused("no panels");
  const std::vector<std::pair<std::string, std::function<void(MapFigure*)>>> faults = {
      {"panel 1: an odd number", [](MapFigure* f) { f->panels[1].points.pop_back(); }},
      {"panel 0: point 2 is nowhere", [](MapFigure* f) { f->panels[0].points[5] = kNaN; }},
      {"panel 1: pose 1 is nowhere", [](MapFigure* f) { f->panels[1].trajectory[1].x = 1e200; }},
      {"panel 0: truth line 0",
       [](MapFigure* f) {
         f->panels[0].truth_lines = {{{0.0, 0.0}, {0.0, kNaN}}};
       }},
      {"panel 1: neither", [](MapFigure* f) { f->panels[1] = MapPanel(); }},
      {"detail 0",
       [](MapFigure* f) {
         f->details = {{{0.0, 0.0}, 0.0, 1.0}};
       }},
      {"detail 0",
       [](MapFigure* f) {
         f->details = {{{0.0, 0.0}, 1.0, kNaN}};
       }},
      {"detail 0",
       [](MapFigure* f) {
         f->details = {{{kNaN, 0.0}, 1.0, 1.0}};
       }},
      {"26",
       [](MapFigure* f) {
         f->details.assign(27, {{0.0, 0.0}, 1.0, 1.0});
       }},
      {"px high", [](MapFigure* f) { f->panels.assign(200, Room(10.0)); }}};
  for (const auto& [message, spoil] : faults) {
    figure_ = MapFigure();
    figure_.panels = {Room(10.0), Room(10.0)};
    spoil(&figure_);
    ExpectRefused(message);
  }
  figure_.panels = {Room(10.0)};
  figure_.details.clear();
  options_.width_px = 399;
  ExpectRefused("width_px = 399");
  options_ = MapFigureOptions();
  options_.crop_share = kNaN;
  ExpectRefused("crop_share");
  options_ = MapFigureOptions();
  options_.point_px = 4;
  ExpectRefused("point_px");
  EXPECT_EQ(WriteMapFigure(folder_ + "none/a.png", figure_, MapFigureOptions()).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
