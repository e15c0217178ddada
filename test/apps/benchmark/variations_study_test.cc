#include "plumbline/apps/benchmark/variations_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumbline/test/apps/benchmark/known_drive.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

VariationOutcome Outcome(const std::string& variation, double error_m, bool has_alarm) {
  VariationOutcome outcome;
  outcome.log = "hall";
  outcome.variation = variation;
  outcome.num_scans = 50;
  outcome.num_relations = 40;
  outcome.error_m = error_m;
  outcome.reference_error_m = 0.01;
  outcome.has_alarm = has_alarm;
  outcome.seeding_s = 0.25;
  return outcome;
}

std::vector<const LogVariation*> Parse(const std::string& names) {
  std::vector<const LogVariation*> variations;
  const Status status = ParseVariations(names, &variations);
  EXPECT_TRUE(status.ok()) << status.message();
  return variations;
}

TEST(VariationsStudyTest, RelationsAreBesideTheLog) {
  EXPECT_EQ(RelationsBeside("fr079.clf.gz"), "fr079.relations");
  EXPECT_EQ(RelationsBeside("/a.clf/b.log"), "/a.clf/b.relations");
  EXPECT_EQ(RelationsBeside("c/d"), "c/d.relations");
}

TEST(VariationsStudyTest, AMissingFileIsNamed) {
  const std::string folder = TempFolder();
  std::vector<KnownLog> logs;
  EXPECT_THAT(ReadKnownLogs({folder + "a.clf"}, &logs).message(), HasSubstr(folder + "a.clf"));
  WriteFile(folder + "a.clf", "FLASER 2 1 1 0 0 0 0 0 0 5 host 5\n");
  EXPECT_EQ(ReadKnownLogs({folder + "a.clf"}, &logs).message(),
            folder + "a.clf: its relations are missing; want '" + folder + "a.relations'");
  WriteFile(folder + "a.relations", "5 5 0 0 0 0 0 0\n");
  ASSERT_TRUE(ReadKnownLogs({folder + "a.clf"}, &logs).ok());
  EXPECT_EQ(logs.front().name, "a");
  EXPECT_EQ(logs.front().log.scans.size(), 1u);
  EXPECT_EQ(logs.front().relations.size(), 1u);
}

TEST(VariationsStudyTest, VariationsHaveNames) {
  EXPECT_EQ(Parse("all").size(), LogVariations().size());
  ASSERT_EQ(Parse("mirror,late").size(), 2u);
  EXPECT_STREQ(Parse("mirror,late").front()->name, "mirror");
  std::vector<const LogVariation*> variations;
  EXPECT_THAT(
      ParseVariations("late,sideways", &variations).message(),
      AllOf(HasSubstr("'sideways'"), HasSubstr("all, same, late,"), HasSubstr("no_odometry")));
  EXPECT_FALSE(ParseVariations("", &variations).ok());
  EXPECT_FALSE(ParseVariations("late,,gaps", &variations).ok());
}

TEST(VariationsStudyTest, OnlyRandomVariationsAreRepeated) {
  std::vector<std::string> runs;
  for (const VariationCase& run : VariationCases(2, Parse("mirror,same,late"), 2, 5)) {
    runs.push_back(std::to_string(run.log) + run.variation->name + std::to_string(run.seed));
  }
  EXPECT_THAT(runs, ElementsAre("0same5", "0mirror5", "0late5", "0late6", "1same5", "1mirror5",
                                "1late5", "1late6"));
}

TEST(VariationsStudyTest, AMapIsRightUpToALimit) {
  EXPECT_TRUE(Outcome("late", 0.0169, false).IsRight());
  EXPECT_FALSE(Outcome("late", 0.0171, false).IsRight());
  EXPECT_FALSE(Outcome("late", std::nan(""), false).IsRight());
}

TEST(VariationsStudyTest, TheTablesCountRightAndWrongMaps) {
  std::vector<VariationOutcome> outcomes = {Outcome("late", 0.01, false),
                                            Outcome("late", 0.01, true), Outcome("late", 1.0, true),
                                            Outcome("mirror", 1.0, false)};
  outcomes.back().log = "floor";
  const std::string table = VariationsTable(outcomes);
  EXPECT_THAT(table, AllOf(StartsWith("variation "), Not(HasSubstr("early"))));
  EXPECT_THAT(table, ContainsRegex("late +3 +1 +1 +1 +0 +66.7 +0.0 +0.8 +0.0\n"));
  EXPECT_THAT(table, ContainsRegex("mirror +1 +0 +0 +0 +1 +0.0 "));
  EXPECT_THAT(table, ContainsRegex("\nhall +3 .*\nfloor +1 .*\nall +4 +1 +1 +1 +1 +50.0 "));
  EXPECT_THAT(VariationRow(outcomes[0]),
              ContainsRegex("hall +late +1 +50 +40 +0.0100 +0.0100  right, quiet +0.25\n"));
  EXPECT_THAT(VariationRow(outcomes[1]), HasSubstr("right, warned"));
  EXPECT_THAT(VariationRow(outcomes[2]), HasSubstr("wrong, warned"));
  EXPECT_THAT(VariationRow(outcomes[3]), HasSubstr("wrong, SILENT"));
}

TEST(VariationsStudyTest, WritesALinePerRun) {
  const std::string path = TempFolder() + "variations.csv";
  ASSERT_TRUE(WriteVariationsCsv(path, {Outcome("late", 0.5, true)}).ok());
  EXPECT_EQ(ReadFile(path),
            "log,variation,seed,scans,relations,error_m,seed_error_m,reference_error_m,right,alarm,"
            "seed_alarm,matching_s,seeding_s,time_s\n"
            "hall,late,1,50,40,0.5,0,0.01,0,1,0,0,0.25,0\n");
}

class VariationsStudyRunTest : public testing::Test {
 protected:
  Status Run(const std::string& variations, int num_threads) {
    ThreadPool pool(num_threads);
    rows_.clear();
    return RunVariationsStudy(
        logs_, VariationCases(logs_.size(), Parse(variations), 1, 1), MapLogOptions(),
        [this](const VariationOutcome& outcome) {
          rows_.push_back(outcome.log + " " + outcome.variation);
        },
        &pool, &outcomes_);
  }

  std::vector<KnownLog> logs_ = {MakeKnownDrive(30, 90)};
  std::vector<VariationOutcome> outcomes_;
  std::vector<std::string> rows_;
};

TEST_F(VariationsStudyRunTest, OutcomesDoNotDependOnTheNumberOfThreads) {
  logs_.push_back(logs_.front());
  logs_.back().name = "again";
  ASSERT_TRUE(Run("mirror,early", 1).ok());
  const std::vector<VariationOutcome> outcomes = outcomes_;
  const std::vector<std::string> rows = rows_;
  EXPECT_THAT(rows, ElementsAre("drive same", "drive mirror", "drive early", "again same",
                                "again mirror", "again early"));
  ASSERT_TRUE(Run("mirror,early", 3).ok());
  EXPECT_EQ(rows_, rows);
  ASSERT_EQ(outcomes_.size(), rows.size());
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    SCOPED_TRACE(rows[i]);
    EXPECT_EQ(outcomes_[i].error_m, outcomes[i].error_m);
    EXPECT_EQ(outcomes_[i].error_m, outcomes[i % 3].error_m);
    EXPECT_EQ(outcomes_[i].reference_error_m, outcomes[i].reference_error_m);
    EXPECT_TRUE(outcomes[i].IsRight()) << outcomes[i].error_m;
    EXPECT_LT(outcomes[i].error_m, 0.05);
    EXPECT_LE(outcomes[i].matching_s, outcomes[i].seeding_s);
    EXPECT_LE(outcomes[i].seeding_s, outcomes[i].time_s);
  }
  EXPECT_EQ(outcomes[0].error_m, outcomes[0].reference_error_m);
  EXPECT_EQ(outcomes[0].num_scans, 30);
  EXPECT_EQ(outcomes[0].num_relations, logs_[0].relations.size());
  EXPECT_LT(outcomes[2].num_relations, outcomes[0].num_relations);
}

TEST_F(VariationsStudyRunTest, AVariationThatLeavesTooLittleIsNamedBeforeTheFirstMap) {
  logs_.front().log.scans.resize(11);  // of one relation
  EXPECT_THAT(Run("mirror,early", 1).message(), HasSubstr("drive, variation early: "));
  EXPECT_TRUE(rows_.empty());
}

TEST_F(VariationsStudyRunTest, AVariationWithoutReturnsIsNamed) {
  for (CarmenScan& scan : logs_.front().log.scans) {
    for (double& range : scan.ranges) range += 8.0;
  }
  EXPECT_THAT(Run("range8", 1).message(),
              HasSubstr("drive, variation range8, seed 1: no scan has a return"));
}

}  // namespace
}  // namespace plumbline
