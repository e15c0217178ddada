// What the programs do with files that are broken: a word on what is wrong and where, an exit code,
// and no output.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::AnyOf;
using testing::Eq;
using testing::HasSubstr;

const std::string kCorpus = PLUMBLINE_CORPUS;

// A line of expected.txt.
struct Expectation {
  std::string path;
  int exit_code = 0;
  std::string words;  // right behind the path
};

std::vector<Expectation> Expectations(const std::string& kind) {
  std::vector<Expectation> expectations;
  for (const std::string& line : Lines(ReadFile(kCorpus + "/expected.txt"))) {
    if (line.compare(0, kind.size() + 1, kind + "/") != 0) continue;
    std::istringstream fields(line);
    Expectation expectation;
    fields >> expectation.path >> expectation.exit_code;
    expectation.path = kCorpus + "/" + expectation.path;
    std::getline(fields >> std::ws, expectation.words);
    expectations.push_back(expectation);
  }
  return expectations;
}

std::size_t NumFilesBelow(const std::string& folder) {
  const std::filesystem::recursive_directory_iterator begin(folder), end;
  return std::distance(begin, end);
}

class BadInputTest : public ProgramTest {
 protected:
  BadInputTest() {
    LimitMemory(2000000);
    std::filesystem::create_directories(made_);
  }

  // A sanitizer takes time, and reserves more addresses than any limit allows.
  void LimitMemory(int kilobytes) {
    limits_ = PLUMBLINE_SANITIZED
                  ? "ulimit -c 0; timeout 200 "
                  : "ulimit -v " + std::to_string(kilobytes) + "; ulimit -c 0; timeout 20 ";
  }

  // In flags, IN stands for the path of the input and OUT for a folder that results may go to.
  Outcome RunOn(const std::string& path, const std::string& program, std::string flags) const {
    std::filesystem::remove_all(made_);
    std::filesystem::create_directories(made_);
    const auto replace = [&flags](const std::string& name, const std::string& value) {
      for (std::size_t at = 0; (at = flags.find(name, at)) != flags.npos; at += value.size()) {
        flags.replace(at, name.size(), value);
      }
    };
    replace("IN", path);
    replace("OUT", made_);
    return Run(program, flags);
  }

  void ExpectRefused(const Outcome& run, const std::string& message) const {
    EXPECT_EQ(run.exit_code, kExitBadInput) << run.err;
    EXPECT_THAT(run.err, HasSubstr(message));
    EXPECT_EQ(NumFilesBelow(made_), 0u);
    const auto is_plain = [](unsigned char c) { return c == '\n' || (c >= ' ' && c <= '~'); };
    EXPECT_TRUE(std::all_of(run.err.begin(), run.err.end(), is_plain)) << run.err;
  }

  // The program meets what expected.txt says of the files of one kind.
  void ExpectAsWritten(const std::string& kind, const std::string& program,
                       const std::string& flags) const {
    const std::vector<Expectation> expectations = Expectations(kind);
    EXPECT_EQ(static_cast<int>(expectations.size()), NumFilesIn(kCorpus + "/" + kind));
    for (const Expectation& expected : expectations) {
      SCOPED_TRACE(expected.path);
      const Outcome run = RunOn(expected.path, program, flags);
      if (expected.exit_code != kExitDone) {
        ExpectRefused(run, expected.path + expected.words);
        continue;
      }
      EXPECT_EQ(run.exit_code, kExitDone) << run.err;
      EXPECT_GT(NumFilesBelow(made_), 0u);
      if (!expected.words.empty()) {
        EXPECT_THAT(run.err, HasSubstr(expected.path + expected.words));
      }
    }
  }

  // Another program refuses what the first one refuses, and does not break on the rest.
  void ExpectRefusedAsWell(const std::string& kind, const std::string& program,
                           const std::string& flags) const {
    for (const Expectation& expected : Expectations(kind)) {
      SCOPED_TRACE(program + " " + expected.path);
      const Outcome run = RunOn(expected.path, program, flags);
      if (expected.exit_code != kExitDone) {
        ExpectRefused(run, expected.path);
      } else {
        EXPECT_THAT(run.exit_code, AnyOf(Eq(kExitDone), Eq(kExitBadInput))) << run.err;
      }
    }
  }

  const std::string made_ = folder_ + "made/";
};

const std::string kTrajectory = " --trajectory=" + kCorpus + "/trajectory/good.tum ";
const std::string kLog = " --log=" + kCorpus + "/carmen/good.clf ";

TEST_F(BadInputTest, LogsToMap) {
  ExpectAsWritten("carmen", "slam", "--log=IN --output_dir=OUTout --picture_side_px=200");
}

TEST_F(BadInputTest, LogsToConvert) {
  ExpectRefusedAsWell("carmen", "convert", "--input=IN --output=OUTa.g2o,OUTa.ply");
}

TEST_F(BadInputTest, LogsToMeasure) {
  ExpectRefusedAsWell("carmen", "evaluate", kTrajectory + "--log=IN --json=OUTa.json");
}

TEST_F(BadInputTest, LogsToReplay) {
  ExpectRefusedAsWell("carmen", "benchmark", "--experiment=replay --log=IN --output_dir=OUTout");
}

TEST_F(BadInputTest, BagsToMap) {
  ExpectAsWritten("bag", "slam", "--log=IN --output_dir=OUTout --picture_side_px=200");
}

TEST_F(BadInputTest, PoseGraphsToRefine) {
  ExpectAsWritten("pose_graph", "slam", "--log=IN --output_dir=OUTout --picture_side_px=200");
}

TEST_F(BadInputTest, PoseGraphsToRefineByDescent) {
  ExpectRefusedAsWell("pose_graph", "slam", "--log=IN --output_dir=OUTout --solver=sgd");
}

TEST_F(BadInputTest, PoseGraphsToConvert) {
  ExpectRefusedAsWell("pose_graph", "convert", "--input=IN --output=OUTa.toro,OUTa.tum");
}

TEST_F(BadInputTest, SavedMapsToRefine) {
  ExpectAsWritten("cartographer", "slam", "--log=IN --output_dir=OUTout --picture_side_px=200");
  ExpectAsWritten("slam_toolbox", "slam", "--log=IN --output_dir=OUTout --picture_side_px=200");
}

TEST_F(BadInputTest, SavedMapsToConvert) {
  ExpectRefusedAsWell("cartographer", "convert", "--input=IN --output=OUTa.g2o");
  ExpectRefusedAsWell("slam_toolbox", "convert", "--input=IN --output=OUTa.g2o,OUTa.tum");
}

TEST_F(BadInputTest, Worlds) {
  ExpectAsWritten("world", "simulate", "--world=IN --log=OUTa.clf --truth=OUTa.tum --num_beams=5");
}

TEST_F(BadInputTest, TrajectoriesToMeasure) {
  ExpectAsWritten("trajectory", "evaluate",
                  "--trajectory=IN --json=OUTa.json --truth=" + kCorpus + "/trajectory/good.tum");
}

TEST_F(BadInputTest, TrajectoriesAsTruth) {
  ExpectRefusedAsWell("trajectory", "evaluate", kTrajectory + "--truth=IN --json=OUTa.json");
  ExpectRefusedAsWell("trajectory", "slam", kLog + "--truth=IN --output_dir=OUTout");
  ExpectRefusedAsWell("trajectory", "convert",
                      "--trajectory=IN --output=OUTa.g2o --input=" + kCorpus + "/carmen/good.clf");
}

TEST_F(BadInputTest, Relations) {
  ExpectAsWritten("relations", "evaluate", kTrajectory + "--relations=IN --json=OUTa.json");
}

TEST_F(BadInputTest, Hits) {
  ExpectAsWritten("hits", "slam",
                  kLog + "--hits=IN --output_dir=OUTout --picture_side_px=200 --truth=" + kCorpus +
                      "/trajectory/good.tum");
}

TEST_F(BadInputTest, Points) {
  ExpectAsWritten("points", "evaluate", "--points=IN --json=OUTa.json");
}

// Every way for a file to come in.
struct Way {
  const char* program;
  std::string flags;
};
const std::vector<Way> kWays = {
    {"slam", "--log=IN --output_dir=OUTout"},
    {"slam", kLog + "--truth=IN --output_dir=OUTout"},
    {"convert", "--input=IN --output=OUTa.tum"},
    {"simulate", "--world=IN --log=OUTa.clf"},
    {"evaluate", "--trajectory=IN --relations=IN --json=OUTa.json"},
    {"evaluate", kTrajectory + "--relations=IN --json=OUTa.json"},
    {"evaluate", kTrajectory + "--log=IN --json=OUTa.json"},
    {"evaluate", "--points=IN --json=OUTa.json"},
    {"benchmark", "--experiment=synthetic,log --log=IN --output_dir=OUTout"},
    {"benchmark", "--experiment=log --relations=IN --output_dir=OUTout" + kLog}};

TEST_F(BadInputTest, WhatIsNoFile) {
  const std::string pipe = folder_ + "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const Way& way : kWays) {
    SCOPED_TRACE(way.program + (" " + way.flags));
    ExpectRefused(RunOn(pipe, way.program, way.flags), "'" + pipe + "': a pipe or a device");
    ExpectRefused(RunOn("/dev/zero", way.program, way.flags), "'/dev/zero': a pipe or a device");
    ExpectRefused(RunOn(kCorpus, way.program, way.flags), kCorpus);
    const std::string below_a_file = kCorpus + "/expected.txt/a";
    ExpectRefused(RunOn(below_a_file, way.program, way.flags), "'" + below_a_file + "'");
  }
}

// 100 MB without a line end, which take no space on the disk.
TEST_F(BadInputTest, AnEndlessLine) {
  const std::string path = folder_ + "line.g2o";
  WriteFile(path, "# comment\nFLASER 2000000000 ");
  std::filesystem::resize_file(path, 100000000);
  LimitMemory(600000);
  for (const Way& way : kWays) {
    SCOPED_TRACE(way.program + (" " + way.flags));
    const bool reads_lines = way.flags.find("--points") == std::string::npos;
    ExpectRefused(RunOn(path, way.program, way.flags),
                  path + (reads_lines ? ":2: the line is longer than 16 MiB" : ":1: not a PLY"));
  }
}

TEST_F(BadInputTest, MoreBeamsThanAnyLaserHas) {
  std::string log = "FLASER 100001";
  for (int i = 0; i < 100001; ++i) log += " 1";
  const std::string path = folder_ + "a.clf";
  WriteFile(path, log + " 0 0 0 0 0 0 1 h 1\n");
  ExpectRefused(RunOn(path, "slam", "--log=IN --output_dir=OUTout"),
                path + ": scan of line 1: laser 0: num_beams = 100001");
}

// Also where it is a thread of the pool that gets none.
TEST_F(BadInputTest, TooLittleMemoryIsNoCrash) {
  if (PLUMBLINE_SANITIZED) GTEST_SKIP() << "memory cannot be limited under a sanitizer";
  SimulateLog(400);
  for (const int kilobytes : {60000, 90000, 120000}) {
    LimitMemory(kilobytes);
    const Outcome run = RunOn(folder_ + "a.clf", "slam", "--log=IN --output_dir=OUTout");
    EXPECT_THAT(run.exit_code, AnyOf(Eq(kExitDone), Eq(kExitBadInput), Eq(kExitCannotWrite)))
        << kilobytes << " kB: " << run.err;
  }
}

// The map would have more cells than a grid may have: known before anything is done.
TEST_F(BadInputTest, AMapTooLargeForItsGrid) {
  WriteFile(folder_ + "a.clf",
            "FLASER 3 1 2 1 0 0 0 0 0 0 1 h 1\nFLASER 3 1 2 1 1e6 1e6 0 1e6 1e6 0 2 h 2\n");
  ExpectRefused(RunOn(folder_ + "a.clf", "slam", "--log=IN --output_dir=OUTout"),
                "a.clf: occupancy grid: ");
  ExpectRefused(RunOn(folder_ + "a.clf", "convert", "--input=IN --output=OUTa.tum,OUTa.pgm"),
                "a.clf: occupancy grid: ");
}

TEST_F(BadInputTest, OutputThatCannotBeWritten) {
  WriteFile(folder_ + "file", "in the way");
  const std::string log = kCorpus + "/carmen/good.clf";
  const std::vector<Way> ways = {
      {"slam", "--log=IN --output_dir=" + folder_ + "file/out"},
      {"convert", "--input=IN --output=" + folder_ + "file/a.tum"},
      {"simulate", "--num_beams=3 --log=OUTnone/a.clf --world=" + kCorpus + "/world/good.world"},
      {"evaluate", kTrajectory + "--log=IN --json=OUTnone/a.json"},
      {"benchmark", "--experiment=replay --log=IN --output_dir=" + folder_ + "file"}};
  for (const Way& way : ways) {
    SCOPED_TRACE(way.program);
    const Outcome run = RunOn(log, way.program, way.flags);
    EXPECT_EQ(run.exit_code, kExitCannotWrite) << run.err;
    EXPECT_EQ(NumFilesBelow(made_), 0u);
    EXPECT_EQ(ReadFile(folder_ + "file"), "in the way");
  }
}

TEST_F(BadInputTest, HelpNamesTheExitCodes) {
  for (const char* program : {"slam", "convert", "simulate", "evaluate", "benchmark"}) {
    EXPECT_THAT(Run(program, "--help").out,
                HasSubstr("\nExit code: 0 done, 1 bad input, 2 wrong flags, 3 "));
  }
}

}  // namespace
}  // namespace plumbline
