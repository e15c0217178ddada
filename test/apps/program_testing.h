#ifndef PLUMBLINE_TEST_APPS_PROGRAM_TESTING_H_
#define PLUMBLINE_TEST_APPS_PROGRAM_TESTING_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/apps/program/command_line.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {

/// What a run over a CARMEN log leaves.
inline const std::vector<std::string> kResults = {
    "before_after.png", "closures.png",   "conflicts.png",      "graph.g2o",
    "map.pgm",          "map.yaml",       "map_odometry.png",   "map_refined.png",
    "map_seed.png",     "points.pcd",     "points.ply",         "report.html",
    "summary.json",     "trajectory.tum", "trajectory_seed.tum"};

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

inline std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Runs the programs from end to end, as a user does, in a folder of the test's own.
class ProgramTest : public testing::Test {
 protected:
  // output: another place for what the program prints, of which `out` then holds nothing.
  Outcome Run(const std::string& program, const std::string& arguments,
              const std::string& output = "") const {
    const std::string out = folder_ + "stdout", err = folder_ + "stderr";
    WriteFile(out, "");
    const std::string command = limits_ + std::string(PLUMBLINE_PROGRAMS_DIR) + "/plumbline_" +
                                program + " " + arguments + " >" + (output.empty() ? out : output) +
                                " 2>" + err;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(out), ReadFile(err)};
  }
  Outcome Slam(const std::string& log, const std::string& flags = "",
               const std::string& output_dir = "out") const {
    return Run("slam",
               "--log=" + folder_ + log + " --output_dir=" + folder_ + output_dir + " " + flags);
  }

  // The first scans of a drive through the small building, and the truth of the whole. Tests of one
  // process share the drive.
  void SimulateLog(int num_scans, const std::string& flags = "") {
    static const std::vector<std::string> names = {"all.clf", "a.tum", "a.hits"};
    static std::map<std::string, std::vector<std::string>> drives;  // their files, by the flags
    std::vector<std::string>& files = drives[flags];
    if (files.empty()) {
      const Outcome run = Run("simulate", "--world=" PLUMBLINE_WORLD " --log=" + folder_ +
                                              "all.clf --truth=" + folder_ +
                                              "a.tum --hits=" + folder_ + "a.hits " + flags);
      ASSERT_EQ(run.exit_code, 0) << run.err;
      EXPECT_THAT(run.out, testing::HasSubstr(" scans, "));
      EXPECT_THAT(run.err, testing::IsEmpty());
      for (const std::string& name : names) files.push_back(ReadFile(folder_ + name));
    } else {
      for (std::size_t i = 0; i < names.size(); ++i) WriteFile(folder_ + names[i], files[i]);
    }
    log_lines_.clear();
    std::istringstream lines(files[0]);
    const std::size_t num_lines = 2 + 2 * num_scans;  // two PARAM, then ODOM and FLASER by turns
    for (std::string line; log_lines_.size() < num_lines && std::getline(lines, line);) {
      log_lines_.push_back(line);
    }
    ASSERT_EQ(log_lines_.size(), num_lines);
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
  void ExpectError(const Outcome& run, const std::string& message,
                   ExitCode exit_code = kExitBadInput) const {
    EXPECT_EQ(run.exit_code, exit_code);
    EXPECT_THAT(run.err, testing::HasSubstr(message));
    EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out"));
  }

  void ExpectUsageError(const Outcome& run, const std::string& message) const {
    ExpectError(run, message, kExitWrongUsage);
  }

  const std::string folder_ = TempFolder();
  std::string limits_;  // of the shell, put before a program
  std::vector<std::string> log_lines_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_PROGRAM_TESTING_H_
