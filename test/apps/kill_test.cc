// A run may be killed at any time: whatever is in its folder then is whole.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/running_program.h"
#include "plumbline/test/apps/whole_files.h"

namespace plumbline {
namespace {

using Clock = std::chrono::steady_clock;

// Environment variable PLUMBLINE_KILLS: how often to kill.
int NumKills() {
  const char* number = std::getenv("PLUMBLINE_KILLS");
  return number == nullptr ? 15 : std::atoi(number);
}

class KillTest : public ProgramTest {
 protected:
  // Runs over more or fewer scans differ in every result.
  std::vector<std::string> Command(int max_scans) const {
    return {std::string(PLUMBLINE_PROGRAMS_DIR) + "/plumbline_slam",
            "--log=" + folder_ + "a.clf",
            "--output_dir=" + folder_ + "out",
            "--picture_side_px=200",
            "--checkpoint=" + folder_ + "seed.checkpoint",
            "--max_scans=" + std::to_string(max_scans)};
  }

  // Time of a whole run [s].
  double SecondsOfARun() const {
    const auto start = Clock::now();
    RunningProgram run(Command(40), folder_ + "stdout");
    EXPECT_EQ(run.Wait(), 0);
    return SecondsSince(start);
  }

  // Returns how many half-written files there are, under names that say so.
  int CheckFolder() const {
    int num_temporary = 0;
    if (!std::filesystem::exists(folder_ + "out")) return 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ + "out")) {
      const std::string name = entry.path().filename().string();
      if (!TargetOfTemporary(name).empty()) {
        ++num_temporary;
      } else {
        EXPECT_TRUE(IsWhole(entry.path())) << name;
      }
    }
    return num_temporary;
  }

  // summary.json says that the others are there, and of the same run.
  void CheckSet() const {
    for (const std::string& name : kResults) {
      EXPECT_TRUE(std::filesystem::exists(folder_ + "out/" + name)) << name;
    }
    const nlohmann::json summary = Summary();
    EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), summary["scans"]);
    EXPECT_EQ(NumberBehind(Result("out", "points.ply"), "element vertex "), summary["returns"]);
    EXPECT_EQ(NumberBehind(Result("out", "points.pcd"), "POINTS "), summary["returns"]);
  }
};

TEST_F(KillTest, WhatIsThereIsWhole) {
  SimulateLog(40);
  // Of the last run that came to its end. Other work on the machine comes and goes: the time of a
  // single one says little about the others.
  double run_s = SecondsOfARun();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share_of_run(0.0, 1.05);
  int num_runs = 0, num_sets = 0, num_temporary = 0;
  for (int num_killed = 0; num_killed < NumKills() && !HasFailure(); ++num_runs) {
    const auto start = Clock::now();
    RunningProgram run(Command(num_runs % 2 == 0 ? 40 : 30), folder_ + "stdout");
    if (run.EndsWithin(share_of_run(random) * run_s)) run_s = SecondsSince(start);
    run.Send(SIGKILL);
    const int code = run.Wait();
    if (code != 0) ++num_killed;
    EXPECT_TRUE(code == 0 || code == 1000 + SIGKILL) << code << ReadFile(folder_ + "stdout");
    num_temporary = std::max(num_temporary, CheckFolder());
    if (!std::filesystem::exists(folder_ + "out/summary.json")) continue;
    ++num_sets;
    CheckSet();
  }
  std::cout << num_runs << " runs, " << NumKills() << " of them killed, " << num_sets
            << " times a whole set was there, up to " << num_temporary << " half-written files\n";
  // The next run clears up.
  RunningProgram run(Command(40), folder_ + "stdout");
  ASSERT_EQ(run.Wait(), 0);
  EXPECT_EQ(FilesOf("out"), kResults);
  CheckFolder();
  CheckSet();
}

}  // namespace
}  // namespace plumbline
