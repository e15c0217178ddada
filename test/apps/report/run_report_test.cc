#include "plumbline/apps/report/run_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using testing::ElementsAre;

TEST(RunReportTest, SumsUpARun) {
  RunSummary summary;
  summary.log = "some/folder/a.clf.gz";
  summary.num_scans = 1234;
  summary.num_returns = 1000000;
  summary.num_skipped_records = 2;
  summary.read_time_s = 0.5;
  summary.mapping.seeding.loops.num_closures = 3;
  summary.mapping.seeding.loops.matches.resize(4);
  for (LoopClosureRecord& match : summary.mapping.seeding.loops.matches) {
    match.outcome = ClosureOutcome::kAccepted;
  }
  summary.mapping.seeding.loops.matches[0].outcome = ClosureOutcome::kLowOverlap;
  const HtmlReport report = MakeRunReport(summary);
  EXPECT_EQ(report.title, "a.clf.gz");
  EXPECT_EQ(report.subtitle, "1,234 scans, 1,000,000 returns, 2 records skipped");
  EXPECT_TRUE(report.alarms.empty());
  EXPECT_NE(report.all_clear, "");
  EXPECT_EQ(report.durations[0].time_s, 0.5);
  ASSERT_EQ(report.tables[0].title, "Loop closures");
  ASSERT_EQ(report.tables[0].rows.size(), 2u);
  EXPECT_THAT(report.tables[0].rows[0], ElementsAre("accepted", "3"));
  EXPECT_THAT(report.tables[0].rows[1], ElementsAre("low overlap", "1"));
}

}  // namespace
}  // namespace plumbline
