#include "plumbline/solvers/front_end/correlative_matcher.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

TEST(CorrelativeMatcher, FindsTheBestPoseOfAWideWindow) {
  SyntheticScene scene = Room();
  const Pose2 truth(1.3, -0.9, 0.5);
  scene.poses = {Pose2(), truth};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  const CorrelativeMatcher matcher(surfaces[0], 0.1, 2.0);
  const CorrelativeMatch match = matcher.Search(surfaces[1], {Pose2(), 2.0, 0.6}, 0.3);
  ASSERT_TRUE(match.found);
  EXPECT_LT(DistanceM(match.map_from_scan, truth), 0.15);
  EXPECT_NEAR(match.map_from_scan.yaw, truth.yaw, 0.05);
  EXPECT_GT(match.score, 0.6);
}

// Branch and bound must lose nothing: compare with a search whose windows are single poses.
TEST(CorrelativeMatcher, AgreesWithExhaustiveSearch) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.4, 0.3, 0.0)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  const CorrelativeMatcher matcher(surfaces[0], 0.1, 0.9);
  double best = 0.0;
  for (int y = -9; y <= 9; ++y) {
    for (int x = -9; x <= 9; ++x) {
      const SearchWindow pose{{0.1 * x, 0.1 * y, 0.0}, 0.0, 0.0};
      best = std::max(best, matcher.Search(surfaces[1], pose, 0.0).score);
    }
  }
  const CorrelativeMatch match = matcher.Search(surfaces[1], {Pose2(), 0.9, 0.0}, 0.0);
  // A pose on the edge of two cells may round either way.
  EXPECT_NEAR(match.score, best, 0.02);
}

TEST(CorrelativeMatcher, FindsTheSameInAWiderWindowThanItWasMadeFor) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(1.3, -0.9, 0.5)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  const SearchWindow window{Pose2(), 2.0, 0.6};
  const CorrelativeMatch wide =
      CorrelativeMatcher(surfaces[0], 0.1, 2.0).Search(surfaces[1], window, 0.3);
  const CorrelativeMatch narrow =
      CorrelativeMatcher(surfaces[0], 0.1, 0.0).Search(surfaces[1], window, 0.3);
  ASSERT_TRUE(wide.found);
  ASSERT_TRUE(narrow.found);
  EXPECT_NEAR(narrow.score, wide.score, 0.01);
  EXPECT_LT(DistanceM(narrow.map_from_scan, wide.map_from_scan), 0.11);
}

TEST(CorrelativeMatcher, SecondPeakIsThereOnlyInTwinRooms) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.2, 0.1, 0.0)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  SurfacePoints twins = surfaces[0];
  for (const SurfacePoint& point : surfaces[0]) twins.push_back(Pose2(5.0, 0.0, 0.0) * point);
  const SearchWindow window{Pose2(), 6.0, 0.3};
  for (const bool twin : {false, true}) {
    const CorrelativeMatcher matcher(twin ? twins : surfaces[0], 0.1, 6.0);
    const CorrelativeMatch best = matcher.Search(surfaces[1], window, 0.3);
    ASSERT_TRUE(best.found);
    EXPECT_EQ(matcher.SearchPeaks(surfaces[1], window, 0.9 * best.score, 2, {0.7, 0.3}).size(),
              twin ? 2u : 1u);
  }
}

TEST(CorrelativeMatcher, FindsAllPeaksTheBestFirst) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.2, 0.1, 0.0)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  SurfacePoints twins = surfaces[0];
  for (std::size_t i = 0; i < surfaces[0].size(); ++i) {  // the other one lacks some of its walls
    if (i % 8 != 0) twins.push_back(Pose2(5.0, 0.0, 0.0) * surfaces[0][i]);
  }
  const SearchWindow window{Pose2(), 6.0, 0.3};
  const CorrelativeMatcher matcher(twins, 0.1, 6.0);
  const PeakSize size{0.7, 0.3};
  const CorrelativeMatch best = matcher.Search(surfaces[1], window, 0.3);
  const std::vector<CorrelativeMatch> peaks =
      matcher.SearchPeaks(surfaces[1], window, 0.7 * best.score, 5, size);
  ASSERT_EQ(peaks.size(), 2u);
  EXPECT_EQ(DistanceM(peaks[0].map_from_scan, best.map_from_scan), 0.0);
  EXPECT_EQ(peaks[0].score, best.score);
  EXPECT_LE(peaks[1].score, peaks[0].score);
  EXPECT_NEAR(DistanceM(peaks[1].map_from_scan, peaks[0].map_from_scan), 5.0, 0.15);
  const std::vector<CorrelativeMatch> one =
      matcher.SearchPeaks(surfaces[1], window, 0.7 * best.score, 1, size);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].score, best.score);
  EXPECT_TRUE(matcher.SearchPeaks({}, window, 0.1, 5, size).empty());
}

TEST(CorrelativeMatcher, AFullTurnIsNoSecondPeak) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.2, 0.1, 0.0)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  const CorrelativeMatcher matcher(surfaces[0], 0.1, 200.0);
  const SearchWindow window{Pose2(0.0, 0.0, 3.0), 200.0, 8.0};
  const CorrelativeMatch best = matcher.Search(surfaces[1], window, 0.3);
  ASSERT_TRUE(best.found);
  EXPECT_LT(DistanceM(best.map_from_scan, scene.poses[1]), 0.15);
  EXPECT_EQ(matcher.SearchPeaks(surfaces[1], window, 0.9 * best.score, 2, {0.7, 0.3}).size(), 1u);
}

TEST(CorrelativeMatcher, FindsNothingInAnEmptyMapOrForAnEmptyScan) {
  const SurfacePoints point{{{1.0, 0.0}, {-1.0, 0.0}}};
  EXPECT_FALSE(CorrelativeMatcher({}, 0.1, 1.0).Search(point, {Pose2(), 1.0, 0.1}, 0.1).found);
  EXPECT_FALSE(CorrelativeMatcher(point, 0.1, 1.0).Search({}, {Pose2(), 1.0, 0.1}, 0.1).found);
}

TEST(CorrelativeMatcher, GivesUpWhereEverythingFitsALittle) {
  // Bushes: points all over the place, of which a third lies near those of any other.
  SurfacePoints bushes, others;
  std::uint32_t state = 1;
  const auto draw = [&state] {
    state = state * 1664525u + 1013904223u;
    return 40.0 * (state >> 8) / 16777216.0 - 20.0;
  };
  for (int i = 0; i < 6000; ++i) {
    const double x = draw(), y = draw();
    SurfacePoints& points = i % 3 == 0 ? others : bushes;
    points.push_back({Eigen::Vector2d(x, y), Eigen::Vector2d(1.0, 0.0)});
  }
  const CorrelativeMatcher matcher(bushes, 0.1, 15.0);
  const CorrelativeMatch match = matcher.Search(others, {Pose2(), 15.0, 0.5}, 0.2);
  EXPECT_TRUE(match.gave_up);
  for (const CorrelativeMatch& peak :
       matcher.SearchPeaks(others, {Pose2(), 15.0, 0.5}, 0.2, 2, {0.5, 0.1})) {
    EXPECT_TRUE(peak.gave_up);
  }
  // Where it fits, that is soon found.
  const CorrelativeMatch same = matcher.Search(bushes, {Pose2(1.0, 1.0, 0.0), 2.0, 0.1}, 0.4);
  EXPECT_TRUE(same.found);
  EXPECT_FALSE(same.gave_up);
}

}  // namespace
}  // namespace plumbline
