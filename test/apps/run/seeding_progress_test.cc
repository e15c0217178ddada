#include "plumbline/apps/run/seeding_progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace plumbline {
namespace {

using testing::MatchesRegex;

constexpr char kTime[] = " \\([0-9]+\\.[0-9][0-9] s\\)\n";

TEST(SeedingBarsTest, EveryRoundOfLoopClosingHasABarThatIsFinished) {
  std::ostringstream out;
  SeedingBars bars(/*on_terminal=*/false, &out);
  for (const int done : {0, 100, 200}) bars.Update(SeedingPhase::kMatchingScans, done, 250);
  for (const int done : {0, 64}) bars.Update(SeedingPhase::kClosingLoops, done, 80);
  // Rounds of a single report each.
  bars.Update(SeedingPhase::kClosingLoops, 0, 40);
  bars.Update(SeedingPhase::kClosingLoops, 0, 0);  // only asks whether to stop
  bars.Update(SeedingPhase::kClosingLoops, 0, 30);
  bars.Finish();
  const std::string time = kTime;
  EXPECT_THAT(out.str(), MatchesRegex("Matching scans: 40 %\n"
                                      "Matching scans: 80 %\n"
                                      "Matching scans: 250 scans" +
                                      time +
                                      "Closing loops, round 1: 80 %\n"
                                      "Closing loops, round 1: 80 places tried" +
                                      time + "Closing loops, round 2: 40 places tried" + time +
                                      "Closing loops, round 3: 30 places tried" + time));
}

TEST(SeedingBarsTest, EachSessionHasRoundsOfItsOwn) {
  std::ostringstream out;
  SeedingBars bars(/*on_terminal=*/false, &out);
  for (int session = 0; session < 2; ++session) {
    bars.Update(SeedingPhase::kMatchingScans, 0, 50);
    bars.Update(SeedingPhase::kClosingLoops, 0, 40);
  }
  for (const int done : {0, 0, 1, 1, 1}) bars.Update(SeedingPhase::kTyingSessions, done, 2);
  bars.Finish();
  const std::string time = kTime;
  const std::string session =
      "Matching scans: 50 scans" + time + "Closing loops, round 1: 40 places tried" + time;
  EXPECT_THAT(out.str(), MatchesRegex(session + session +
                                      "Comparing sessions: 50 %\nComparing sessions: done" + time));
}

TEST(SeedingBarsTest, OnATerminalNoBarIsLeftBehind) {
  std::ostringstream out;
  SeedingBars bars(/*on_terminal=*/true, &out);
  bars.Update(SeedingPhase::kMatchingScans, 0, 250);
  bars.Update(SeedingPhase::kClosingLoops, 0, 80);
  bars.Finish();
  const std::string dots(40, '.');  // match themselves
  EXPECT_THAT(
      out.str(),
      MatchesRegex("\rMatching scans \\[" + dots + "\\]   0 %\r\033\\[KMatching scans: 250 scans" +
                   kTime + "\rClosing loops, round 1 \\[" + dots +
                   "\\]   0 %\r\033\\[KClosing loops, round 1: 80 places tried" + kTime));
}

TEST(SeedingBarsTest, NothingToFinishShowsNothing) {
  std::ostringstream out;
  SeedingBars bars(false, &out);
  bars.Finish();
  bars.Update(SeedingPhase::kMatchingScans, 0, 3);
  bars.Finish();
  bars.Finish();
  EXPECT_THAT(out.str(), MatchesRegex(std::string("Matching scans: 3 scans") + kTime));
}

}  // namespace
}  // namespace plumbline
