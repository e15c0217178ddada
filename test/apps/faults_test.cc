// Runs that are stopped, run out of disk or memory, and go on from a checkpoint.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "plumbline/apps/program/disk_arrays.h"
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
  RunningProgram run(Command("a.clf", {"--checkpoint=" + folder_ + "seed"}), folder_ + "printed");
  ASSERT_TRUE(run.Prints("Matching scans: 10 %")) << Printed();
  run.Send(SIGINT);
  EXPECT_EQ(run.Wait(), 130);
  EXPECT_THAT(Printed(), HasSubstr("plumbline_slam: stopped by SIGINT while seeding: nothing is "
                                   "written\n"));
  EXPECT_EQ(FilesOf("out"), std::vector<std::string>{"summary.json"});
  EXPECT_EQ(Result("out", "summary.json"), "{}");
  EXPECT_FALSE(std::filesystem::exists(folder_ + "seed"));
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

TEST_F(FaultsTest, ResumesToTheSameResults) {
  SimulateLog(120);
  const std::string checkpoint = " --checkpoint=" + folder_ + "seed";
  const std::string resume = " --resume=" + folder_ + "seed";
  ASSERT_EQ(Slam("a.clf", checkpoint, "whole").exit_code, 0);
  // Stopped once the checkpoint is there, and once the estimation has begun.
  for (const char* moment : {"Checkpoint: ", "\n   1     1 "}) {
    std::filesystem::remove(folder_ + "seed");
    RunningProgram run(Command("a.clf", {"--checkpoint=" + folder_ + "seed"}), folder_ + "printed");
    ASSERT_TRUE(run.Prints(moment)) << Printed();
    run.Send(SIGINT);
    EXPECT_EQ(run.Wait(), 130);
    const Outcome resumed = Slam("a.clf", resume, "resumed");
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.out, AllOf(HasSubstr("Seeding: as in " + folder_ + "seed"),
                                   Not(HasSubstr("Matching scans"))));
    ExpectSameResults("whole", "resumed");
  }
  // The figures too, but for times and memory.
  nlohmann::json whole = nlohmann::json::parse(Result("whole", "summary.json"));
  const nlohmann::json resumed = nlohmann::json::parse(Result("resumed", "summary.json"));
  whole["seeding"]["time_s"] = resumed["seeding"]["time_s"];
  for (const char* same : {"seeding", "consistency", "stages", "alarm", "returns"}) {
    EXPECT_EQ(whole[same], resumed[same]) << same;
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

TEST_F(FaultsTest, ALogThatIsSwappedWhileItIsReadIsNoticed) {
  SimulateLog(300);
  const std::string log = ReadFile(folder_ + "a.clf");
  std::atomic<bool> swaps{true};
  std::thread swapper([&] {
    while (swaps) {
      WriteFile(folder_ + "b.clf", log);
      std::filesystem::rename(folder_ + "b.clf", folder_ + "a.clf");
    }
  });
  const Outcome run = Slam("a.clf", "--checkpoint=" + folder_ + "seed");
  swaps = false;
  swapper.join();
  ExpectError(run, "a.clf: the log changed while it was read");
  EXPECT_FALSE(std::filesystem::exists(folder_ + "seed"));
}

TEST_F(FaultsTest, RefusesTheCheckpointOfAnotherRun) {
  SimulateLog(40);
  const std::string resume = "--resume=" + folder_ + "seed";
  ExpectError(Slam("a.clf", resume), "cannot open '" + folder_ + "seed'");
  ASSERT_EQ(Slam("a.clf", "--checkpoint=" + folder_ + "seed").exit_code, 0);
  std::filesystem::remove_all(folder_ + "out");
  EXPECT_THAT(Slam("a.clf", resume + " --max_scans=30").err,
              HasSubstr("--max_scans was 0, here it is 30"));
  EXPECT_THAT(Slam("a.clf", resume + " --odom_translation_floor_m=0.02").err,
              HasSubstr("--odom_translation_floor_m was 0.01, here it is 0.02"));
  log_lines_.back() += "0";
  WriteLog();
  EXPECT_THAT(Slam("a.clf", resume).err, HasSubstr("the size of the log [bytes] was "));
  WriteFile(folder_ + "a.g2o", AsG2o(MakeNoisyRoom()));
  EXPECT_THAT(Slam("a.g2o", resume).err, HasSubstr("--resume goes with a log"));
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out"));
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

TEST_F(FaultsTest, ARunWithItsArraysOnDiskGivesTheSameBytesInLessMemory) {
  if (PLUMBLINE_SANITIZED) GTEST_SKIP() << "sanitizers take memory of their own";
  const Status usable = DiskArrays().Open(folder_);
  if (!usable.ok()) GTEST_SKIP() << usable.message();
  SimulateLog(300, "--scan_period_s=0.7 --num_beams=1440 --bearing_step_deg=0.25");
  const std::string flags =
      "--solver=alternating_cg --coarse_rounds=0 --fine_rounds=1 --picture_side_px=400";
  const Outcome in_memory = Slam("a.clf", flags);
  ASSERT_EQ(in_memory.exit_code, 0) << in_memory.err;
  EXPECT_THAT(in_memory.out, Not(HasSubstr("on disk")));
  const Outcome on_disk = Slam("a.clf", flags + " --max_memory=75MB", "disk");
  ASSERT_EQ(on_disk.exit_code, 0) << on_disk.err;
  EXPECT_THAT(on_disk.out, HasSubstr("arrays are kept on disk, beside the results: about "));
  EXPECT_EQ(FilesOf("disk"), FilesOf("out"));
  for (const std::string& name : kResults) {
    if (name == "summary.json" || name == "report.html") continue;  // with times
    EXPECT_EQ(Result("disk", name), Result("out", name)) << name;
  }
  const auto peak_of = [&](const std::string& folder) {
    return nlohmann::json::parse(Result(folder, "summary.json"))["peak_memory_bytes"].get<double>();
  };
  std::cout << "peak: " << peak_of("out") / 1e6 << " MB, " << peak_of("disk") / 1e6
            << " MB with arrays on disk\n";
  EXPECT_LT(peak_of("disk"), 0.6 * peak_of("out"));
  EXPECT_LT(peak_of("disk"), 1.25 * 75e6);
  if (!std::filesystem::exists("/dev/shm")) return;
  // Files in memory are no disk.
  const Outcome nowhere =
      Run("slam", "--log=" + folder_ + "a.clf --output_dir=/dev/shm/plumbline_none " + flags +
                      " --max_memory=75MB");
  EXPECT_EQ(nowhere.exit_code, kExitBadInput);
  EXPECT_THAT(nowhere.err, HasSubstr("cannot keep arrays in '/dev/shm': it is no disk"));
  EXPECT_FALSE(std::filesystem::exists("/dev/shm/plumbline_none"));
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
         {"reduced", "ceres --coarse_rounds=0 --fine_rounds=1 --ceres_max_iterations=1"}) {
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
