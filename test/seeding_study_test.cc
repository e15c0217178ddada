#include "plumbline/apps/benchmark/seeding_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <tuple>

#include "plumbline/test/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

SeedingOutcome Outcome(Jump jump, double max_error_m, bool alarm, bool repaired = false) {
  SeedingOutcome outcome;
  outcome.run.jump = jump;
  outcome.max_error_m = max_error_m;
  outcome.alarm = alarm;
  outcome.repaired = repaired;
  return outcome;
}

// The cells of the line of a table that starts with `name`, after it.
std::string RowOf(const std::string& table, const std::string& name) {
  std::istringstream lines(table.substr(table.find("\n" + name) + 1 + name.size()));
  std::string line, cell, row;
  std::getline(lines, line);
  std::istringstream cells(line);
  while (cells >> cell) row += (row.empty() ? "" : " ") + cell;
  return row;
}

TEST(SeedingStudyTest, CasesCoverEachCombination) {
  const std::vector<SeedingCase> cases = SeedingCases(48);
  std::set<std::tuple<BuildingKind, Jump, double>> combinations;
  int num_jumps = 0;
  for (const SeedingCase& run : cases) {
    combinations.insert({run.building, run.jump, run.odometry_factor});
    if (run.jump == Jump::kNone) continue;
    ++num_jumps;
    EXPECT_GE(run.jump_m, 0.5);
    EXPECT_LE(run.jump_m, 6.0);
  }
  EXPECT_EQ(combinations.size(), 18u);
  EXPECT_EQ(num_jumps, 24);
}

TEST(SeedingStudyTest, TableCountsRightAndWrongWithAndWithoutAlarm) {
  const std::string table = SeedingTable(
      {Outcome(Jump::kNone, 0.02, false), Outcome(Jump::kNone, 0.14, false),
       Outcome(Jump::kNone, 0.02, true), Outcome(Jump::kNone, 0.16, true),
       Outcome(Jump::kCarried, 2.0, false), Outcome(Jump::kInjected, 0.03, false, true),
       Outcome(Jump::kInjected, 3.0, true)});
  // Runs; right and quiet, false alarm; wrong and alarm, wrong and silent; repaired; right.
  EXPECT_EQ(RowOf(table, "random      none"), "4 2 1 1 0 0 75.0 %");
  EXPECT_EQ(RowOf(table, "random      carried"), "1 0 0 0 1 0 0.0 %");
  EXPECT_EQ(RowOf(table, "random      injected"), "2 1 0 1 0 1 50.0 %");
  EXPECT_EQ(RowOf(table, "repetitive  none"), "0 0 0 0 0 0 0.0 %");
  EXPECT_EQ(RowOf(table, "all"), "7 3 1 2 1 1 57.1 %");
}

TEST(SeedingStudyTest, WritesOneLinePerRun) {
  const std::string path = TempFolder() + "study.csv";
  SeedingOutcome outcome = Outcome(Jump::kInjected, 2.5, true);
  outcome.run.seed = 3;
  outcome.run.jump_m = 1.25;
  ASSERT_TRUE(WriteSeedingCsv(path, {outcome}).ok());
  const std::string csv = ReadFile(path);
  EXPECT_THAT(csv, StartsWith("building,seed,odometry_factor,jump,jump_m,"));
  EXPECT_THAT(csv, HasSubstr("\nrandom,3,1,injected,1.25,0,0,0,0,2.5,0,1,0,0\n"));
}

TEST(SeedingStudyTest, ASilentJumpIsNotMistakenForAGoodMap) {
  // The two shortest drives.
  SeedingCase healthy;
  healthy.building = BuildingKind::kRepetitive;
  healthy.seed = 3;
  SeedingCase falsified = healthy;
  falsified.jump = Jump::kInjected;
  falsified.jump_m = 3.0;
  falsified.jump_share = 0.4;
  std::vector<SeedingOutcome> on_two, on_one;
  ThreadPool two(2), one(1);
  const std::vector<SeedingCase> cases = {healthy, falsified};
  ASSERT_TRUE(RunSeedingStudy(cases, SeedingOptions(), FactorOptions(), &two, &on_two).ok());
  ASSERT_EQ(on_two.size(), 2u);
  EXPECT_TRUE(on_two[0].IsRight()) << on_two[0].max_error_m;
  EXPECT_FALSE(on_two[0].alarm);
  EXPECT_TRUE(on_two[1].alarm || (on_two[1].repaired && on_two[1].IsRight()))
      << on_two[1].max_error_m;
  EXPECT_EQ(on_two[0].path_length_m, on_two[1].path_length_m);

  ASSERT_TRUE(RunSeedingStudy(cases, SeedingOptions(), FactorOptions(), &one, &on_one).ok());
  for (int i = 0; i < 2; ++i) EXPECT_EQ(on_one[i].max_error_m, on_two[i].max_error_m);
}

TEST(SeedingStudyTest, RefusesBadOptions) {
  SeedingOptions options;
  options.point_spacing_m = 0.0;
  SeedingOutcome outcome;
  EXPECT_EQ(RunSeedingCase(SeedingCase(), options, FactorOptions(), &outcome).code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(outcome.num_scans, 0);
}

}  // namespace
}  // namespace plumbline
