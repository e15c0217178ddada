#include "plumbline/apps/run/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace plumbline {
namespace {

using testing::MatchesRegex;

TEST(ProgressBarTest, RedirectedOutputGetsALineAtEveryTenth) {
  std::ostringstream out;
  ProgressBar bar("Seeding", /*on_terminal=*/false, &out);
  for (int done = 0; done <= 1000; ++done) bar.Update(done, 1000);
  std::string expected;
  for (int percent = 10; percent <= 100; percent += 10) {
    expected += "Seeding: " + std::to_string(percent) + " %\n";
  }
  EXPECT_EQ(out.str(), expected);
}

TEST(ProgressBarTest, RareUpdatesAreShownOnce) {
  std::ostringstream out;
  ProgressBar bar("Seeding", false, &out);
  for (const int done : {1, 5, 5, 6}) bar.Update(done, 7);
  EXPECT_EQ(out.str(), "Seeding: 10 %\nSeeding: 70 %\nSeeding: 80 %\n");
}

TEST(ProgressBarTest, ATerminalGetsOneLineThatIsRedrawn) {
  std::ostringstream out;
  ProgressBar bar("Seeding", /*on_terminal=*/true, &out);
  bar.Update(0, 8);
  bar.Update(2, 8);
  bar.Update(8, 8);
  const std::string dots(40, '.'), hashes(40, '#');
  EXPECT_EQ(out.str(), "\rSeeding [" + dots + "]   0 %" +                                     //
                           "\rSeeding [" + hashes.substr(30) + dots.substr(10) + "]  25 %" +  //
                           "\rSeeding [" + hashes + "] 100 %");
}

TEST(ProgressBarTest, FinishTellsTheResultAndTheTime) {
  std::ostringstream redirected, terminal;
  ProgressBar("Seeding", false, &redirected).Finish("817 scans/s");
  EXPECT_THAT(redirected.str(), MatchesRegex("Seeding: 817 scans/s \\([0-9]+\\.[0-9][0-9] s\\)\n"));
  ProgressBar("Seeding", true, &terminal).Finish("817 scans/s");
  EXPECT_EQ(terminal.str().substr(0, 4), "\r\033[K");
}

TEST(ProgressBarTest, NothingToDoShowsNothing) {
  std::ostringstream out;
  ProgressBar("Seeding", true, &out).Update(0, 0);
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace plumbline
