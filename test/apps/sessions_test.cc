// plumbline_slam over several logs, from end to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Made-up buildings with short drives.
constexpr int kHomeSeed = 43, kElsewhereSeed = 34;

class SessionsTest : public ProgramTest {
 protected:
  // A drive through a made-up building, on some day: NAME.clf with NAME.tum, its truth.
  void Simulate(const std::string& name, int seed, int visit) const {
    const Outcome run =
        Run("simulate",
            "--building=random --scan_period_s=0.9 --num_beams=180 --bearing_step_deg=2 "
            "--seed=" +
                std::to_string(seed) + " --visit=" + std::to_string(visit) + " --log=" + folder_ +
                name + ".clf --truth=" + folder_ + name + ".tum");
    ASSERT_EQ(run.exit_code, kExitDone) << run.err;
  }
  Outcome Map(const std::vector<std::string>& logs, const std::string& flags = "") const {
    std::string list;
    for (const std::string& log : logs) list += (list.empty() ? "" : ",") + folder_ + log;
    return Run("slam",
               "--log=" + list + " --output_dir=" + folder_ + "out --picture_side_px=400 " + flags);
  }
  // Of relative poses within a session, which no frame matters to.
  double WorstErrorM(const std::string& trajectory, const std::string& truth) const {
    std::vector<TimedPose> estimated, exact;
    EXPECT_TRUE(ReadTumTrajectory(folder_ + "out/" + trajectory, &estimated).ok());
    EXPECT_TRUE(ReadTumTrajectory(folder_ + truth, &exact).ok());
    EXPECT_EQ(estimated.size(), exact.size());
    const std::size_t middle = exact.size() / 2;
    double worst_m = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const Pose2 error =
          Between(Between(exact[middle].world_from_robot, exact[i].world_from_robot),
                  Between(estimated[middle].world_from_robot, estimated[i].world_from_robot));
      worst_m = std::max(worst_m, error.translation().norm());
    }
    return worst_m;
  }
};

TEST_F(SessionsTest, LogsOfOneBuildingBecomeOneMap) {
  Simulate("a", kHomeSeed, 1);
  Simulate("b", kHomeSeed, 2);
  const Outcome run = Map({"a.clf", "b.clf"});
  ASSERT_EQ(run.exit_code, kExitDone) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, HasSubstr("a.clf and b.clf: one map, by "));
  std::vector<std::string> expected = kResults;
  expected.erase(std::find(expected.begin(), expected.end(), "map_odometry.png"));
  expected.insert(expected.end(),
                  {"changes.png", "sessions.png", "trajectory_1.tum", "trajectory_2.tum"});
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(FilesOf("out"), expected);
  EXPECT_LT(WorstErrorM("trajectory_1.tum", "a.tum"), 0.03);
  EXPECT_LT(WorstErrorM("trajectory_2.tum", "b.tum"), 0.03);

  const nlohmann::json summary = Summary();
  EXPECT_EQ(summary["alarm"], false);
  EXPECT_EQ(summary["scans"], summary["sessions"][0]["scans"].get<int>() +
                                  summary["sessions"][1]["scans"].get<int>());
  EXPECT_EQ(summary["ties"][0]["outcome"], "tied");
  EXPECT_EQ(summary["maps"].dump(), R"([{"alarm":false,"folder":".","sessions":[1,2]}])");
  EXPECT_GE(summary["changes"].size(), 5u);  // furniture was moved
  EXPECT_THAT(Result("out", "report.html"), HasSubstr("What changed between sessions"));
}

TEST_F(SessionsTest, LogsOfDifferentBuildingsGetMapsOfTheirOwn) {
  Simulate("a", kHomeSeed, 1);
  Simulate("b", kElsewhereSeed, 0);
  // Of an earlier run.
  std::filesystem::create_directories(folder_ + "out/map_3");
  WriteFile(folder_ + "out/map_3/points.ply", "old");
  WriteFile(folder_ + "out/trajectory.tum", "old");
  WriteFile(folder_ + "list.txt", "# two buildings\na.clf\nb.clf\n");
  const Outcome run = Run("slam", "--log=@" + folder_ + "list.txt --output_dir=" + folder_ +
                                      "out --picture_side_px=400");
  ASSERT_EQ(run.exit_code, kExitDone) << run.err;
  EXPECT_THAT(run.err, HasSubstr("note: not all logs show a common place: there are 2 maps"));
  EXPECT_THAT(run.out, AllOf(HasSubstr("a.clf and b.clf: n"), HasSubstr("\nMap of a.clf:\n"),
                             HasSubstr("\nMap of b.clf:\n")));
  EXPECT_THAT(FilesOf("out"), ElementsAre("map_1", "map_2", "summary.json"));
  EXPECT_EQ(Summary()["maps"].dump(), R"([{"alarm":false,"folder":"map_1","sessions":[1]},)"
                                      R"({"alarm":false,"folder":"map_2","sessions":[2]}])");
  for (const char* map : {"out/map_1", "out/map_2"}) {
    EXPECT_THAT(FilesOf(map), Contains("map.pgm"));
    EXPECT_THAT(FilesOf(map), Not(Contains("sessions.png")));
  }
  EXPECT_LT(WorstErrorM("map_1/trajectory.tum", "a.tum"), 0.03);
  EXPECT_LT(WorstErrorM("map_2/trajectory.tum", "b.tum"), 0.03);
}

TEST_F(SessionsTest, ASavedMapWithScansMayBeASession) {
  Simulate("a", kHomeSeed, 1);
  Simulate("b", kHomeSeed, 2);
  const Outcome converted = Run("convert", "--input=" + folder_ + "b.clf --trajectory=" + folder_ +
                                               "b.tum --output=" + folder_ + "b.g2o");
  ASSERT_EQ(converted.exit_code, kExitDone) << converted.err;
  const Outcome run = Map({"a.clf", "b.g2o"});
  ASSERT_EQ(run.exit_code, kExitDone) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("b.g2o (g2o): "), HasSubstr(": one map, by ")));
  EXPECT_LT(WorstErrorM("trajectory_1.tum", "a.tum"), 0.03);
}

TEST_F(SessionsTest, ALogIsLocalisedInAMapThatStaysAsItIs) {
  Simulate("a", kHomeSeed, 1);
  Simulate("b", kHomeSeed, 2);
  const std::string flags = " --picture_side_px=400 --output_dir=" + folder_;
  const Outcome mapped = Run("slam", "--log=" + folder_ + "a.clf --save_map" + flags + "map");
  ASSERT_EQ(mapped.exit_code, kExitDone) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("  map.g2o "));
  const Outcome run = Run("slam", "--log=" + folder_ + "b.clf --fixed_map=" + folder_ +
                                      "map/map.g2o --save_map" + flags + "out");
  ASSERT_EQ(run.exit_code, kExitDone) << run.err;
  EXPECT_TRUE(Result("out", "trajectory_2.tum") == Result("map", "trajectory.tum"));
  EXPECT_LT(WorstErrorM("trajectory_1.tum", "b.tum"), 0.03);
  EXPECT_EQ(Summary()["sessions"][0]["fixed"], false);
  EXPECT_EQ(Summary()["sessions"][1]["fixed"], true);

  // The map of both is one to localise in, too.
  const Outcome again = Run("slam", "--log=" + folder_ + "a.clf --fixed_map=" + folder_ +
                                        "out/map.g2o" + flags + "again");
  ASSERT_EQ(again.exit_code, kExitDone) << again.err;
  EXPECT_TRUE(Result("again", "trajectory_2.tum") == Result("out", "trajectory.tum"));
}

TEST_F(SessionsTest, WhatIsNoMapToLocaliseInIsRefused) {
  SimulateLog(20);
  ExpectError(Slam("a.clf", "--fixed_map=" + folder_ + "all.clf"),
              "all.clf: no pose graph with scans; --save_map writes one");
  ExpectError(Slam("a.clf", "--fixed_map=" + folder_ + "none.g2o"), "none.g2o");
  ExpectUsageError(Slam("a.clf", "--fixed_map=b.g2o --truth=t.tum"), "--truth");
}

TEST_F(SessionsTest, WhatGoesWithOneLogOnlyIsRefused) {
  for (const char* flag :
       {"--truth=t.tum", "--calibrate=mounting", "--start=odometry", "--solver=pose_graph"}) {
    const std::string text = flag;
    ExpectUsageError(Map({"a.clf", "b.clf"}, text), text.substr(0, text.find('=')));
  }
}

TEST_F(SessionsTest, BadListsAreRefused) {
  ExpectUsageError(Run("slam", "--log=a.clf, --output_dir=" + folder_ + "out"), "--log: ");
  ExpectUsageError(Map({"a.clf", "a.clf"}), "is named twice");
  ExpectError(Run("slam", "--log=@" + folder_ + "none.txt --output_dir=" + folder_ + "out"),
              "none.txt");
}

TEST_F(SessionsTest, BadLogsAreNamed) {
  WriteFile(folder_ + "empty.clf", "");
  WriteFile(folder_ + "b.g2o",
            "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  SimulateLog(20);
  ExpectError(Map({"a.clf", "empty.clf"}), "empty.clf");
  ExpectError(Map({"a.clf", "none.clf"}), "none.clf");
  ExpectError(Map({"a.clf", "b.g2o"}), "b.g2o: a pose graph without scans");
}

TEST_F(SessionsTest, NoLogIsAResult) {
  std::filesystem::create_directories(folder_ + "out");
  WriteFile(folder_ + "out/trajectory_7.tum", "precious");
  const Outcome run = Map({"a.clf", "out/trajectory_7.tum"});
  EXPECT_EQ(run.exit_code, kExitWrongUsage);
  EXPECT_THAT(run.err, HasSubstr("--log and --output_dir both mean the file"));
  EXPECT_EQ(ReadFile(folder_ + "out/trajectory_7.tum"), "precious");
}

}  // namespace
}  // namespace plumbline
