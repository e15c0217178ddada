// A run may be killed at any time: whatever is in its folder then is whole.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
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

  double SecondsOfARun() const {
    const auto start = Clock::now();
    RunningProgram run(Command(40), folder_ + "stdout");
    EXPECT_EQ(run.Wait(), 0);
    return std::chrono::duration<double>(Clock::now() - start).count();
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
  const double run_s = SecondsOfARun();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> delay_s(0.0, 1.05 * run_s);
  int num_killed = 0, num_sets = 0, num_temporary = 0;
  for (int i = 0; i < NumKills() && !HasFailure(); ++i) {
    RunningProgram run(Command(i % 2 == 0 ? 40 : 30), folder_ + "stdout");
    std::this_thread::sleep_for(std::chrono::duration<double>(delay_s(random)));
    run.Send(SIGKILL);
    if (run.Wait() != 0) ++num_killed;
    num_temporary = std::max(num_temporary, CheckFolder());
    if (!std::filesystem::exists(folder_ + "out/summary.json")) continue;
    ++num_sets;
    CheckSet();
  }
  std::cout << num_killed << " runs killed, " << num_sets << " times a whole set was there, up to "
            << num_temporary << " half-written files\n";
  EXPECT_GT(num_killed, NumKills() / 2);
  // The next run clears up.
  RunningProgram run(Command(40), folder_ + "stdout");
  ASSERT_EQ(run.Wait(), 0);
  EXPECT_EQ(FilesOf("out"), kResults);
  CheckFolder();
  CheckSet();
}

}  // namespace
}  // namespace plumbline
