#include "plumbline/apps/benchmark/sessions_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

SessionsOutcome Outcome(int num_tied, int num_wrong_ties, double max_error_m, bool has_alarm) {
  SessionsOutcome outcome;
  outcome.num_tied = num_tied;
  outcome.num_wrong_ties = num_wrong_ties;
  outcome.max_error_m = max_error_m;
  outcome.has_alarm = has_alarm;
  outcome.mean_error_m = 0.004;
  outcome.floor_m = 0.003;
  return outcome;
}

TEST(SessionsStudyTest, CasesCountSeedsWithARepetitiveBuildingInSix) {
  const std::vector<SessionsCase> cases = SessionsCases(7, 7);
  ASSERT_EQ(cases.size(), 7u);
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(cases[i].building, i == 5 ? BuildingKind::kRepetitive : BuildingKind::kRandom);
    EXPECT_EQ(cases[i].seed, 7u + i);
  }
}

TEST(SessionsStudyTest, OnlyWhatIsTiedRightIsComplete) {
  EXPECT_TRUE(Outcome(5, 0, 0.14, false).IsComplete());
  EXPECT_TRUE(Outcome(4, 0, 0.14, false).IsRight());  // one apart is no error
  EXPECT_FALSE(Outcome(4, 0, 0.14, false).IsComplete());
  EXPECT_FALSE(Outcome(5, 0, 0.16, false).IsRight());
  EXPECT_FALSE(Outcome(5, 5, 0.01, false).IsRight());
}

TEST(SessionsStudyTest, TheTableCountsWhatBecameOfTheRuns) {
  const std::string table = SessionsTable({Outcome(5, 0, 0.02, false), Outcome(4, 0, 0.02, true),
                                           Outcome(5, 0, 0.3, true), Outcome(5, 1, 0.02, false)});
  const std::string row = table.substr(table.find("\nall") + 1);
  // Runs, all tied, right, right with an alarm, wrong with one, wrong and silent, errors.
  EXPECT_THAT(row, testing::ContainsRegex("all +4 +1 +2 +1 +1 +1 +4.0 +3.0"));
}

TEST(SessionsStudyTest, WritesALinePerRun) {
  const std::string path = TempFolder() + "sessions_study.csv";
  ASSERT_TRUE(WriteSessionsCsv(path, {Outcome(5, 0, 0.02, true)}).ok());
  const std::string text = ReadFile(path);
  EXPECT_THAT(text, StartsWith("building,seed,visits,scans,tied,"));
  EXPECT_THAT(text, HasSubstr("random,1,5,0,5,0,1,0.02,0.004,0.003,1,"));
}

TEST(SessionsStudyTest, TwoDaysAreTiedAndAnotherBuildingIsNot) {
  SessionsCase run;
  run.num_visits = 2;
  std::vector<SessionsOutcome> outcomes;
  ThreadPool pool(1);
  ASSERT_TRUE(RunSessionsStudy({run}, MapLogOptions(), &pool, &outcomes).ok());
  const SessionsOutcome& outcome = outcomes.front();
  EXPECT_TRUE(outcome.IsComplete()) << outcome.num_tied << ", " << outcome.max_error_m;
  EXPECT_FALSE(outcome.has_alarm);
  EXPECT_GT(outcome.num_scans, 500);
  EXPECT_LT(outcome.mean_error_m, 1.2 * outcome.floor_m + 1e-3);

  MapLogOptions refused;
  refused.solver.num_threads = 2;
  refused.solver.factors.beam.sigma_range_m = -1.0;
  EXPECT_FALSE(RunSessionsStudy({run}, refused, &pool, &outcomes).ok());
}

}  // namespace
}  // namespace plumbline
