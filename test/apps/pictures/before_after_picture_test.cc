#include "plumbline/apps/pictures/before_after_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

bool IsDark(std::uint32_t rgb) { return (rgb & 0xffu) < 100; }

// A square pillar of 1 m at (5, 5), seen from around it, in a room of the given size.
SyntheticScene Pillar(double width_m, double height_m) {
  SyntheticScene scene;
  const Eigen::Vector2d a(0.0, 0.0), c(width_m, height_m), b(c.x(), a.y()), d(a.x(), c.y());
  scene.faces = {{a, b}, {b, c}, {c, d}, {d, a}};
  scene.discs = {{{5.0, 5.0}, 0.5}};
  for (const double x : {3.0, 7.0}) {
    for (const double y : {3.0, 7.0}) scene.poses.emplace_back(x, y, 0.0);
  }
  return scene;
}

class BeforeAfterPictureTest : public testing::Test {
 protected:
  Picture Draw(const SlamGraph& graph, const MapState& state,
               const std::vector<double>& poses_before) {
    BeforeAfterPicture picture;
    const Status status = picture.Gather(graph, state, poses_before, options_);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_TRUE(picture.Draw(path_).ok());
    return Picture(path_);
  }
  // Of a map as its graph begins.
  Picture Draw(const SlamGraph& graph, const std::vector<double>& poses_before) {
    return Draw(graph, graph.InitialState(), poses_before);
  }
  std::string ErrorOf(const SlamGraph& graph, const MapState& state,
                      const std::vector<double>& poses_before) const {
    const Status status = BeforeAfterPicture().Gather(graph, state, poses_before, options_);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    return status.message();
  }

  const std::string folder_ = TempFolder();
  const std::string path_ = folder_ + "before_after.png";
  BeforeAfterOptions options_{"Before: seed", "After: refined", 2400};
};

TEST_F(BeforeAfterPictureTest, WideMapsLieBelowEachOtherInOneWindow) {
  const SlamGraph graph = MakeGraph(Pillar(20.0, 10.0));
  std::vector<double> before = graph.initial_poses();
  for (std::size_t i = 0; i < before.size(); i += 3) before[i] += 1.0;
  const Picture picture = Draw(graph, before);
  // 20 m + 2 x 0.6 m and 10 m + 2 x 0.5 m at 2 cm.
  EXPECT_NEAR(picture.width, 1060 + 40, 3);
  EXPECT_NEAR(picture.height, 2 * (550 + 44) + 56, 4);
  // The left wall: before, it is 1 m farther to the right.
  const auto left_wall = [&](int top) {
    return picture.Around(IsDark, Box{24, 300, top + 270, top + 280}).left;
  };
  EXPECT_NEAR(left_wall(44 + 550 + 44), 20 + 30, 2);
  EXPECT_NEAR(left_wall(44), 20 + 30 + 50, 2);
}

TEST_F(BeforeAfterPictureTest, TallMapsLieSideBySide) {
  const SlamGraph graph = MakeGraph(Pillar(10.0, 20.0));
  const Picture picture = Draw(graph, graph.initial_poses());
  EXPECT_NEAR(picture.width, 2 * (550 + 20) + 20, 4);
  EXPECT_NEAR(picture.height, 44 + 1060 + 56, 3);
  // Poses and points are at the truth: both maps are the same.
  const int step = (picture.width - 20) / 2;
  for (int y = 60; y < 1090; y += 7) {
    for (int x = 22; x < 565; ++x) {
      ASSERT_EQ(picture.rgb[y * picture.width + x], picture.rgb[y * picture.width + x + step]);
    }
  }
}

TEST_F(BeforeAfterPictureTest, LargeMapsTakeCoarserPixelsOfANiceSize) {
  const SlamGraph graph = MakeGraph(Pillar(79.0, 60.0));
  options_.max_side_px = 1000;  // 83.7 m: 10 cm.
  EXPECT_NEAR(Draw(graph, graph.initial_poses()).width, 837 + 40, 3);
}

TEST_F(BeforeAfterPictureTest, TheSameInputGivesTheSameBytes) {
  const SlamGraph graph = MakeGraph(Pillar(10.0, 8.0));
  Draw(graph, graph.initial_poses());
  const std::string first = ReadFile(path_);
  Draw(graph, graph.initial_poses());
  EXPECT_EQ(ReadFile(path_), first);
  EXPECT_EQ(NumFilesIn(folder_), 1);
}

TEST_F(BeforeAfterPictureTest, AGraphWithoutScansAndPointsThatAreNotFiniteAreDrawn) {
  SlamGraph graph;
  graph.AddPose({7.0, 7.0, 0.0}, 0.0);
  EXPECT_GT(Draw(graph, graph.initial_poses()).width, 300);
  graph = MakeGraph(Pillar(10.0, 8.0));
  MapState state = graph.InitialState();
  state.points[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(Draw(graph, state, graph.initial_poses()).width, 550 + 40, 3);
}

TEST_F(BeforeAfterPictureTest, BadInputIsRefused) {
  const SlamGraph graph = MakeGraph(Pillar(10.0, 8.0));
  const MapState sound = graph.InitialState();
  MapState bad = sound;
  EXPECT_THAT(ErrorOf(SlamGraph(), {}, {}), HasSubstr("no poses"));
  EXPECT_THAT(ErrorOf(graph, sound, {1.0, 2.0, 3.0}), HasSubstr("1 poses before, 4 after"));
  bad.poses[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ErrorOf(graph, sound, bad.poses), HasSubstr("pose 1 is not finite"));
  EXPECT_THAT(ErrorOf(graph, bad, sound.poses), HasSubstr("pose 1 is not finite"));
  options_.max_side_px = 99;
  EXPECT_THAT(ErrorOf(graph, sound, sound.poses), HasSubstr("max_side_px = 99"));
  options_.max_side_px = 1000;
  bad = sound;
  bad.poses[0] = 1e200;
  EXPECT_THAT(ErrorOf(graph, bad, bad.poses), HasSubstr("from the origin"));
  BeforeAfterPicture picture;
  ASSERT_TRUE(picture.Gather(graph, sound, sound.poses, options_).ok());
  EXPECT_EQ(picture.Draw(folder_ + "none/a.png").code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
