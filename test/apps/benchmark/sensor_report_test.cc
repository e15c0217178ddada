#include "plumbline/apps/benchmark/sensor_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

SensorOutcome Run(int case_index, std::uint64_t seed, double seed_m, double refined_m) {
  SensorOutcome run;
  run.case_index = case_index;
  run.seed = seed;
  run.num_scans = 100;
  run.outlier_share = 0.25;
  run.floor_m = 0.003;
  run.seeded.error = run.refined.error = TruthError{};
  run.seeded.error->mean_pose_error_m = seed_m;
  run.refined.error->mean_pose_error_m = refined_m;
  run.refined.error->max_pose_error_m = 2.0 * refined_m;
  return run;
}

std::vector<SensorCase> TwoCases() {
  std::vector<SensorCase> cases(2);
  cases[0].group = "base";
  cases[0].name = "plain";
  cases[1].group = "range";
  cases[1].name = "short";
  cases[1].simulation.laser.max_range_m = 4.0;
  return cases;
}

// Seed 2 of the second case fails.
std::vector<SensorOutcome> Outcomes() {
  return {Run(0, 1, 0.010, 0.001), Run(0, 2, 0.020, 0.003), Run(0, 3, 0.030, 0.002),
          Run(1, 1, 0.010, 0.004), Run(1, 2, 0.010, 0.450)};
}

TEST(SensorReportTest, TheTableHasMediansTheWorstAndTheFailures) {
  const std::string table = SensorTable(TwoCases(), Outcomes());
  std::istringstream lines(table);
  std::string base, line;
  while (std::getline(lines, line)) {
    if (line.find("  plain") == 0) base = line;
  }
  std::istringstream row(base);
  std::string name;
  double outliers, seed, refined, worst;
  row >> name >> outliers >> seed >> refined >> worst;
  EXPECT_EQ(outliers, 25.0);
  EXPECT_EQ(seed, 20.0);
  EXPECT_EQ(refined, 2.0);
  EXPECT_EQ(worst, 3.0);
  EXPECT_THAT(table, HasSubstr("Failed: range, short, seed 2: mean pose error 10.0 -> 450.0 mm, "
                               "greatest 0.0 -> 900.0 mm, without a warning\n"));
  EXPECT_THAT(table, Not(HasSubstr("Failed: base")));
}

TEST(SensorReportTest, TheCsvHasOneLinePerRun) {
  const std::string path = testing::TempDir() + "sensors.csv";
  ASSERT_TRUE(WriteSensorCsv(path, TwoCases(), Outcomes()).ok());
  const std::string csv = ReadFile(path);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6);
  EXPECT_THAT(csv, AllOf(HasSubstr("group,case,seed,scans,outlier_share,seed_pose_error_m,"),
                         HasSubstr("\"base\",\"plain\",2,100,0.25,0.02,"),
                         HasSubstr(",alarm,worse,silently_lost\n")));
  EXPECT_FALSE(WriteSensorCsv("/nowhere/sensors.csv", TwoCases(), Outcomes()).ok());
}

TEST(SensorReportTest, TheJsonHasTheRunsOfEachCase) {
  const std::string path = testing::TempDir() + "sensors.json";
  ASSERT_TRUE(WriteSensorJson(path, TwoCases(), Outcomes()).ok());
  const nlohmann::json json = nlohmann::json::parse(ReadFile(path));
  ASSERT_EQ(json["cases"].size(), 2u);
  EXPECT_EQ(json["lost_m"], 0.5);
  const nlohmann::json& last = json["cases"][1];
  EXPECT_EQ(last["max_range_m"], 4.0);
  ASSERT_EQ(last["runs"].size(), 2u);
  EXPECT_EQ(last["runs"][1]["worse"], true);
  EXPECT_EQ(last["runs"][1]["silently_lost"], true);
  EXPECT_EQ(last["runs"][1]["refined"]["pose_error_m"], 0.45);
  EXPECT_EQ(last["runs"][0]["worse"], false);
}

}  // namespace
}  // namespace plumbline
