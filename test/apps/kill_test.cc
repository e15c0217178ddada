// Programs may be stopped or killed at any time: what they leave is whole.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/room_as_g2o.h"
#include "plumbline/test/apps/running_program.h"
#include "plumbline/test/apps/whole_files.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::AnyOf;
using testing::ContainsRegex;
using testing::Eq;

using Clock = std::chrono::steady_clock;
using Files = std::map<std::string, std::string>;  // by their names

constexpr int kSeed = 5;

// How a run ends early: by a signal, and in some cases another one soon after it.
struct Way {
  int signal = 0, second_signal = 0;
};
const std::vector<Way> kWays = {{SIGKILL}, {SIGINT},         {SIGTERM},
                                {SIGHUP},  {SIGINT, SIGINT}, {SIGTERM, SIGINT}};

std::string NameOf(int signal) {
  return signal == SIGINT ? "SIGINT" : signal == SIGTERM ? "SIGTERM" : "SIGHUP";
}

// A program to end early. "OUT" stands for its folder.
struct Victim {
  std::string program;
  std::vector<std::string> flags;
  std::vector<std::string> variants;  // a flag each: the results differ
  bool makes_its_folder = false;
  bool keeps_its_state = false;  // a stop lets it write the best state so far
  std::string folder = "";
  std::vector<Files> results = {};  // of whole runs, by variant
  double run_s = 0.0;  // of the last run that came to its end: other work comes and goes
};

// Environment variable PLUMBLINE_KILLS: how many runs to end early.
int NumKills(std::size_t num_victims) {
  const char* number = std::getenv("PLUMBLINE_KILLS");
  return number == nullptr ? static_cast<int>(num_victims * kWays.size()) : std::atoi(number);
}

// Empty if it is not there.
std::optional<Files> ReadFolder(const std::string& folder) {
  if (!std::filesystem::exists(folder)) return std::nullopt;
  Files files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files[entry.path().filename().string()] = ReadFile(entry.path().string());
  }
  return files;
}

class KillTest : public ProgramTest {
 protected:
  void MakeVictims() {
    SimulateLog(40);
    WriteFile(folder_ + "a.g2o", AsG2o(MakeNoisyRoom()));
    const std::string log = "--log=" + folder_ + "a.clf", graph = "--log=" + folder_ + "a.g2o";
    const std::string truth = "=" + folder_ + "a.tum", pictures = "--picture_side_px=200";
    Add({"slam",
         {log, "--output_dir=OUT", pictures},
         {"--max_scans=40", "--max_scans=30"},
         true,
         true});
    Add({"slam", {graph, "--output_dir=OUT"}, {pictures, "--picture_side_px=150"}, true, true});
    Add({"simulate",
         {"--world=" PLUMBLINE_WORLD, "--log=OUTa.clf", "--truth=OUTa.tum", "--hits=OUTa.txt"},
         {"--seed=1", "--seed=2"}});
    Add({"evaluate",
         {log, "--trajectory" + truth, "--truth" + truth, "--csv=OUTa.csv", "--json=OUTa.json"},
         {"--rpe_delta_m=1", "--rpe_delta_m=2"}});
    Add({"convert",
         {"--input=" + folder_ + "all.clf", "--output=OUTa.g2o,OUTa.ply,OUTa.yaml"},
         {"--map_resolution_m=0.05", "--map_resolution_m=0.1"}});
    Add({"benchmark",
         {"--experiment=replay", log, "--output_dir=OUT"},
         {"--batch_scans=10", "--batch_scans=20"},
         true});
  }

  void Add(Victim victim) {
    victim.folder = folder_ + victim.program + std::to_string(victims_.size()) + "/";
    for (std::string& flag : victim.flags) {
      flag = std::regex_replace(flag, std::regex("OUT"), victim.folder);
    }
    if (!victim.makes_its_folder) std::filesystem::create_directory(victim.folder);
    for (std::size_t variant = 0; variant < victim.variants.size(); ++variant) {
      RunToItsEnd(variant, &victim);
      victim.results.push_back(ReadFolder(victim.folder).value_or(Files()));
    }
    ASSERT_FALSE(victim.results[0].empty());
    victims_.push_back(std::move(victim));
  }

  std::vector<std::string> Command(const Victim& victim, std::size_t variant) const {
    std::vector<std::string> command = {PLUMBLINE_PROGRAMS_DIR "/plumbline_" + victim.program};
    command.insert(command.end(), victim.flags.begin(), victim.flags.end());
    command.push_back(victim.variants[variant]);
    return command;
  }
  std::string Printed() const { return ReadFile(folder_ + "printed"); }

  void RunToItsEnd(std::size_t variant, Victim* victim) {
    const auto start = Clock::now();
    RunningProgram run(Command(*victim, variant), folder_ + "printed");
    ASSERT_EQ(run.Wait(), 0) << Printed();
    victim->run_s = SecondsSince(start);
  }

  // Starts a run and ends it at some time.
  void EndARun(std::size_t variant, const Way& way, Victim* victim) {
    const std::optional<Files> before = ReadFolder(victim->folder);
    const auto start = Clock::now();
    RunningProgram run(Command(*victim, variant), folder_ + "printed");
    if (way.signal != SIGKILL) {
      ASSERT_TRUE(run.Catches(way.signal));
    }
    if (run.EndsWithin(share_of_run_(random_) * victim->run_s)) victim->run_s = SecondsSince(start);
    const auto stop = Clock::now();
    run.Send(way.signal);
    if (way.second_signal != 0) {
      run.EndsWithin(0.05 * share_of_run_(random_));
      run.Send(way.second_signal);
    }
    const int code = run.Wait();
    const double time_s = SecondsSince(stop);
    SCOPED_TRACE(victim->program + " " + std::to_string(way.signal) + " " +
                 std::to_string(way.second_signal) + ": " + std::to_string(code) + "\n" +
                 Printed());
    ++num_runs_;
    if (code != 0) ++num_ended_early_;
    if (way.second_signal != 0) {
      EXPECT_THAT(code, AnyOf(Eq(0), IsEndBy(way.signal), IsEndBy(way.second_signal)));
    } else if (way.signal == SIGKILL) {
      EXPECT_THAT(code, AnyOf(Eq(0), Eq(1000 + SIGKILL)));
    } else {
      EXPECT_THAT(code, AnyOf(Eq(0), Eq(128 + way.signal)));
      CheckStop(*victim, way.signal, code, before, time_s);
    }
    CheckFolder(*victim, before.value_or(Files()), way.signal == SIGKILL);
  }
  static testing::Matcher<int> IsEndBy(int signal) {
    return AnyOf(Eq(128 + signal), Eq(1000 + signal));
  }

  // What a run says that is stopped by one signal: it writes all that it can, or nothing more.
  void CheckStop(const Victim& victim, int signal, int code, const std::optional<Files>& before,
                 double time_s) {
    const std::string printed = Printed();
    const bool has_state = printed.find("\nStopped by " + NameOf(signal)) != printed.npos;
    if (victim.keeps_its_state && (code == 0 || has_state)) {
      const nlohmann::json summary =
          nlohmann::json::parse(ReadFile(victim.folder + "summary.json"));
      EXPECT_EQ(summary["stopped_by"],
                code == 0 ? nlohmann::json() : nlohmann::json(NameOf(signal)));
      if (code != 0) ++num_states_;
    } else if (code != 0) {
      EXPECT_THAT(printed,
                  ContainsRegex("plumbline_" + victim.program + ": stopped by " + NameOf(signal) +
                                " while .*: no(thing is written|"
                                " file is half-written)\n$"));
      if (printed.find("nothing is written") == printed.npos) return;
      EXPECT_LT(time_s, 1.0);  // not of writing: a disk takes its time
      EXPECT_TRUE(ReadFolder(victim.folder) == before);
      ++num_nothing_written_;
    }
  }

  // Half-written files are left by kills only, under names that say so.
  void CheckFolder(const Victim& victim, const Files& before, bool was_killed) {
    const Files files = ReadFolder(victim.folder).value_or(Files());
    for (const auto& [name, bytes] : files) {
      if (TargetOfTemporary(name).empty()) {
        EXPECT_TRUE(IsWholeResult(victim, name, bytes)) << name;
      } else if (before.count(name) == 0) {
        EXPECT_TRUE(was_killed) << name;
        ++num_half_written_;
      }
    }
    if (files.count("summary.json") == 1) CheckSet(victim, files);
  }

  static bool IsWholeResult(const Victim& victim, const std::string& name,
                            const std::string& bytes) {
    bool is_known = false;
    for (const Files& results : victim.results) {
      const auto result = results.find(name);
      if (result == results.end()) continue;
      if (result->second == bytes) return true;
      is_known = true;
    }
    return is_known && IsWhole(victim.folder + name);
  }

  // summary.json says that the others are there, and of the same run.
  void CheckSet(const Victim& victim, const Files& files) {
    ++num_sets_;
    for (const auto& [name, bytes] : victim.results[0]) ASSERT_EQ(files.count(name), 1u) << name;
    const nlohmann::json summary = nlohmann::json::parse(files.at("summary.json"));
    EXPECT_EQ(Lines(files.at("trajectory.tum")).size(), summary["scans"]);
    EXPECT_EQ(NumberBehind(files.at("points.ply"), "element vertex "), summary["returns"]);
    EXPECT_EQ(NumberBehind(files.at("points.pcd"), "POINTS "), summary["returns"]);
  }

  // The next run makes up for all that was left undone.
  void CheckNextRun(Victim* victim) {
    SCOPED_TRACE(victim->program);
    RunToItsEnd(0, victim);
    Files files = ReadFolder(victim->folder).value_or(Files());
    CheckFolder(*victim, files, false);
    for (const auto& [name, bytes] : victim->results[0]) EXPECT_EQ(files.erase(name), 1u) << name;
    if (victim->keeps_its_state) {
      EXPECT_TRUE(files.empty()) << files.begin()->first;
    }
  }

  std::vector<Victim> victims_;
  std::mt19937 random_{kSeed};
  std::uniform_real_distribution<double> share_of_run_{0.0, 1.05};
  int num_runs_ = 0, num_ended_early_ = 0, num_sets_ = 0, num_half_written_ = 0;
  int num_states_ = 0, num_nothing_written_ = 0;
};

TEST_F(KillTest, WhatIsThereIsWhole) {
  MakeVictims();
  const int num_kills = NumKills(victims_.size());
  while (num_ended_early_ < num_kills && !HasFailure()) {
    Victim& victim = victims_[num_runs_ % victims_.size()];
    const std::size_t round = num_runs_ / victims_.size();
    if (victim.makes_its_folder && round % 3 == 0) std::filesystem::remove_all(victim.folder);
    EndARun(round % victim.variants.size(), kWays[round % kWays.size()], &victim);
  }
  std::cout << "Seed " << kSeed << ": " << num_runs_ << " runs, " << num_ended_early_
            << " of them ended early. " << num_states_
            << " stopped ones wrote the best state so far, " << num_nothing_written_
            << " wrote nothing. A whole set of results was there " << num_sets_ << " times, "
            << num_half_written_ << " files were left half-written by kills\n";
  for (Victim& victim : victims_) CheckNextRun(&victim);
}

}  // namespace
}  // namespace plumbline
