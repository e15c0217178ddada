#include "plumbline/apps/figures/choose_details.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace plumbline {
namespace {

// Walls along x, each 2 m long and seen twice; `before` has some of them doubled.
struct Maps {
  std::vector<double> before, after;

  void AddWall(double x, double y, double gap_m, int passes = 2) {
    for (int pass = 0; pass < passes; ++pass) {
      for (int i = 0; i < 200; ++i) {
        after.insert(after.end(), {x + 0.01 * i, y});
        before.insert(before.end(), {x + 0.01 * i, y + (pass % 2) * gap_m});
      }
    }
  }
};

bool Holds(const MapWindow& window, double x, double y) {
  return std::abs(x - window.center_m.x()) <= 0.5 * window.width_m &&
         std::abs(y - window.center_m.y()) <= 0.5 * window.height_m;
}

TEST(ChooseDetailsTest, TheLargestDifferencesComeFirst) {
  Maps maps;
  maps.AddWall(0.1, 0.1, 0.02);
  maps.AddWall(20.1, 5.1, 0.2);
  maps.AddWall(-30.1, -9.1, 0.1);
  maps.AddWall(50.1, 0.1, 0.0, 20);  // Seen often, and the same in both.
  const std::vector<MapWindow> details = ChooseDetails(maps.before, maps.after, 2, 4.0);
  ASSERT_EQ(details.size(), 2u);
  for (double x : {20.1, 22.0}) EXPECT_TRUE(Holds(details[0], x, 5.1));
  for (double x : {-30.1, -28.2}) EXPECT_TRUE(Holds(details[1], x, -9.1));
  EXPECT_EQ(details[0].width_m, 4.0);
  EXPECT_EQ(details[0].height_m, 4.0);
}

TEST(ChooseDetailsTest, HowOftenAWallWasSeenDoesNotCount) {
  Maps maps;
  maps.AddWall(0.1, 0.1, 0.02, 40);
  maps.AddWall(20.1, 0.1, 0.1, 2);
  EXPECT_TRUE(Holds(ChooseDetails(maps.before, maps.after, 1, 3.0)[0], 21.0, 0.1));
}

TEST(ChooseDetailsTest, WindowsDoNotOverlapAndEndWithTheDifferences) {
  Maps maps;
  for (int i = 0; i < 4; ++i) maps.AddWall(2.0 * i, 0.1, 0.1);
  const std::vector<MapWindow> details = ChooseDetails(maps.before, maps.after, 20, 2.0);
  EXPECT_GE(details.size(), 3u);  // 8 m of wall
  EXPECT_LT(details.size(), 20u);
  for (std::size_t i = 0; i < details.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector2d apart = (details[i].center_m - details[j].center_m).cwiseAbs();
      EXPECT_GE(apart.maxCoeff(), 2.0);
    }
  }
}

TEST(ChooseDetailsTest, AMovedMapIsNoDifference) {
  Maps maps;
  maps.AddWall(0.1, 0.1, 0.0);
  maps.AddWall(10.1, 0.1, 0.1);
  for (double& value : maps.before) value += 3.0;
  const std::vector<MapWindow> details = ChooseDetails(maps.before, maps.after, 5, 2.0);
  ASSERT_FALSE(details.empty());
  for (const MapWindow& window : details) EXPECT_FALSE(Holds(window, 1.0, 0.1));
}

TEST(ChooseDetailsTest, EqualMapsHaveNoneAndWhatIsNotFiniteDoesNotCount) {
  Maps maps;
  maps.AddWall(0.1, 0.1, 0.0);
  EXPECT_TRUE(ChooseDetails(maps.after, maps.after, 2, 3.0).empty());
  EXPECT_TRUE(ChooseDetails({}, {}, 2, 3.0).empty());
  maps.before[0] = std::numeric_limits<double>::quiet_NaN();
  maps.after[3] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(ChooseDetails(maps.before, maps.after, 2, 3.0).empty());
}

}  // namespace
}  // namespace plumbline
