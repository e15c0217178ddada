#include "plumbline/apps/io/occupancy_scores.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

using testing::ElementsAre;

std::vector<std::int32_t> Row(const OccupancyScores& scores, int y) {
  std::vector<std::int32_t> row;
  scores.Row(y, &row);
  return row;
}

void AddOutline(const std::vector<Eigen::Vector2d>& corners, OccupancyScores* scores) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    scores->AddEdge(corners[i], corners[(i + 1) % corners.size()]);
  }
}

TEST(OccupancyScoresTest, ACellTakesWhatIsAddedToIt) {
  OccupancyScores scores(3, 2);
  scores.AddToCell({0.0, 0.0}, 5);
  scores.AddToCell({2.9, 1.9}, 3);
  scores.AddToCell({2.1, 1.1}, 3);  // The same scan comes back.
  scores.BeginScan();
  scores.AddToCell({2.1, 1.1}, -1);
  for (const Eigen::Vector2d& outside :
       {Eigen::Vector2d(-0.1, 0.5), {3.0, 0.5}, {0.5, -1e11}, {0.5, 2.0}}) {
    scores.AddToCell(outside, 7);
  }
  EXPECT_THAT(Row(scores, 0), ElementsAre(5, 0, 0));
  EXPECT_THAT(Row(scores, 1), ElementsAre(0, 0, 2));
}

TEST(OccupancyScoresTest, ALineGoesThroughEveryCellItTouches) {
  OccupancyScores scores(4, 3);
  scores.AddToLine({0.5, 0.9}, {3.5, 2.2}, 1);  // Not the cell (0, 0) it comes from.
  EXPECT_THAT(Row(scores, 0), ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(Row(scores, 1), ElementsAre(1, 1, 1, 1));
  EXPECT_THAT(Row(scores, 2), ElementsAre(0, 0, 0, 1));
  scores.BeginScan();
  scores.AddToLine({3.5, 2.2}, {3.5, -9.0}, 1);  // Straight down, out of the grid.
  EXPECT_THAT(Row(scores, 0), ElementsAre(0, 0, 0, 1));
  EXPECT_THAT(Row(scores, 1), ElementsAre(1, 1, 1, 2));
  EXPECT_THAT(Row(scores, 2), ElementsAre(0, 0, 0, 1));
}

TEST(OccupancyScoresTest, LinesInAnyDirectionAreClosed) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(0.0, 20.0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d a(uniform(engine), uniform(engine)), b(uniform(engine), uniform(engine));
    OccupancyScores scores(20, 20);
    scores.AddToCell(a, 1);
    scores.AddToLine(a, b, 1);
    int count = 0;
    for (int y = 0; y < 20; ++y) {
      for (const std::int32_t score : Row(scores, y)) {
        ASSERT_TRUE(score == 0 || score == 1);
        count += score;
      }
    }
    // As many cells as a path of side-by-side cells from the first to the last one has.
    EXPECT_EQ(count, 1 + std::abs(std::floor(b.x()) - std::floor(a.x())) +
                         std::abs(std::floor(b.y()) - std::floor(a.y())));
    EXPECT_EQ(Row(scores, static_cast<int>(b.y()))[static_cast<int>(b.x())], 1);
  }
}

TEST(OccupancyScoresTest, AnOutlineCountsTheCentresInIt) {
  OccupancyScores scores(4, 3);
  AddOutline({{0.6, 0.4}, {0.6, 2.6}, {2.6, 2.6}, {2.6, 0.4}}, &scores);  // clockwise
  EXPECT_THAT(Row(scores, 0), ElementsAre(0, 1, 1, 0));
  EXPECT_THAT(Row(scores, 2), ElementsAre(0, 1, 1, 0));
  AddOutline({{-1e9, 1.0}, {1e9, 1.0}, {1e9, 2.0}, {-1e9, 2.0}}, &scores);  // the other way round
  EXPECT_THAT(Row(scores, 1), ElementsAre(-1, 0, 0, -1));
  EXPECT_THAT(Row(scores, 2), ElementsAre(0, 1, 1, 0));
}

TEST(OccupancyScoresTest, OutlinesOfAnyShapeFillWhatIsInside) {
  constexpr int kSides[] = {20, 130};  // less than a block, and more than two
  std::mt19937 engine(6);
  for (int i = 0; i < 100; ++i) {
    const int size = kSides[i % 2];
    std::uniform_real_distribution<double> uniform(-0.25 * size, 1.25 * size);
    const Eigen::Vector2d a(uniform(engine), uniform(engine)), b(uniform(engine), uniform(engine)),
        c(uniform(engine), uniform(engine));
    OccupancyScores scores(size, size);
    AddOutline({a, b, c}, &scores);
    const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q,
                         const Eigen::Vector2d& r) {
      return (q - p).x() * (r - p).y() - (q - p).y() * (r - p).x();
    };
    for (int y = 0; y < size; ++y) {
      const std::vector<std::int32_t> row = Row(scores, y);
      ASSERT_EQ(row.size(), static_cast<std::size_t>(size));
      for (int x = 0; x < size; ++x) {
        const Eigen::Vector2d centre(x + 0.5, y + 0.5);
        const double ab = side(a, b, centre), bc = side(b, c, centre), ca = side(c, a, centre);
        const int expected = ab < 0 && bc < 0 && ca < 0 ? 1 : ab > 0 && bc > 0 && ca > 0 ? -1 : 0;
        EXPECT_EQ(row[x], expected) << x << ' ' << y;
      }
    }
  }
}

// What a process with a share of the outlines, or with all of them, has.
OccupancyScores SomeOutlines(int first, int step) {
  OccupancyScores scores(200, 100);
  for (int i = first; i < 12; i += step) {
    const double x = 15.0 * i, y = 5.0 * i;
    AddOutline({{x, y}, {x, y + 40.0}, {x + 30.0, y + 40.0}, {x + 30.0, y}}, &scores);
    scores.BeginScan();
    scores.AddToLine({x, y}, {x + 30.0, y + 20.0}, 3);
  }
  return scores;
}

TEST(OccupancyScoresTest, ProcessesAddUpTheirsForAllOrForOne) {
  const OccupancyScores whole = SomeOutlines(0, 1);
  const std::vector<std::int32_t> nothing(200, 0);
  for (const int receiver : {OccupancyScores::kEveryRank, 0, 2}) {
    RunOnPeers(3, [&](const Peers& peers) {
      OccupancyScores scores = SomeOutlines(peers.rank(), 3);
      const bool receives = receiver == OccupancyScores::kEveryRank || receiver == peers.rank();
      EXPECT_EQ(scores.AddThoseOf(&peers, receiver), receives);
      for (int y = 0; y < 100; ++y) {
        EXPECT_EQ(Row(scores, y), receives ? Row(whole, y) : nothing) << y;
      }
    });
  }
  EXPECT_NE(Row(whole, 50), nothing);
}

}  // namespace
}  // namespace plumbline
