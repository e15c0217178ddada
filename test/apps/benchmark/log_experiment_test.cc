#include "plumbline/apps/benchmark/log_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/log_report.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/carmen_writer.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// A few scans through a building, their true relations, and the log as a mapper corrects it that
// gets the heading wrong by a hair.
class LogExperimentTest : public testing::Test {
 protected:
  void SetUp() override {
    SimulationOptions options;
    options.scan_period_s = 0.6;
    options.laser.num_beams = 180;
    options.laser.bearing_step_rad = DegToRad(1.0);
    SimulatedLog log;
    ASSERT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
    log.scans.resize(60);
    ASSERT_TRUE(WriteCarmenLog(folder_ + "raw.clf", log).ok());
    std::string relations;
    for (std::size_t i = 0; i + 20 < log.scans.size(); i += 5) {
      const SimulatedScan &from = log.scans[i], &to = log.scans[i + 20];
      const Pose2 motion = Between(from.world_from_robot, to.world_from_robot);
      char line[200];
      std::snprintf(line, sizeof(line), "%.6f %.6f %.9f %.9f 0 0 0 %.9f\n", from.scan.timestamp_s,
                    to.scan.timestamp_s, motion.x, motion.y, motion.yaw);
      relations += line;
    }
    WriteFile(folder_ + "true.relations", relations);
    for (std::size_t i = 0; i < log.scans.size(); ++i) {
      log.scans[i].odom_from_robot = log.scans[i].world_from_robot * Pose2(0.0, 0.0, 0.01);
    }
    ASSERT_TRUE(WriteCarmenLog(folder_ + "corrected.clf", log).ok());
    inputs_.log = folder_ + "raw.clf";
    inputs_.relations = folder_ + "true.relations";
    inputs_.corrected_log = folder_ + "corrected.clf";
    inputs_.solver.published.max_passes = 20;
  }

  LogExperiment Run() {
    LogExperiment experiment;
    const Status status = RunLogExperiment(inputs_, {}, &experiment);
    EXPECT_TRUE(status.ok()) << status.message();
    return experiment;
  }

  static std::vector<std::string> Names(const std::vector<LogStage>& stages) {
    std::vector<std::string> names;
    for (const LogStage& stage : stages) names.push_back(stage.name);
    return names;
  }

  static double Error(const LogStage& stage) { return stage.relations->all.translation_m.mean; }

  const std::string folder_ = TempFolder();
  LogExperimentInputs inputs_;
};

TEST_F(LogExperimentTest, EveryMethodIsMeasuredAndTheJointEstimateIsBest) {
  const LogExperiment experiment = Run();
  EXPECT_EQ(experiment.log, "raw.clf");
  ASSERT_EQ(experiment.starts.size(), 3u);
  const std::vector<LogStage>& stages = experiment.starts[0].stages;
  const std::vector<std::string> names = Names(stages);
  EXPECT_THAT(names,
              ElementsAre("odometry", "pairwise ICP, point to point", "pairwise ICP, point to line",
                          "global ICP", "published method, from that",
                          "gradient descent (SGD) on its pose graph", "seed (pose graph)",
                          "published method, from the seed", "refined"));
  for (const LogStage& stage : stages) {
    EXPECT_EQ(stage.relations->all.num_matched, 8u);
    EXPECT_EQ(stage.points.has_value(),
              stage.name == "refined" || stage.name.find("published") == 0);
  }
  for (std::size_t i = 1; i < stages.size(); ++i) {
    // Point-to-point matching may well do worse than a good odometry.
    if (i > 1) {
      EXPECT_LT(Error(stages[i]), 0.7 * Error(stages[0])) << names[i];
    }
    EXPECT_LE(Error(stages.back()), Error(stages[i])) << names[i];
  }
  EXPECT_LT(Error(stages.back()), 0.01);
  // A heading that is 0.01 rad off: the map is worse. Both methods thin it, ours repairs it.
  const std::vector<LogStage>& corrected = experiment.starts[1].stages;
  EXPECT_EQ(experiment.starts[1].num_scans, 60);
  ASSERT_THAT(Names(corrected),
              ElementsAre("as corrected", "published method, from the corrected poses", "refined"));
  EXPECT_LT(Error(corrected[2]), 0.5 * Error(corrected[0]));
  for (const LogStage& stage : {corrected[1], corrected[2]}) {
    EXPECT_LT(Error(stage), Error(corrected[0])) << stage.name;
    EXPECT_LT(stage.points->radii[0].quality.wall_thickness_m,
              corrected[0].raw_ranges.radii[0].quality.wall_thickness_m);
  }
  // The scans of the corrected log from the raw odometry: the same methods.
  EXPECT_EQ(Names(experiment.starts[2].stages), names);
  EXPECT_LT(Error(experiment.starts[2].stages.back()), 0.01);
  // The figure: three baselines and the result, at poses that lie upon each other.
  std::vector<std::string> titles;
  for (const MapPanel& panel : experiment.maps.panels) titles.push_back(panel.title);
  ASSERT_THAT(titles, ElementsAre("ICP", "SG", "published", "Plumbline"));
  for (const MapPanel& panel : experiment.maps.panels) {
    for (std::size_t i = 0; i < panel.trajectory.size(); ++i) {
      const Pose2 difference =
          Between(experiment.maps.panels.back().trajectory[i], panel.trajectory[i]);
      EXPECT_LT(difference.translation().norm(), 0.3) << panel.title;
    }
  }
}

TEST_F(LogExperimentTest, FilesHaveNoTimesAndDoNotDependOnThreads) {
  std::vector<std::string> contents;
  for (const int num_threads : {1, 3}) {
    inputs_.solver.num_threads = num_threads;
    inputs_.solver.published.max_passes = 1;  // of many seconds each
    const LogExperiment experiment = Run();
    ASSERT_TRUE(WriteLogJson(folder_ + "a.json", experiment).ok());
    ASSERT_TRUE(WriteLogRelationsCsv(folder_ + "r.csv", experiment).ok());
    ASSERT_TRUE(WriteLogSharpnessCsv(folder_ + "s.csv", experiment).ok());
    MapFigureOptions options;
    options.width_px = 600;
    ASSERT_TRUE(WriteMapFigure(folder_ + "m.png", experiment.maps, options).ok());
    contents.push_back(ReadFile(folder_ + "a.json") + ReadFile(folder_ + "r.csv") +
                       ReadFile(folder_ + "s.csv") + ReadFile(folder_ + "m.png"));
  }
  EXPECT_TRUE(contents[0] == contents[1]);
  EXPECT_THAT(ReadFile(folder_ + "r.csv"),
              StartsWith("start,stage,relations,mean_m,std_m,mean_deg,std_deg,matched,unmatched\n"
                         "\"raw log\",\"odometry\",all,"));
  EXPECT_THAT(ReadFile(folder_ + "s.csv"), HasSubstr("\"raw log\",\"refined\",optimised,0.15,"));
  const auto json = nlohmann::json::parse(ReadFile(folder_ + "a.json"));
  EXPECT_EQ(json["starts"][1]["stages"][2]["relations"]["all"]["matched"], 8);
  EXPECT_TRUE(json["published"].empty());
}

TEST_F(LogExperimentTest, WithoutRelationsOnlySharpnessIsGiven) {
  inputs_.relations = inputs_.corrected_log = "";
  const LogExperiment experiment = Run();
  EXPECT_EQ(experiment.starts.size(), 1u);
  const std::string tables = LogTables(experiment);
  EXPECT_THAT(tables, HasSubstr("refined, points"));
  EXPECT_THAT(tables, Not(HasSubstr("relations")));
}

TEST_F(LogExperimentTest, FaultyInputIsToldBeforeTheWork) {
  int num_stages = 0;
  const auto count = [&num_stages](const LogStart&, const LogStage&) { ++num_stages; };
  LogExperiment experiment;
  inputs_.corrected_log = folder_ + "none";
  EXPECT_EQ(RunLogExperiment(inputs_, count, &experiment).code(), StatusCode::kNotFound);
  inputs_.corrected_log = "";
  inputs_.relations = folder_ + "raw.clf";
  EXPECT_FALSE(RunLogExperiment(inputs_, count, &experiment).ok());
  EXPECT_EQ(num_stages, 0);
  EXPECT_TRUE(experiment.starts.empty());
}

}  // namespace
}  // namespace plumbline
