#include "plumbline/apps/io/clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(ClockTest, TimesThatTellEntriesApartHaveNoFault) {
  EXPECT_EQ(ClockFault({}), "");
  EXPECT_EQ(ClockFault({0.0}), "");
  EXPECT_EQ(ClockFault({1.0, 2.0}), "");
  EXPECT_EQ(ClockFault({3.0, 1.0, 2.0, 2.0}), "");
  EXPECT_EQ(ClockFault({1.0, 1.0, 2.0, 2.0, 3.0, 3.0}), "");  // two lasers
  // To the microsecond that files keep, also late in the age of Unix.
  EXPECT_EQ(ClockFault({1.7e9, 1.7e9 + 3e-6, 1.7e9 + 6e-6, 1.7e9 + 9e-6}), "");
}

TEST(ClockTest, TimesThatDoNotTellEntriesApartAreUseless) {
  EXPECT_EQ(ClockFault({5.0, 5.0}), "its clock is useless: 1 different time for 2 entries");
  EXPECT_EQ(ClockFault(std::vector<double>(237, 0.0)),
            "its clock is useless: 1 different time for 237 entries");
  // A clock that stops on the way.
  EXPECT_EQ(ClockFault({-0.4, -0.9, 4e9, 4e9, 4e9, 4e9, 4e9}),
            "its clock is useless: 3 different times for 7 entries");
  // One that only knows whole seconds.
  EXPECT_EQ(ClockFault({1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0}),
            "its clock is useless: 3 different times for 7 entries");
}

TEST(ClockTest, TimesAreThoseOfThePoses) {
  SlamGraph graph;
  for (const double time_s : {3.0, 1.0}) graph.AddPose(Pose2(), time_s);
  EXPECT_THAT(graph.timestamps_s(), ElementsAre(3.0, 1.0));
  EXPECT_THAT(TimesOf(TrajectoryOf(graph, graph.InitialState())), ElementsAre(3.0, 1.0));
}

class ChoosePairingTest : public testing::Test {
 protected:
  Status Choose(const std::vector<double>& a, const std::vector<double>& b) {
    return ChoosePairing({"a.tum", a}, {"b.clf", b}, 1e-3, &pairing_);
  }
  Pairing pairing_;
};

TEST_F(ChoosePairingTest, GoodClocksPairByTime) {
  ASSERT_TRUE(Choose({1.0, 2.0, 3.0}, {2.0, 3.0}).ok());
  EXPECT_FALSE(pairing_.by_order);
  ASSERT_TRUE(Choose({1.0, 2.0, 3.0}, {1.0, 3.0, 2.0}).ok());
  EXPECT_FALSE(pairing_.by_order);
  EXPECT_FALSE(pairing_.clock_is_useless);
}

TEST_F(ChoosePairingTest, TheSameTimesPairByOrder) {
  ASSERT_TRUE(Choose({1.0, 1.0, 2.0, 3.0}, {1.0, 1.0004, 2.0, 3.0}).ok());
  EXPECT_TRUE(pairing_.by_order);
  EXPECT_FALSE(pairing_.clock_is_useless);
  ASSERT_TRUE(Choose({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}).ok());
  EXPECT_TRUE(pairing_.by_order);
  EXPECT_TRUE(pairing_.clock_is_useless);
}

TEST_F(ChoosePairingTest, AUselessClockAndOtherTimesLeaveThePairsOpen) {
  pairing_.by_order = true;
  const Status status = Choose({0.0, 0.0, 0.0}, {0.0, 0.0});
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), AllOf(StartsWith("a.tum: its clock is useless: 1 different time "),
                                      HasSubstr("b.clf has not the same times")));
  EXPECT_THAT(Choose({1.0, 2.0, 3.0}, {2.0, 2.0, 2.0}).message(),
              AllOf(StartsWith("b.clf: its clock is useless"), HasSubstr("a.tum has not")));
  EXPECT_TRUE(pairing_.by_order);  // untouched
}

}  // namespace
}  // namespace plumbline
