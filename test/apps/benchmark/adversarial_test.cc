#include "plumbline/apps/benchmark/adversarial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

AdversarialOutcome Outcome(double before_m, double after_m, double wall_after_m,
                           bool returned = false) {
  AdversarialOutcome outcome;
  outcome.run = {Attack::kPeople, 0.3, 1};
  outcome.floor_m = 0.002;
  outcome.before = {before_m, 0.0, 0.010, -4.0};
  outcome.after = {after_m, 0.0, wall_after_m, -4.0 + 10.0 * (wall_after_m - 0.010)};
  outcome.summary.termination =
      returned ? TerminationType::kNoImprovement : TerminationType::kConverged;
  return outcome;
}

TEST(AdversarialTest, WorseMeansBeyondWhatNoiseLeaves) {
  EXPECT_FALSE(Outcome(0.010, 0.002, 0.010).PosesAreWorse());
  EXPECT_FALSE(Outcome(0.010, 0.0115, 0.010).PosesAreWorse());
  EXPECT_TRUE(Outcome(0.010, 0.0125, 0.010).PosesAreWorse());
  EXPECT_FALSE(Outcome(0.010, 0.010, 0.00999).MapIsBlurrier());
  EXPECT_TRUE(Outcome(0.010, 0.010, 0.012).MapIsBlurrier());
}

TEST(AdversarialTest, TableCountsWhatCameOfTheRuns) {
  const std::string table =
      AdversarialTable({Outcome(0.010, 0.002, 0.008), Outcome(0.010, 0.020, 0.012),
                        Outcome(0.010, 0.010, 0.010, true)});
  const std::size_t row = table.find("graph: people 0.3");
  ASSERT_NE(row, std::string::npos);
  std::istringstream cells(table.substr(row + std::string("graph: people 0.3").size()));
  std::vector<std::string> words(9);
  for (std::string& word : words) cells >> word;
  EXPECT_THAT(words, testing::ElementsAre("3", "10.0", "10.0", "10.0", "10.0", "1", "0", "1", "1"));
}

TEST(AdversarialTest, EverySeedMeetsEveryAttack) {
  const std::vector<AdversarialCase> cases = AdversarialCases(3);
  EXPECT_GE(cases.size(), 100u);
  for (int attack = 0; attack <= static_cast<int>(Attack::kRepeatedScan); ++attack) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      EXPECT_TRUE(std::any_of(cases.begin(), cases.end(), [&](const AdversarialCase& run) {
        return run.attack == static_cast<Attack>(attack) && run.seed == seed && !run.seeded;
      })) << ToString(static_cast<Attack>(attack));
    }
  }
}

TEST(AdversarialTest, CsvHasALinePerRun) {
  const std::string path = TempFolder() + "adversarial.csv";
  ASSERT_TRUE(WriteAdversarialCsv(path, {Outcome(0.01, 0.002, 0.008)}).ok());
  const std::string text = ReadFile(path);
  EXPECT_THAT(text, HasSubstr("\npeople,0.3,1,0,0.002,0.01,0.002,"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_FALSE(WriteAdversarialCsv("/no/such/folder/x.csv", {}).ok());
}

TEST(AdversarialTest, OptionsThatAreRefusedAreNamed) {
  SolverOptions options;
  options.reduced.max_rounds = 0;
  AdversarialOutcome outcome;
  const Status status = RunAdversarialCase({Attack::kNone, 0.0, 2}, options, &outcome);
  EXPECT_THAT(status.message(), HasSubstr("max_rounds"));
}

TEST(AdversarialTest, TheNumberOfThreadsDoesNotCount) {
  const std::vector<AdversarialCase> cases = {{Attack::kNone, 0.0, 2}, {Attack::kPeople, 0.1, 2}};
  std::vector<AdversarialOutcome> one, two;
  for (std::vector<AdversarialOutcome>* outcomes : {&one, &two}) {
    ThreadPool pool(outcomes == &one ? 1 : 2);
    ASSERT_TRUE(RunAdversarialStudy(cases, SolverOptions(), &pool, outcomes).ok());
  }
  EXPECT_EQ(AdversarialTable(one), AdversarialTable(two));
}

}  // namespace
}  // namespace plumbline
