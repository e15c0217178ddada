#include "plumbline/apps/benchmark/online_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(OnlineRunTest, FeedsADriveAndMeasuresThePosesWhenTheyAreGiven) {
  SimulationOptions options;
  options.scan_period_s = 1.0;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  SimulatedLog log;
  ASSERT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
  log.scans.resize(100);
  // The odometry is reset once.
  for (std::size_t i = 50; i < log.scans.size(); ++i) {
    log.scans[i].odom_from_robot = Pose2(200.0, 0.0, 1.0) * log.scans[i].odom_from_robot;
  }
  SlamGraph drive;
  ASSERT_TRUE(MakeGraph(log, &drive).ok());
  std::vector<int> reports;
  OnlineRun run;
  ASSERT_TRUE(
      RunOnline(
          MapLogOptions(), 0.0, drive, [&](int num_scans) { reports.push_back(num_scans); }, &run)
          .ok());
  EXPECT_THAT(reports, ElementsAre(100));
  EXPECT_EQ(run.num_jumps, 1);
  EXPECT_NEAR(run.recorded_s, 99.0, 1e-9);
  ASSERT_EQ(run.scans.size(), 100u);
  ASSERT_EQ(run.live.size(), 100u);
  ASSERT_EQ(run.online.size(), 100u);
  ASSERT_EQ(run.final_map.size(), 100u);
  EXPECT_EQ(run.live.back().timestamp_s, log.scans.back().scan.timestamp_s);
  for (const OnlineScanRecord& scan : run.scans) EXPECT_GE(scan.num_pending, 1);
  const Pose2 truth = Between(log.scans[0].world_from_robot, log.scans[99].world_from_robot);
  const Pose2 off = Between(truth, run.live.back().world_from_robot);
  EXPECT_LT(off.translation().norm(), 0.5);

  const std::vector<Relation> relations = {
      {0.0, 99.0, truth},
      {90.0, 99.0, Between(log.scans[90].world_from_robot, log.scans[99].world_from_robot)}};
  EXPECT_THAT(OnlineTable(run, relations), HasSubstr("Relations, error [m]"));
  EXPECT_THAT(OnlineTable(run, {}), HasSubstr("Relative poses of the final map"));
  EXPECT_THAT(OnlineTable(run, {}), HasSubstr("100 scans of 99.0 s"));
  const std::string folder = TempFolder();
  ASSERT_TRUE(WriteOnlineCsv(folder + "online.csv", run).ok());
  EXPECT_THAT(ReadFile(folder + "online.csv"),
              StartsWith("time_s,x_m,y_m,yaw_rad,add_s,cpu_s,lag_s,pending,memory_bytes\n0,0,0,"));
  EXPECT_FALSE(WriteOnlineCsv(folder + "none/online.csv", run).ok());
}

}  // namespace
}  // namespace plumbline
