// What plumbline_slam tells a user of runs that went well, badly, or nowhere.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/room_as_g2o.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using SlamReportsTest = ProgramTest;

TEST_F(SlamReportsTest, ARobotThatNeverMoves) {
  std::string ranges = "181";
  for (int beam = 0; beam < 181; ++beam) ranges += beam % 60 < 30 ? " 3.1" : " 4.2";
  WriteStandingLog(10, ranges);
  const Outcome run = Slam("a.clf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::vector<std::string> poses = Lines(Result("out", "trajectory.tum"));
  ASSERT_EQ(poses.size(), 10u);
  for (const std::string& pose : poses) {
    double t = 1.0, x = 1.0, y = 1.0;
    std::istringstream(pose) >> t >> x >> y;
    EXPECT_NEAR(std::hypot(x, y), 0.0, 1e-3) << pose;
  }
  EXPECT_THAT(run.out, AllOf(HasSubstr("The robot hardly moved"), Not(HasSubstr("nan"))));
  EXPECT_THAT(run.err, HasSubstr("there is no odometry, or it never changes"));
  EXPECT_EQ(Summary()["alarm"], false);
}

TEST_F(SlamReportsTest, ADriveThatVisitsNoPlaceTwice) {
  SimulateLog(60);
  const Outcome run = Slam("a.clf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("No place was visited twice: the drift cannot be checked.\n"));
  EXPECT_THAT(run.out, HasSubstr("The refined map is consistent: "));
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_EQ(Summary()["seeding"]["loop_closures"], 0);
}

TEST_F(SlamReportsTest, ScansThatMatchNothing) {
  // Every scan sees another bump, all alone, and the robot drives far in between.
  for (int i = 0; i < 8; ++i) {
    std::string scan = "FLASER 181";
    for (int beam = 0; beam < 181; ++beam) {
      const bool bump = beam >= 20 * i && beam < 20 * i + 20;
      scan += bump ? " " + std::to_string(3 + i % 3) + '.' + std::to_string(beam % 10) : " 81.91";
    }
    const std::string x = ' ' + std::to_string(9 * i);
    log_lines_.push_back(scan + x + " 0 0" + x + " 0 0 " + std::to_string(i) + " host 0");
  }
  WriteLog();
  const Outcome run = Slam("a.clf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("No scan matches another: every pose is the odometry's"));
  EXPECT_THAT(run.out, Not(HasSubstr("nan")));
}

TEST_F(SlamReportsTest, ACarriedRobotIsPutRightOrReported) {
  const Outcome simulation =
      Run("simulate",
          "--building=repetitive --seed=3 --num_beams=181 --bearing_step_deg=1 "
          "--carry_at_path_m=40 --carry_distance_m=3 --log=" +
              folder_ + "a.clf");
  ASSERT_EQ(simulation.exit_code, 0) << simulation.err;
  const Outcome run = Slam("a.clf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json summary = Summary();
  bool repaired = false;
  for (const auto& step : summary["seeding"]["suspect_steps"]) {
    repaired = repaired || (step["broken"] && !step["unresolved"]);
  }
  const bool alarm = summary["alarm"];
  EXPECT_TRUE(repaired || alarm);
  EXPECT_EQ(run.out.find("put it right") != std::string::npos, repaired) << run.out;
  EXPECT_EQ(run.err.find("WARNING: the map ") == 0, alarm) << run.err;
  EXPECT_EQ(summary["alarm_reasons"].empty(), !alarm);
}

TEST_F(SlamReportsTest, MapsALogByItsPoseGraphAlone) {
  const Outcome simulation =
      Run("simulate", "--building=random --seed=7 --num_beams=181 --bearing_step_deg=1 --log=" +
                          folder_ + "a.clf --truth=" + folder_ + "a.tum");
  ASSERT_EQ(simulation.exit_code, 0) << simulation.err;
  const auto error_m = [&](const nlohmann::json& summary, std::size_t stage) {
    return summary["stages"][stage]["mean_pose_error_m"].get<double>();
  };
  const std::string truth = "--truth=" + folder_ + "a.tum --solver=";
  for (const std::string solver : {"pose_graph", "sgd"}) {
    const Outcome run = Slam("a.clf", truth + solver);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const nlohmann::json summary = Summary();
    EXPECT_EQ(summary["solver"]["solver"], solver);
    EXPECT_LT(summary["solver"]["chi2_final"], 0.5 * summary["solver"]["chi2_seed"].get<double>());
    EXPECT_THAT(run.out, AllOf(HasSubstr(" relative poses, chi2 "), HasSubstr("Termination: ")));
    EXPECT_EQ(summary["stages"][1]["stage"], "sequential matching");
    // The sequential matching drifts, which the closures take out.
    EXPECT_LT(error_m(summary, 3), error_m(summary, 1)) << solver;
    EXPECT_LT(error_m(summary, 3), 0.009) << solver;
  }
}

TEST_F(SlamReportsTest, RefinesAPoseGraphWithItsScans) {
  WriteFile(folder_ + "a.g2o", AsG2o(MakeNoisyRoom()));
  const Outcome run = Slam("a.g2o", "--reduced_max_rounds=9");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, AllOf(HasSubstr("(g2o): 12 poses, 12 edges, 12 scans"),
                             HasSubstr("The given map is consistent"),
                             HasSubstr("The refined map is consistent")));
  EXPECT_THAT(
      FilesOf("out"),
      testing::ElementsAre("before_after.png", "conflicts.png", "graph.g2o", "map.pgm", "map.yaml",
                           "map_given.png", "map_pose_graph.png", "map_refined.png", "points.pcd",
                           "points.ply", "report.html", "summary.json", "trajectory.tum"));
  EXPECT_EQ(Summary()["alarm"], false);
  EXPECT_EQ(Summary()["joint"]["solver"], "reduced");
  EXPECT_EQ(Summary()["flags"]["reduced_max_rounds"], 9);
}

TEST_F(SlamReportsTest, CalibrationIsReported) {
  SimulateLog(60);
  Outcome run = Slam("a.clf", "--calibrate=mounting,range_bias");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("Calibration"), HasSubstr("  mounting_yaw_rad  ")));
  const nlohmann::json parameters = Summary()["calibration"]["parameters"];
  EXPECT_EQ(parameters.size(), 4u);
  EXPECT_EQ(parameters["range_bias_m"]["determined"], true);
  EXPECT_NEAR(parameters["range_bias_m"]["value"], 0.0, 0.005);

  run = Slam("a.clf", "--calibrate=mounting,clock");
  EXPECT_EQ(run.exit_code, kExitWrongUsage);
  EXPECT_THAT(run.err, HasSubstr("--calibrate: 'clock' is nothing to calibrate"));
}

}  // namespace
}  // namespace plumbline
