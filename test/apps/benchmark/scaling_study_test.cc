#include "plumbline/apps/benchmark/scaling_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(ScalingStudyTest, ASmallCaseImprovesOnItsStart) {
  const ScalingOutcome there = RunScalingCaseInChild(400, SolverOptions());
  ASSERT_EQ(there.failure, "");
  EXPECT_EQ(there.num_scans, 400);
  EXPECT_GT(there.num_returns, 400u * 290);
  EXPECT_LE(there.num_returns, 400u * 300);
  EXPECT_GT(there.num_rounds, 0);
  EXPECT_GT(there.cpu_time_s, 0.0);
  EXPECT_GE(there.num_steps, there.num_rounds);
  EXPECT_GE(there.num_linear_iterations, there.num_steps);
  EXPECT_GT(there.num_observations, there.num_landmarks);
  EXPECT_GT(there.num_landmarks, 100u);
  EXPECT_GT(there.pose_error_before_m, 0.01);
  EXPECT_LT(there.pose_error_before_m, 0.1);
  EXPECT_LT(there.pose_error_after_m, 0.2 * there.pose_error_before_m);
  EXPECT_LT(there.step_error_after_m, there.step_error_before_m);
  EXPECT_GT(there.step_error_after_m, 0.0);
  EXPECT_GE(there.peak_memory_bytes, there.graph_memory_bytes);
  EXPECT_GT(there.graph_memory_bytes, 40 * there.num_returns);

  const ScalingOutcome here = RunScalingCase(400, SolverOptions());
  EXPECT_EQ(here.num_returns, there.num_returns);
  EXPECT_EQ(here.pose_error_after_m, there.pose_error_after_m);
}

TEST(ScalingStudyTest, AFailureIsTold) {
  SolverOptions options;
  options.num_threads = 0;
  const ScalingOutcome outcome = RunScalingCaseInChild(20, options);
  EXPECT_THAT(outcome.failure, HasSubstr("num_threads"));
  EXPECT_THAT(ScalingRow(outcome), HasSubstr("      20  failed: "));
  const std::string path = TempFolder() + "scaling.csv";
  ASSERT_TRUE(WriteScalingCsv(path, {outcome}).ok());
  EXPECT_THAT(ReadFile(path), HasSubstr(outcome.failure + "\",,,,"));
}

TEST(ScalingStudyTest, ADriveTooShortForStepsHasNoStepError) {
  const ScalingOutcome outcome = RunScalingCaseInChild(20, SolverOptions());
  ASSERT_EQ(outcome.failure, "");
  EXPECT_TRUE(std::isnan(outcome.step_error_before_m));
  EXPECT_THAT(ScalingRow(outcome), HasSubstr(" -       -\n"));
}

TEST(ScalingStudyTest, TableAndFileHoldTheFigures) {
  ScalingOutcome outcome;
  outcome.num_scans = 1000;
  outcome.num_returns = 500000;
  outcome.time_s = 2.0;
  outcome.peak_memory_bytes = 60000000;
  outcome.pose_error_after_m = 0.00125;
  EXPECT_THAT(ScalingRow(outcome),
              AllOf(HasSubstr(" 4.000 "), HasSubstr(" 120 "), HasSubstr(" 1.25 ")));
  const std::string path = TempFolder() + "scaling.csv";
  ASSERT_TRUE(WriteScalingCsv(path, {outcome}).ok());
  EXPECT_THAT(ReadFile(path), AllOf(StartsWith("scans,failure,returns,"),
                                    HasSubstr("\n1000,\"\",500000,0,0,2,0,")));
}

TEST(ScalingStudyTest, ReadsNumbersOfScans) {
  std::vector<int> counts;
  ASSERT_TRUE(ParseScanCounts("1000,3000", &counts).ok());
  EXPECT_THAT(counts, ElementsAre(1000, 3000));
  for (const char* text : {"", "1000,", "1000,x", "0", "-5", "3.5", "1e3", "99999999999"}) {
    EXPECT_EQ(ParseScanCounts(text, &counts).code(), StatusCode::kInvalidArgument) << text;
  }
  EXPECT_THAT(ParseScanCounts("10,many", &counts).message(), HasSubstr("'many'"));
  EXPECT_THAT(counts, ElementsAre(1000, 3000));
}

}  // namespace
}  // namespace plumbline
