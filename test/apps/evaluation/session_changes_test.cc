#include "plumbline/apps/evaluation/session_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/test/apps/two_sessions.h"
#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<Face> Cabinet(double x, double y, double side) {
  return Rectangle({x, y}, {x + side, y + side});
}

std::vector<SessionChange> ChangesBetween(const std::vector<Face>& first,
                                          const std::vector<Face>& second) {
  const TwoSessions sessions = MakeTwoSessions(first, second);
  std::vector<SessionChange> changes;
  const Status status = FindSessionChanges(sessions.graph, sessions.graph.InitialState(),
                                           sessions.marks, OccupancyGridOptions(), &changes);
  EXPECT_TRUE(status.ok()) << status.message();
  return changes;
}

TEST(SessionChangesTest, FindsWhatWasMoved) {
  const std::vector<SessionChange> changes =
      ChangesBetween(Cabinet(0.0, 0.5, 0.6), Cabinet(0.5, 2.0, 0.6));
  ASSERT_THAT(changes, SizeIs(2));
  const Eigen::Vector2d middles[] = {{0.3, 0.8}, {0.8, 2.3}};
  for (int day = 0; day < 2; ++day) {
    const SessionChange& change = changes[day];
    EXPECT_EQ(change.shown_by, day);
    EXPECT_THAT(change.looked_through_by, ElementsAre(1 - day));
    // The sides that the robot sees.
    EXPECT_LT((change.center - middles[day]).norm(), 0.35);
    EXPECT_NEAR(change.size_m, 0.6, 0.11);
    EXPECT_GT(change.points.size(), 20u);
    for (const Eigen::Vector2d& point : change.points) {
      EXPECT_LT((point - middles[day]).lpNorm<Eigen::Infinity>(), 0.36);
    }
  }
}

TEST(SessionChangesTest, ProcessesFindThemTogether) {
  const std::vector<Face> first = Cabinet(0.0, 0.5, 0.6), second = Cabinet(0.5, 2.0, 0.6);
  const std::vector<SessionChange> expected = ChangesBetween(first, second);
  ASSERT_THAT(expected, SizeIs(2));
  const TwoSessions sessions = MakeTwoSessions(first, second);
  RunOnParts(sessions.graph, 2, [&](const SlamGraph& part) {
    ASSERT_LT(part.num_scans(), sessions.graph.num_scans());
    std::vector<SessionChange> changes;
    ASSERT_TRUE(FindSessionChanges(part, part.InitialState(), sessions.marks,
                                   OccupancyGridOptions(), &changes)
                    .ok());
    ASSERT_EQ(changes.size(), expected.size());
    for (std::size_t i = 0; i < changes.size(); ++i) {
      EXPECT_EQ(changes[i].shown_by, expected[i].shown_by);
      EXPECT_EQ(changes[i].looked_through_by, expected[i].looked_through_by);
      EXPECT_EQ(changes[i].center, expected[i].center);
      EXPECT_EQ(changes[i].points, expected[i].points);
    }
  });
}

TEST(SessionChangesTest, WhatStaysIsNoChange) {
  EXPECT_THAT(ChangesBetween(Cabinet(0.0, 0.5, 0.6), Cabinet(0.0, 0.5, 0.6)), IsEmpty());
}

TEST(SessionChangesTest, WhatIsHiddenIsNoChange) {
  // Behind the cabinet.
  std::vector<Face> one = Cabinet(0.0, 0.9, 1.0), other = one;
  const std::vector<Face> hidden = Cabinet(1.3, 1.2, 0.4);
  other.insert(other.end(), hidden.begin(), hidden.end());
  EXPECT_THAT(ChangesBetween(one, other), IsEmpty());
}

TEST(SessionChangesTest, LegsAreNoChange) {
  EXPECT_THAT(ChangesBetween(Cabinet(0.0, 0.5, 0.1), {}), IsEmpty());
}

TEST(SessionChangesTest, FailsAsTheGridDoes) {
  const TwoSessions sessions = MakeTwoSessions({}, {});
  OccupancyGridOptions options;
  options.max_cells = 10.0;
  std::vector<SessionChange> changes;
  EXPECT_EQ(FindSessionChanges(sessions.graph, sessions.graph.InitialState(), sessions.marks,
                               options, &changes)
                .code(),
            StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace plumbline
