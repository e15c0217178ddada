#include "plumbline/apps/io/map_picture.h"

#include <cairo/cairo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/test/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

/// Pixels: first and one past the last.
struct Box {
  int left, right, top, bottom;
  int height() const { return bottom - top; }
  double center_x() const { return 0.5 * (left + right); }
  double center_y() const { return 0.5 * (top + bottom); }
};

/// A decoded PNG.
struct Picture {
  explicit Picture(const std::string& path) {
    cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
    EXPECT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    width = cairo_image_surface_get_width(surface);
    height = cairo_image_surface_get_height(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int row = 0; row < height; ++row) {
      const auto* line = reinterpret_cast<const std::uint32_t*>(
          cairo_image_surface_get_data(surface) + static_cast<std::size_t>(stride) * row);
      for (int column = 0; column < width; ++column) rgb.push_back(line[column] & 0xffffffu);
    }
    cairo_surface_destroy(surface);
  }

  int Count(bool (*is_it)(std::uint32_t)) const {
    return static_cast<int>(std::count_if(rgb.begin(), rgb.end(), is_it));
  }
  /// The box around a kind of pixels.
  Box Around(bool (*is_it)(std::uint32_t)) const {
    Box box{width, 0, height, 0};
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        if (!is_it(rgb[static_cast<std::size_t>(row) * width + column])) continue;
        box.left = std::min(box.left, column), box.right = std::max(box.right, column + 1);
        box.top = std::min(box.top, row), box.bottom = std::max(box.bottom, row + 1);
      }
    }
    return box;
  }

  int width = 0, height = 0;
  std::vector<std::uint32_t> rgb;
};

int Channel(std::uint32_t rgb, int shift) { return static_cast<int>(rgb >> shift & 0xffu); }
bool IsRed(std::uint32_t rgb) { return Channel(rgb, 16) > 80 + Channel(rgb, 8); }
bool IsGreen(std::uint32_t rgb) { return Channel(rgb, 8) > 80 + Channel(rgb, 16); }
bool IsBlack(std::uint32_t rgb) { return rgb == 0; }
bool IsWhite(std::uint32_t rgb) { return rgb == 0xffffffu; }

/// A robot that drives from (0, 0) to (length_m, 0) in a round room around each of 11 stops.
SlamGraph MakeGraph(double length_m) {
  SlamGraph graph;
  LaserModel laser;
  laser.num_beams = 720;
  laser.bearing_step_rad = 2.0 * kPi / 720;
  int laser_id = 0, pose = 0;
  EXPECT_TRUE(graph.AddLaser(laser, &laser_id).ok());
  for (int i = 0; i <= 10; ++i) {
    EXPECT_TRUE(graph.AddPose({0.1 * i * length_m, 0.0, 0.0}, i, &pose).ok());
    EXPECT_TRUE(graph.AddScan(pose, laser_id, std::vector<double>(720, 3.0)).ok());
  }
  return graph;
}

class MapPictureTest : public testing::Test {
 protected:
  Picture Draw(const SlamGraph& graph) {
    const Status status = WriteMapPicture(path_, graph, options_);
    EXPECT_TRUE(status.ok()) << status.message();
    return Picture(path_);
  }

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

TEST_F(MapPictureTest, LargeMapsTakeCoarserPixelsOfANiceSize) {
  // 206 m and 6.18 m of margin at both sides over 2400 px need 9.1 cm: 10 cm.
  const Picture picture = Draw(MakeGraph(200.0));
  EXPECT_NEAR(picture.width, 2184 + 40, 2);
  options_.max_side_px = 500;  // 43.7 cm: 50 cm; the picture keeps room for its title.
  EXPECT_EQ(Draw(MakeGraph(200.0)).width, 640);
}

TEST_F(MapPictureTest, FarOutliersDoNotShrinkTheMap) {
  SlamGraph graph = MakeGraph(10.0);
  for (int i = 0; i < 5; ++i) {
    graph.points()[2 * 1000 * i] = 1e6;
    graph.points()[2 * 1000 * i + 1] = -1e6;
  }
  graph.points()[100] = std::numeric_limits<double>::quiet_NaN();
  const Picture picture = Draw(graph);
  EXPECT_NEAR(picture.width, 1700 + 40, 12);
  EXPECT_NEAR(picture.height, 700 + 100, 12);
}

TEST_F(MapPictureTest, TheTrajectoryIsAlwaysInside) {
  SlamGraph graph = MakeGraph(10.0);
  int pose = 0;
  ASSERT_TRUE(graph.AddPose({10.0, 15.0, 0.0}, 11.0, &pose).ok());  // Sees nothing.
  const Picture picture = Draw(graph);
  const Box line = picture.Around(IsRed);
  EXPECT_NEAR(line.height(), 1500, 4);
  EXPECT_GT(line.top, 44);
}

TEST_F(MapPictureTest, SingleHitsAreVisibleBesideAWallOfMany) {
  SlamGraph graph = MakeGraph(0.0);  // Every return eleven times at one place.
  for (std::size_t i = 0; i < 20; ++i) {
    graph.points()[2 * i] = 0.05 * i;
    graph.points()[2 * i + 1] = 0.5;
  }
  const Picture picture = Draw(graph);
  // Black is what the fullest pixels have, 11 or more hits: log(2) / log(12) of darkness or more
  // for a single one.
  int num_gray = 0;
  for (std::uint32_t pixel : picture.rgb) {
    const std::uint32_t gray = pixel & 0xffu;
    num_gray += pixel == gray * 0x010101u && gray >= 100 && gray <= 204;
  }
  EXPECT_GE(num_gray, 20);
}

TEST_F(MapPictureTest, TheSameGraphGivesTheSameBytes) {
  options_.title = "a title";
  const SlamGraph graph = MakeGraph(5.0);
  Draw(graph);
  const std::string first = ReadFile(path_);
  Draw(graph);
  EXPECT_EQ(ReadFile(path_), first);
  EXPECT_EQ(NumFilesIn(folder_), 1);
}

TEST_F(MapPictureTest, AGraphWithoutReturnsIsATrajectory) {
  SlamGraph graph;
  int pose = 0;
  ASSERT_TRUE(graph.AddPose({7.0, 7.0, 0.0}, 0.0, &pose).ok());
  EXPECT_GT(Draw(graph).Count(IsGreen), 50);
}

TEST_F(MapPictureTest, BadInputIsRefusedAndLeavesNoFile) {
  SlamGraph graph;
  EXPECT_THAT(WriteMapPicture(path_, graph, options_).message(), HasSubstr("no poses"));
  graph = MakeGraph(1.0);
  options_.max_side_px = 5;
  EXPECT_THAT(WriteMapPicture(path_, graph, options_).message(), HasSubstr("max_side_px = 5"));
  options_ = MapPictureOptions();
  graph.poses()[3] = 1e200;
  EXPECT_THAT(WriteMapPicture(path_, graph, options_).message(), HasSubstr("from the origin"));
  graph.poses()[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(WriteMapPicture(path_, graph, options_).message(), HasSubstr("pose 1"));
  options_.title = "not UTF-8: \xff";
  EXPECT_FALSE(WriteMapPicture(path_, MakeGraph(1.0), options_).ok());
  EXPECT_EQ(NumFilesIn(folder_), 0);
  EXPECT_EQ(WriteMapPicture(folder_ + "none/map.png", MakeGraph(1.0), MapPictureOptions()).code(),
            StatusCode::kNotFound);
}

}  // namespace
}  // namespace plumbline
