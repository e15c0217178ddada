// Runs that are stopped, or run out of disk or memory.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/room_as_g2o.h"
#include "plumbline/test/apps/running_program.h"
#include "plumbline/test/apps/whole_files.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

// An estimation that does not end by itself.
const std::vector<std::string> kEndless = {"--solver=alternating_cg", "--coarse_rounds=0",
                                           "--cg_max_sweeps=100000000", "--cg_tolerance=0"};

class FaultsTest : public ProgramTest {
 protected:
  std::vector<std::string> Command(const std::string& log,
                                   const std::vector<std::string>& flags = {}) const {
    std::vector<std::string> command = {std::string(PLUMBLINE_PROGRAMS_DIR) + "/plumbline_slam",
                                        "--log=" + folder_ + log, "--output_dir=" + folder_ + "out",
                                        "--picture_side_px=200", "--threads=1"};
    command.insert(command.end(), flags.begin(), flags.end());
    return command;
  }
  std::string Printed() const { return ReadFile(folder_ + "printed"); }

  void ExpectWholeFiles() const {
    if (!std::filesystem::exists(folder_ + "out")) return;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ + "out")) {
      EXPECT_TRUE(IsWhole(entry.path())) << entry.path();
    }
  }
  // The results that are the same for the same poses and points.
  void ExpectSameResults(const std::string& a, const std::string& b) const {
    for (const std::string& name : kResults) {
      if (name == "summary.json" || name == "report.html") continue;  // they hold times
      EXPECT_TRUE(Result(a, name) == Result(b, name)) << name;
    }
  }
};

TEST_F(FaultsTest, AStoppedEstimationWritesItsBestState) {
  SimulateLog(40);
  for (const auto& [number, name, code] :
       {std::tuple(SIGINT, "SIGINT", 130), std::tuple(SIGTERM, "SIGTERM", 143)}) {
    RunningProgram run(Command("a.clf", kEndless), folder_ + "printed");
    ASSERT_TRUE(run.Prints("\n   3     1 ")) << Printed();
    run.Send(number);
    EXPECT_EQ(run.Wait(), code);
    EXPECT_THAT(Printed(), HasSubstr(std::string("Stopped by ") + name));
    EXPECT_EQ(FilesOf("out"), kResults);
    ExpectWholeFiles();
    EXPECT_EQ(Summary()["stopped_by"], name);
    EXPECT_EQ(Summary()["solver"]["termination"], "stopped");
    EXPECT_THAT(Result("out", "report.html"), AllOf(HasSubstr("Stopped early"), HasSubstr(name)));
    const auto acceptance = Summary()["solver"]["acceptance"];
    EXPECT_LE(acceptance["landmark_energy_final"],
              acceptance["landmark_energy_seed"].get<double>());
  }
}

TEST_F(FaultsTest, AStoppedPoseGraphRunWritesItsBestState) {
  WriteFile(folder_ + "a.g2o", AsG2o(MakeNoisyRoom()));
  RunningProgram run(Command("a.g2o", kEndless), folder_ + "printed");
  ASSERT_TRUE(run.Prints("\n   3     1 ")) << Printed();
  run.Send(SIGINT);
  EXPECT_EQ(run.Wait(), 130);
  EXPECT_THAT(Printed(), HasSubstr("Stopped by SIGINT"));
  EXPECT_EQ(Summary()["stopped_by"], "SIGINT");
  EXPECT_EQ(FilesOf("out").size(), 13u);
  ExpectWholeFiles();
}

TEST_F(FaultsTest, ASecondSignalEndsTheRun) {
  SimulateLog(40);
  RunningProgram run(Command("a.clf", kEndless), folder_ + "printed");
  ASSERT_TRUE(run.Prints("\n   3     1 ")) << Printed();
  for (int i = 0; i < 200; ++i) {
    run.Send(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(run.Wait(), 1000 + SIGINT);
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out/summary.json"));
}

TEST_F(FaultsTest, ARunStoppedDuringTheSeedingLeavesEarlierResultsAlone) {
  SimulateLog(700);
  std::filesystem::create_directories(folder_ + "out");
  WriteFile(folder_ + "out/summary.json", "{}");
  RunningProgram run(Command("a.clf"), folder_ + "printed");
  ASSERT_TRUE(run.Prints("Matching scans: 10 %")) << Printed();
  run.Send(SIGINT);
  EXPECT_EQ(run.Wait(), 130);
  EXPECT_THAT(Printed(), HasSubstr("plumbline_slam: stopped by SIGINT while seeding: nothing is "
                                   "written\n"));
  EXPECT_EQ(FilesOf("out"), std::vector<std::string>{"summary.json"});
  EXPECT_EQ(Result("out", "summary.json"), "{}");
}

TEST_F(FaultsTest, ARunStoppedDuringReadingSaysSo) {
  SimulateLog(40);
  std::string comments;
  for (int i = 0; i < 1000000; ++i) comments += "# a line that nobody needs\n";
  WriteFile(folder_ + "a.clf", ReadFile(folder_ + "a.clf") + comments);
  for (const char* log : {"a.clf", "a.g2o"}) {
    WriteFile(folder_ + "a.g2o", comments);
    RunningProgram run(Command(log), folder_ + "printed");
    ASSERT_TRUE(run.Catches(SIGINT));
    run.Send(SIGINT);
    EXPECT_EQ(run.Wait(), 130);
    EXPECT_THAT(Printed(), MatchesRegex("plumbline_slam: stopped by SIGINT while "
                                        "(starting|reading .*): nothing is written\n"));
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out"));
  }
}

TEST_F(FaultsTest, ReadingStaysWithinTheMemoryAllowed) {
  std::string scans;
  for (int i = 0; i < 200000; ++i)
    scans += "FLASER 1 1 0 0 0 0 0 0 " + std::to_string(i) + " h 0\n";
  WriteFile(folder_ + "a.clf", scans);
  ExpectError(Slam("a.clf", "--max_memory=20MB"),
              ": what was read so far takes more memory than the 20 MB allowed");
  WriteFile(folder_ + "a.g2o", "VERTEX_SE2 0 0 0 0\n" + std::string(1000000, '\n'));
  ExpectError(Slam("a.g2o", "--max_memory=20MB"), "takes more memory than the 20 MB allowed");
}

TEST_F(FaultsTest, AFullDiskIsNamedAndLeavesNothingHalfWritten) {
  SimulateLog(40);
  const std::string slam = PLUMBLINE_PROGRAMS_DIR "/plumbline_slam --log=" + folder_ +
                           "a.clf --picture_side_px=200 --output_dir=" + folder_ + "out >" +
                           folder_ + "out.txt 2>" + folder_ + "err.txt";
  ASSERT_EQ(std::system(slam.c_str()), 0);
  // The limit on the size of a file, in blocks of 512 bytes, stands for the disk. It is too small
  // for the points, and then for all pictures.
  for (const char* blocks : {"200", "4"}) {
    const int status = std::system(("ulimit -f " + std::string(blocks) + "; " + slam).c_str());
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_NE(WEXITSTATUS(status), 0);
    const std::string error = ReadFile(folder_ + "err.txt");
    EXPECT_THAT(error, AllOf(HasSubstr("plumbline_slam: cannot write '" + folder_ + "out/"),
                             HasSubstr("': File too large\n")));
    EXPECT_EQ(Lines(error).size(), 1u) << error;
    ExpectWholeFiles();
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out/points.ply"));
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out/summary.json"));
    const bool has_trajectory = std::filesystem::exists(folder_ + "out/trajectory.tum");
    EXPECT_EQ(has_trajectory, std::string(blocks) == "200");
  }
}

TEST_F(FaultsTest, AFolderThatVanishesIsNamed) {
  SimulateLog(40);
  RunningProgram run(Command("a.clf", kEndless), folder_ + "printed");
  ASSERT_TRUE(run.Prints("\n   3     1 ")) << Printed();
  std::filesystem::remove_all(folder_ + "out");
  run.Send(SIGINT);
  EXPECT_EQ(run.Wait(), 130);
  EXPECT_THAT(Printed(), AllOf(HasSubstr("plumbline_slam: cannot write '" + folder_ + "out/"),
                               HasSubstr("': No such file or directory\n")));
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out"));
}

TEST_F(FaultsTest, RefusesARunThatNeedsTooMuchMemory) {
  SimulateLog(40);
  Outcome run = Slam("a.clf", "--max_memory=10MB");
  EXPECT_THAT(run.out, HasSubstr("Memory needed, about: seeding "));
  ExpectError(run, "but --max_memory allows 10 MB");
  run = Slam("a.clf", "--max_memory=much");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--max_memory: 'much' is no size of memory"));
  run = Slam("a.clf", "--max_memory=1GB --picture_side_px=200");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, Not(HasSubstr("To stay within")));
  run = Slam("a.clf", "--max_memory=30MB --picture_side_px=4000");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("To stay within --max_memory, pictures have sides of "));
}

TEST_F(FaultsTest, AStackThatIsTooSmallIsRefused) {
  SimulateLog(40);
  const std::string in_room = "--world=" PLUMBLINE_WORLD " --log=" + folder_ + "out";
  limits_ = "ulimit -s 64; ";
  for (const Outcome& run : {Slam("a.clf"), Run("simulate", in_room), Run("convert", ""),
                             Run("evaluate", ""), Run("benchmark", "")}) {
    ExpectUsageError(
        run, ": the stack limit of 64 kB is too small: 1024 kB are needed (ulimit -s 1024)");
  }
  if (PLUMBLINE_SANITIZED) GTEST_SKIP() << "sanitizers take stack of their own";
  limits_ = "ulimit -s 1024; ";
  EXPECT_EQ(Slam("a.clf", "--picture_side_px=200").exit_code, 0);
}

TEST_F(FaultsTest, TheMemoryEstimateIsRightToAFactorOfTwo) {
  if (PLUMBLINE_SANITIZED) GTEST_SKIP() << "sanitizers take memory of their own";
  SimulateLog(200);
  for (const std::string size : {"60", "200"}) {
    for (const std::string solver :
         {"reduced", "ceres --coarse_rounds=0 --fine_rounds=1 --ceres=max_num_iterations=1"}) {
      const Outcome run =
          Slam("a.clf", "--picture_side_px=400 --max_scans=" + size + " --solver=" + solver);
      ASSERT_EQ(run.exit_code, 0) << run.err;
      std::size_t expected_mb = 0;
      for (const char* stage : {"seeding ", "estimation ", "results "}) {
        expected_mb = std::max(expected_mb, NumberBehind(run.out, stage));
      }
      const double peak_mb = Summary()["peak_memory_bytes"].get<double>() / 1e6;
      std::cout << size << " scans, " << solver << ": expected " << expected_mb << " MB, measured "
                << peak_mb << " MB\n";
      EXPECT_LT(expected_mb, 2.0 * peak_mb) << solver;
      EXPECT_GT(expected_mb, 0.5 * peak_mb) << solver;
    }
  }
}

}  // namespace
}  // namespace plumbline
