#include "plumbline/apps/benchmark/sensor_matrix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

using testing::HasSubstr;

TEST(SensorMatrixTest, CasesHaveNamesOfTheirOwnAndChangeTheBase) {
  const std::vector<SensorCase> cases = SensorCases();
  EXPECT_GE(cases.size(), 25u);
  std::set<std::pair<std::string, std::string>> names;
  for (const SensorCase& sensor : cases) names.insert({sensor.group, sensor.name});
  EXPECT_EQ(names.size(), cases.size());
  EXPECT_EQ(cases.front().group, "base");
  for (const SensorCase& sensor : cases) {
    const LaserModel& laser = sensor.simulation.laser;
    std::string error;
    EXPECT_TRUE(sensor.simulation.Check(&error)) << sensor.name << ": " << error;
    // Both ends of the field of view are as far off straight ahead; a full turn lacks its last
    // beam.
    const double last = laser.Bearing(laser.num_beams - 1);
    const double gap = 2.0 * kPi - std::abs(last - laser.first_bearing_rad);
    if (gap > 0.02) {
      EXPECT_NEAR(last, -laser.first_bearing_rad, 1e-9) << sensor.name;
    } else {
      EXPECT_NEAR(gap, laser.bearing_step_rad, 1e-9) << sensor.name;
    }
  }
}

Stage StageWith(double mean_m, double max_m) {
  Stage stage;
  stage.error = TruthError{};
  stage.error->mean_pose_error_m = mean_m;
  stage.error->max_pose_error_m = max_m;
  return stage;
}

TEST(SensorMatrixTest, FailsByWhatIsWorseOrSilentlyLost) {
  SensorOutcome run;
  run.floor_m = 0.005;
  run.seeded = StageWith(0.010, 0.02);
  run.refined = StageWith(0.0149, 0.4);
  EXPECT_FALSE(run.Failed());
  run.refined = StageWith(0.0151, 0.4);
  EXPECT_TRUE(run.IsWorse());
  EXPECT_FALSE(run.IsSilentlyLost());
  run.refined = StageWith(0.009, 0.6);
  EXPECT_FALSE(run.IsWorse());
  EXPECT_TRUE(run.IsSilentlyLost());
  run.alarm = true;
  EXPECT_FALSE(run.Failed());
  // A warning is no excuse for spoiling the seed.
  run.refined = StageWith(0.1, 0.6);
  EXPECT_TRUE(run.Failed());
}

TEST(SensorMatrixTest, ACaseThatCannotBeDrivenIsNamed) {
  std::vector<SensorCase> cases(1, SensorCases().front());
  cases[0].simulation.drive.robot_radius_m = 2.0;
  ThreadPool pool(1);
  std::vector<SensorOutcome> outcomes(3);
  const Status status =
      RunSensorCases(cases, 1, SolverOptions(), SeedingOptions(), &pool, &outcomes);
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.message(), HasSubstr("base, 180 deg, 0.5 deg, 30 m, 12 mm, seed 1: "));
  EXPECT_EQ(outcomes.size(), 3u);
}

// What the whole matrix shows, in short: every kind of change once.
TEST(SensorMatrixTest, NoOtherScannerSpoilsTheMap) {
  struct Bound {
    const char* group;
    const char* name;
    double pose_m;  // mean error of the refined poses
  };
  constexpr Bound kBounds[] = {{"beam step", "1 deg", 0.006},
                               {"greatest range", "4 m", 0.02},
                               {"mounting", "beams from left to right", 0.004},
                               {"few scans", "one per 1 m", 0.006},
                               {"things that move", "4 people, doors", 0.006},
                               {"shape potential", "slanted", 0.006}};
  std::vector<SensorCase> chosen;
  for (const Bound& bound : kBounds) {
    for (const SensorCase& sensor : SensorCases()) {
      if (sensor.group == bound.group && sensor.name == bound.name) chosen.push_back(sensor);
    }
  }
  ASSERT_EQ(chosen.size(), std::size(kBounds));
  ThreadPool pool(2);
  std::vector<SensorOutcome> outcomes;
  const Status status =
      RunSensorCases(chosen, 1, SolverOptions(), SeedingOptions(), &pool, &outcomes);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(outcomes.size(), chosen.size());
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const SensorOutcome& run = outcomes[i];
    EXPECT_EQ(run.case_index, static_cast<int>(i));
    EXPECT_FALSE(run.Failed()) << kBounds[i].name;
    EXPECT_LT(run.refined.error->mean_pose_error_m, kBounds[i].pose_m) << kBounds[i].name;
    EXPECT_LT(run.refined.quality.wall_thickness_m, run.seeded.quality.wall_thickness_m);
  }
  EXPECT_LT(outcomes[0].outlier_share, 0.01);
  EXPECT_GT(outcomes[4].outlier_share, 0.05);  // people and doors
}

}  // namespace
}  // namespace plumbline
