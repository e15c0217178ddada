// The programs from end to end, as a user runs them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/test/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::vector<std::string> kResults = {
    "map_odometry.png", "map_refined.png", "map_seed.png",       "points.ply",
    "summary.json",     "trajectory.tum",  "trajectory_seed.tum"};

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class ProgramsTest : public testing::Test {
 protected:
  Outcome Run(const std::string& program, const std::string& arguments) const {
    const std::string out = folder_ + "stdout", err = folder_ + "stderr";
    const std::string command = std::string(PLUMBLINE_PROGRAMS_DIR) + "/plumbline_" + program +
                                " " + arguments + " >" + out + " 2>" + err;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(out), ReadFile(err)};
  }
  Outcome Slam(const std::string& log, const std::string& flags = "",
               const std::string& output_dir = "out") const {
    return Run("slam",
               "--log=" + folder_ + log + " --output_dir=" + folder_ + output_dir + " " + flags);
  }

  // The first scans of a drive through the small building, and the truth of the whole.
  void SimulateLog(int num_scans) {
    const Outcome run =
        Run("simulate", "--world=" PLUMBLINE_WORLD " --log=" + folder_ +
                            "all.clf --truth=" + folder_ + "a.tum --hits=" + folder_ + "a.hits");
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr(" scans, "));
    EXPECT_THAT(run.err, IsEmpty());
    log_lines_ = Lines(ReadFile(folder_ + "all.clf"));
    log_lines_.resize(2 + 2 * num_scans);  // two PARAM, then ODOM and FLASER by turns
    WriteLog();
  }
  void WriteLog() const {
    std::string text;
    for (const std::string& line : log_lines_) text += line + '\n';
    WriteFile(folder_ + "a.clf", text);
  }
  // A log of `num_scans` equal scans of a robot that stands still.
  void WriteStandingLog(int num_scans, const std::string& ranges) {
    for (int i = 0; i < num_scans; ++i) {
      log_lines_.push_back("FLASER " + ranges + " 1 2 0.5 1 2 0.5 " + std::to_string(0.1 * i) +
                           " host 0");
    }
    WriteLog();
  }

  std::vector<std::string> FilesOf(const std::string& output_dir) const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ + output_dir)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  std::string Result(const std::string& output_dir, const std::string& name) const {
    return ReadFile(folder_ + output_dir + "/" + name);
  }
  nlohmann::json Summary() const { return nlohmann::json::parse(Result("out", "summary.json")); }

  // The program fails, says `message` and nothing else on standard error, and writes no results.
  void ExpectError(const Outcome& run, const std::string& message) const {
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.err, HasSubstr(message));
    EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out"));
  }

  const std::string folder_ = TempFolder();
  std::vector<std::string> log_lines_;
};

TEST_F(ProgramsTest, MapsTheSmallBuildingWithAnyNumberOfThreads) {
  SimulateLog(400);
  const std::string truth = "--truth=" + folder_ + "a.tum --hits=" + folder_ + "a.hits";
  const Outcome run = Slam("a.clf", truth + " --threads=1");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, AllOf(HasSubstr("400 scans"), HasSubstr("refined, optimised points")));
  EXPECT_EQ(FilesOf("out"), kResults);
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 400u);

  const nlohmann::json stages = Summary()["stages"];
  ASSERT_EQ(stages.size(), 4u);
  const auto& odometry = stages[0];
  const auto& seed = stages[1];
  const auto& refined = stages[3];
  EXPECT_LT(seed["mean_pose_error_m"], 0.2 * odometry["mean_pose_error_m"].get<double>());
  for (const char* error : {"mean_pose_error_m", "mean_pose_error_rad", "mean_point_error_m",
                            "wall_thickness_m", "mean_map_entropy"}) {
    EXPECT_LT(refined[error], seed[error]) << error;
  }
  EXPECT_LT(refined["mean_point_error_m"], 0.85 * seed["mean_point_error_m"].get<double>());

  const Outcome again = Slam("a.clf", truth + " --threads=2", "again");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  for (const std::string& name : kResults) {
    if (name == "summary.json") continue;  // it holds times
    EXPECT_TRUE(Result("out", name) == Result("again", name)) << name;
  }
}

TEST_F(ProgramsTest, MapsWithCeres) {
  SimulateLog(20);
  const Outcome run = Slam("a.clf", "--solver=ceres --ceres_max_iterations=2");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(FilesOf("out"), kResults);
  EXPECT_EQ(Summary()["solver"]["solver"], "ceres");
  EXPECT_EQ(Summary()["flags"]["ceres_max_iterations"], 2);
}

TEST_F(ProgramsTest, MaxScansLimitsTheLog) {
  SimulateLog(5);
  const Outcome run = Slam("a.clf", "--max_scans=1");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 1u);
  EXPECT_EQ(Summary()["scans"], 1);
}

TEST_F(ProgramsTest, ReplacesTheResultsOfAnEarlierRun) {
  SimulateLog(5);
  ASSERT_EQ(Slam("a.clf").exit_code, 0);
  ASSERT_EQ(Slam("a.clf", "--max_scans=2").exit_code, 0);
  EXPECT_EQ(FilesOf("out"), kResults);
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 2u);
}

TEST_F(ProgramsTest, ARobotThatNeverMoves) {
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
}

TEST_F(ProgramsTest, ReadingsThatAreNoNumbersAreNoReturns) {
  SimulateLog(20);
  for (std::string& line : log_lines_) {
    if (line.compare(0, 11, "FLASER 360 ") == 0) line.replace(11, line.find(' ', 11) - 11, "nan");
  }
  WriteLog();
  const Outcome run = Slam("a.clf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(Result("out", "trajectory.tum"), Not(HasSubstr("nan")));
  EXPECT_THAT(Result("out", "points.ply"), Not(HasSubstr("nan")));
}

TEST_F(ProgramsTest, BadLinesAreNamedAndSkipped) {
  SimulateLog(20);
  log_lines_[5] = "FLASER 360 1.0 oops";
  log_lines_[8] += " more";
  WriteLog();
  const Outcome run = Slam("a.clf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Lines(run.err).size(), 2u) << run.err;
  EXPECT_THAT(run.err, HasSubstr(folder_ + "a.clf:6: FLASER field 'range"));
  EXPECT_THAT(run.err, HasSubstr(folder_ + "a.clf:9: ODOM "));
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 19u);
  EXPECT_EQ(Summary()["skipped_records"], 2);
}

TEST_F(ProgramsTest, TooManyBadLinesAreAnError) {
  SimulateLog(20);
  for (int i = 0; i < 12; ++i) log_lines_[3 + 2 * i] = "FLASER 360 oops";
  WriteLog();
  ExpectError(Slam("a.clf"), "12 of 42 records are unreadable");
  EXPECT_THAT(Slam("a.clf").err, HasSubstr(folder_ + "a.clf:4: "));
}

TEST_F(ProgramsTest, LogsThatCannotBeMapped) {
  ExpectError(Slam("none.clf"), "cannot open '" + folder_ + "none.clf'");
  ExpectError(Slam(""), "'" + folder_ + "': Is a directory");
  WriteFile(folder_ + "a.clf", "# a log\nODOM 0 0 0 0 0 0 0 host 0\n");
  ExpectError(Slam("a.clf"), folder_ + "a.clf: no FLASER");
  WriteFile(folder_ + "a.clf", "");
  ExpectError(Slam("a.clf"), folder_ + "a.clf: no FLASER");
}

TEST_F(ProgramsTest, WarnsOfASecondLaser) {
  SimulateLog(10);
  std::string& scan = log_lines_[5];
  std::vector<std::string> fields;
  std::istringstream stream(scan);
  for (std::string field; stream >> field;) fields.push_back(field);
  fields[362] = std::to_string(std::stod(fields[362]) + 0.5);  // laser_x
  scan.clear();
  for (const std::string& field : fields) scan += (scan.empty() ? "" : " ") + field;
  WriteLog();
  const Outcome run = Slam("a.clf");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
  EXPECT_THAT(run.err, HasSubstr("differs by up to 0.5 m and 0 deg between scans"));
}

TEST_F(ProgramsTest, ALogWithoutAnyReturnIsAnError) {
  WriteStandingLog(10, "3 81.91 81.91 nan");
  ExpectError(Slam("a.clf"), folder_ + "a.clf: no scan has a return");
}

TEST_F(ProgramsTest, AFolderThatCannotBeMadeIsAnError) {
  SimulateLog(2);
  WriteFile(folder_ + "file", "in the way");
  ExpectError(Slam("a.clf", "", "file"), "cannot make the folder '" + folder_ + "file'");
  ExpectError(Slam("a.clf", "", "file/deeper"), "cannot make the folder");
  EXPECT_EQ(ReadFile(folder_ + "file"), "in the way");
}

TEST_F(ProgramsTest, BadFlagsAreNamed) {
  ExpectError(Run("slam", ""), "--log is missing");
  ExpectError(Run("slam", "--log=a.clf"), "--output_dir is missing");
  ExpectError(Slam("a.clf", "--threads=0"), "num_threads = 0");
  ExpectError(Slam("a.clf", "--threads=many"), "'many' specified for int32 flag 'threads'");
  ExpectError(Slam("a.clf", "--solver=magic"), "--solver=magic");
  ExpectError(Slam("a.clf", "--max_scans=-1"), "--max_scans");
  ExpectError(Slam("a.clf", "--hits=a.hits"), "--hits needs --truth");
  ExpectError(Slam("a.clf", "--no_such_flag=1"), "no_such_flag");
  ExpectError(Slam("a.clf", "stray"), "unexpected argument 'stray'");
  ExpectError(Run("simulate", ""), "--world is missing");
  ExpectError(Run("simulate", "--world=a --building=random"), "exclude each other");
  ExpectError(Run("simulate", "--building=castle --log=a.clf"), "--building=castle");
  ExpectError(Run("simulate", "--no_such_flag=1"), "no_such_flag");
}

TEST_F(ProgramsTest, SimulatesTheSameBuildingFromTheSameSeed) {
  for (const char* name : {"a.clf", "b.clf"}) {
    const Outcome run =
        Run("simulate", "--building=repetitive --seed=3 --num_beams=9 --log=" + folder_ + name +
                            " --carry_at_path_m=30 " + "--carry_distance_m=2");
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  EXPECT_TRUE(ReadFile(folder_ + "a.clf") == ReadFile(folder_ + "b.clf"));
}

TEST_F(ProgramsTest, TruthOfAnotherLogIsAnError) {
  SimulateLog(2);
  WriteFile(folder_ + "a.tum", "77 0 0 0 0 0 0 1\n");
  ExpectError(Slam("a.clf", "--truth=" + folder_ + "a.tum"), folder_ + "a.tum: no pose");
}

TEST_F(ProgramsTest, HelpShowsTheFlagsOfTheProgram) {
  const Outcome slam = Run("slam", "--help");
  EXPECT_EQ(slam.exit_code, 0);
  EXPECT_THAT(slam.out, AllOf(HasSubstr("  --output_dir="), HasSubstr("  --threads=2"),
                              Not(HasSubstr("logtostderr")), Not(HasSubstr("speed_m_s"))));
  const Outcome simulate = Run("simulate", "--help");
  EXPECT_EQ(simulate.exit_code, 0);
  EXPECT_THAT(simulate.out, AllOf(HasSubstr("  --speed_m_s="), Not(HasSubstr("--threads"))));
}

}  // namespace
}  // namespace plumbline
