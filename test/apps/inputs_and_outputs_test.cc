// What the programs promise about the files that they read and write, for all flags that mean
// files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "plumbline/apps/program/output_folder.h"
#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/room_as_g2o.h"
#include "plumbline/test/apps/running_program.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Flags = std::map<std::string, std::string>;

struct Program {
  std::string name;
  std::set<std::string> inputs;
  Flags flags;              // of a run; "IN/" stands for the folder of the test
  std::string folder = "";  // the flag of the output folder, if there is one
};

// Flags that are empty by default, as those of files are, and mean no file. Any other one that is
// no input means an output.
const std::set<std::string> kTexts = {
    "start",      "calibrate",  "ceres",      "odometry_noise", "building",      "format",
    "experiment", "scan_topic", "odom_topic", "laser_frame",    "slice_height_m"};
const std::vector<Program> kPrograms = {
    {"slam",
     {"log", "info", "fixed_map", "truth", "hits"},
     {{"log", "IN/a.clf"}, {"truth", "IN/a.tum"}, {"output_dir", "IN/out"}},
     "output_dir"},
    {"simulate",
     {"world"},
     {{"world", PLUMBLINE_WORLD}, {"log", "IN/sim.clf"}, {"num_beams", "9"}}},
    {"evaluate",
     {"trajectory", "relations", "truth", "log", "points"},
     {{"trajectory", "IN/a.tum"}, {"truth", "IN/a.tum"}}},
    {"convert", {"input", "trajectory"}, {{"input", "IN/a.clf"}, {"output", "IN/b.tum"}}},
    {"benchmark",
     {"log", "graph", "relations", "corrected_log"},
     {{"experiment", "replay,seeding_study"},
      {"log", "IN/a.clf"},
      {"output_dir", "IN/out"},
      {"buildings", "1"}},
     "output_dir"}};

class InputsAndOutputsTest : public ProgramTest {
 protected:
  void SetUp() override { SimulateLog(20); }

  Outcome RunWith(const Program& program, Flags flags, const std::string& output = "") const {
    if (flags.count("fixed_map") > 0) flags.erase("truth");
    std::string arguments;
    for (const auto& [flag, value] : flags) {
      arguments += " --" + flag + "=" + std::regex_replace(value, std::regex("IN/"), folder_);
    }
    return Run(program.name, arguments, output);
  }
  // With one flag set anew.
  Outcome RunWith(const Program& program, const std::string& flag, const std::string& value,
                  const std::string& output = "") const {
    Flags flags = program.flags;
    flags[flag] = value;
    return RunWith(program, flags, output);
  }

  // All flags of a program that mean files, as its help has them.
  std::vector<std::string> FileFlagsOf(const Program& program) const {
    std::vector<std::string> flags;
    for (const std::string& line : Lines(Run(program.name, "--help").out)) {
      std::smatch match;
      if (!std::regex_match(line, match, std::regex("  --([a-z0-9_]+)="))) continue;
      if (kTexts.count(match[1]) == 0) flags.push_back(match[1]);
    }
    EXPECT_FALSE(flags.empty());
    return flags;
  }
  std::vector<std::string> OutputsOf(const Program& program) const {
    std::vector<std::string> flags;
    for (const std::string& flag : FileFlagsOf(program)) {
      if (program.inputs.count(flag) == 0 && flag != program.folder) flags.push_back(flag);
    }
    return flags;
  }
  // A log in a map has no truth.
  static bool ExcludeEachOther(const std::string& one, const std::string& other) {
    const std::set<std::string> of_a_log = {"truth", "hits"};
    return (one == "fixed_map" && of_a_log.count(other) > 0) ||
           (other == "fixed_map" && of_a_log.count(one) > 0);
  }
  // Name of a file that an output flag takes.
  static std::string NameFor(const std::string& name) { return name + ".tum"; }

  void ExpectRefused(const Program& program, const Flags& flags, const std::string& one,
                     const std::string& other) const {
    const Outcome run = RunWith(program, flags);
    EXPECT_EQ(run.exit_code, kExitWrongUsage) << run.err;
    EXPECT_THAT(run.err, AllOf(HasSubstr("--" + one), HasSubstr("--" + other),
                               HasSubstr("an output must be neither an input nor another")));
    EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
    EXPECT_THAT(run.out, IsEmpty());
  }
};

TEST_F(InputsAndOutputsTest, NamesOfFilesReachNoTerminalAndNoPageAsTheyAre) {
  SimulateLog(20);
  const std::string name = "a\x1b[31m\xff.clf", shown = "a\\x1b[31m\\xff.clf";
  std::filesystem::rename(folder_ + "a.clf", folder_ + name);
  const std::string output = " --output_dir=" + folder_ + "out --picture_side_px=200";
  const Outcome run = Run("slam", "--log='" + folder_ + name + "'" + output);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Outcome refused = Run("slam", "--log='" + folder_ + "no" + name + "'" + output);
  for (const std::string& text : {run.out, refused.err, Result("out", "report.html")}) {
    EXPECT_THAT(text, HasSubstr(shown));
    EXPECT_THAT(text, Not(HasSubstr("\x1b")));
    EXPECT_THAT(text, Not(HasSubstr("\xff")));
  }
}

TEST_F(InputsAndOutputsTest, NoOutputIsAnInputOrAnotherOutput) {
  const std::string file = NameFor(folder_ + "same");
  WriteFile(file, "precious");
  std::filesystem::create_symlink(file, NameFor(folder_ + "soft"));
  std::filesystem::create_hard_link(file, NameFor(folder_ + "hard"));
  std::filesystem::create_directory_symlink(".", folder_ + "here");
  for (const Program& program : kPrograms) {
    const std::vector<std::string> flags = FileFlagsOf(program);
    int num_refused = 0;
    for (const std::string& one : flags) {
      for (const std::string& other : flags) {
        if (one >= other || ExcludeEachOther(one, other)) continue;
        for (const char* spelling : {"same", "soft", "hard", "none/../here/same"}) {
          SCOPED_TRACE(program.name + " --" + one + " --" + other + " " + spelling);
          Flags both = program.flags;
          both[one] = file;
          both[other] = NameFor(std::string("IN/") + spelling);
          if (program.inputs.count(one) + program.inputs.count(other) == 2) {
            const Outcome run = RunWith(program, both);
            EXPECT_EQ(run.exit_code, kExitBadInput);  // what is in it
            EXPECT_THAT(run.err, Not(HasSubstr("an output must be")));
          } else {
            ExpectRefused(program, both, one, other);
            ++num_refused;
          }
          EXPECT_EQ(ReadFile(file), "precious");
        }
      }
    }
    EXPECT_GT(num_refused, 0) << program.name;
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out")) << program.name;
  }
}

TEST_F(InputsAndOutputsTest, NoFileOfTheOutputFolderIsAnInputOrAnotherOutput) {
  for (const Program& program : kPrograms) {
    if (program.folder.empty()) continue;
    const Outcome run = RunWith(program, program.flags);
    ASSERT_EQ(run.exit_code, kExitDone) << run.err;
    std::vector<std::string> names = FilesOf("out");
    if (program.name == "slam") names.insert(names.end(), {"graph.toro", "map.pgm.1-0.tmp"});
    WriteFile(folder_ + "out/map.pgm.1-0.tmp", "left half-written");
    for (const std::string& flag : FileFlagsOf(program)) {
      if (flag == program.folder) continue;
      for (const std::string& name : names) {
        SCOPED_TRACE(program.name + " --" + flag + " " + name);
        Flags flags = program.flags;
        flags[flag] = "IN/out/../out/" + name;
        const std::string before = ReadFile(folder_ + "out/" + name);
        ExpectRefused(program, flags, flag, program.folder);
        EXPECT_TRUE(ReadFile(folder_ + "out/" + name) == before);
      }
    }
    std::filesystem::remove_all(folder_ + "out");
  }
}

TEST_F(InputsAndOutputsTest, AllFilesOfExperimentsAreDeclared) {
  const auto root = std::filesystem::path(PLUMBLINE_WORLD).parent_path().parent_path();
  const std::string source = ReadFile((root / "apps/benchmark_main.cc").string());
  const std::size_t table = source.find("kExperiments[]");
  ASSERT_NE(table, std::string::npos);
  const std::regex file("\\bFile\\(\"([^\"]+)\"\\)");
  int count = 0;
  for (std::sregex_iterator match(source.begin(), source.begin() + table, file), end; match != end;
       ++match, ++count) {
    EXPECT_TRUE(std::regex_search(source.begin() + table, source.end(),
                                  std::regex("[\" ]" + (*match)[1].str() + "[\" ]")))
        << (*match)[1];
  }
  EXPECT_GT(count, 15);
}

TEST_F(InputsAndOutputsTest, NoOutputIsTheFileThatTheFlagsComeFrom) {
  WriteFile(folder_ + "flags", "--building=random\n");
  const Outcome run = Run("simulate", "--flagfile=" + folder_ + "flags --log=" + folder_ + "flags");
  ExpectUsageError(run, "--flagfile and --log both mean the file");
  EXPECT_EQ(ReadFile(folder_ + "flags"), "--building=random\n");
}

TEST_F(InputsAndOutputsTest, AnInputMayBeInTheOutputFolderUnderANameOfItsOwn) {
  std::filesystem::create_directory(folder_ + "out");
  std::filesystem::rename(folder_ + "a.clf", folder_ + "out/a.clf");
  const Outcome run = Slam("out/a.clf");
  EXPECT_EQ(run.exit_code, kExitDone) << run.err;
  EXPECT_EQ(FilesOf("out").size(), kResults.size() + 1);
}

TEST_F(InputsAndOutputsTest, OneTableIsForOneExperiment) {
  const Outcome run = Run("benchmark", "--experiment=scaling,seeding_study --csv=" + folder_ + "t");
  ExpectUsageError(run, "--csv means the file '" + folder_ + "t' twice");
}

TEST_F(InputsAndOutputsTest, AnOutputThroughALinkLeavesTheLink) {
  std::filesystem::create_directory(folder_ + "other");
  for (const Program& program : kPrograms) {
    for (const std::string& flag : OutputsOf(program)) {
      SCOPED_TRACE(program.name + " --" + flag);
      const std::string link = NameFor(folder_ + flag), target = folder_ + "other/" + flag;
      std::filesystem::remove(target);
      std::filesystem::remove(link);
      std::filesystem::create_symlink(target, link);
      const Outcome run = RunWith(program, flag, link);
      EXPECT_EQ(run.exit_code, kExitDone) << run.err;
      EXPECT_TRUE(std::filesystem::is_symlink(link));
      EXPECT_FALSE(ReadFile(target).empty());
    }
  }
}

TEST_F(InputsAndOutputsTest, AnOutputThatCannotBeWrittenIsRefusedBeforeAnythingIsRead) {
  const std::string folder = NameFor(folder_ + "folder"), homeless = NameFor(folder_ + "none/file");
  std::filesystem::create_directory(folder);
  for (const std::string name : {"a.clf", "a.tum"}) std::filesystem::remove(folder_ + name);
  for (const Program& program : kPrograms) {
    for (const std::string& flag : OutputsOf(program)) {
      SCOPED_TRACE(program.name + " --" + flag);
      for (const std::string& file : {folder, homeless}) {
        ExpectError(RunWith(program, flag, file),
                    "cannot write '" + file + "': ", kExitCannotWrite);
      }
    }
  }
}

// Through a link, so that a mistake costs the link and no device.
TEST_F(InputsAndOutputsTest, AFullDeviceIsAnError) {
  const std::string file = NameFor(folder_ + "full");
  std::filesystem::create_symlink("/dev/full", file);
  for (const Program& program : kPrograms) {
    for (const std::string& flag : OutputsOf(program)) {
      SCOPED_TRACE(program.name + " --" + flag);
      const Outcome run = RunWith(program, flag, file);
      EXPECT_EQ(run.exit_code, kExitCannotWrite);
      EXPECT_THAT(run.err, HasSubstr("cannot write '" + file + "': No space left on device"));
      EXPECT_TRUE(std::filesystem::is_character_file(file));
    }
  }
}

// Through a link as /dev/stdout is one.
TEST_F(InputsAndOutputsTest, AnOutputMayBeStandardOutput) {
  std::filesystem::create_symlink("/proc/self/fd/1", folder_ + "stdout_link");
  for (const Program& program : kPrograms) {
    for (const std::string& flag : OutputsOf(program)) {
      SCOPED_TRACE(program.name + " --" + flag);
      Flags flags = program.flags;
      if (program.name == "convert") flags["format"] = "tum";
      flags[flag] = folder_ + "file";
      const Outcome to_file = RunWith(program, flags);
      flags[flag] = folder_ + "stdout_link";
      const Outcome run = RunWith(program, flags);
      EXPECT_EQ(run.exit_code, kExitDone) << run.err;
      // A file at standard output holds both, and so does a pipe.
      EXPECT_GT(run.out.size(), ReadFile(folder_ + "file").size());
      EXPECT_THAT(run.out, HasSubstr(ReadFile(folder_ + "file").substr(0, 20)));
      RunWith(program, flags, "&1 2>/dev/null | cat >" + folder_ + "piped");
      EXPECT_GT(ReadFile(folder_ + "piped").size(), ReadFile(folder_ + "file").size());
    }
  }
}

TEST_F(InputsAndOutputsTest, StandardOutputThatTakesNothingIsAnError) {
  for (const Program& program : kPrograms) {
    for (const std::string output : {"/dev/full", "&-"}) {
      SCOPED_TRACE(program.name + " >" + output);
      for (const Outcome& run :
           {RunWith(program, program.flags, output), Run(program.name, "--help", output)}) {
        EXPECT_EQ(run.exit_code, kExitCannotWrite);
        EXPECT_THAT(run.err, HasSubstr("cannot write to 'standard output'"));
      }
    }
  }
}

TEST_F(InputsAndOutputsTest, AFileDoesNotTakeThePlaceOfAClosedStream) {
  const std::string flags = "--trajectory=" + folder_ + "a.tum --truth=" + folder_ + "a.tum --csv=";
  ASSERT_EQ(Run("evaluate", flags + folder_ + "a.csv").exit_code, kExitDone);
  EXPECT_EQ(Run("evaluate", flags + folder_ + "b.csv", "&- <&-").exit_code, kExitCannotWrite);
  EXPECT_EQ(ReadFile(folder_ + "a.csv"), ReadFile(folder_ + "b.csv"));
}

TEST_F(InputsAndOutputsTest, AFolderIsForOneRunAtATime) {
  WriteFile(folder_ + "a.g2o", AsG2o(MakeNoisyRoom()));
  for (const Program& program : kPrograms) {
    if (program.folder.empty()) continue;
    for (const char* log : {"IN/a.clf", "IN/a.g2o"}) {
      if (program.name == "benchmark" && log == std::string("IN/a.g2o")) continue;
      SCOPED_TRACE(program.name + " " + log);
      Flags flags = program.flags;
      flags["log"] = log;
      if (log == std::string("IN/a.g2o")) flags.erase("truth");
      std::filesystem::remove_all(folder_ + "out");
      {
        OutputFolder other_run(folder_ + "out");
        ASSERT_TRUE(other_run.Make().ok());
        for (const char* name : {"summary.json", "map.pgm.1-0.tmp"}) {
          WriteFile(folder_ + "out/" + name, "of the other run");
        }
        const Outcome run = RunWith(program, flags);
        EXPECT_EQ(run.exit_code, kExitCannotWrite);
        EXPECT_THAT(run.err, HasSubstr("the folder '" + folder_ + "out' is in use"));
        for (const char* name : {"summary.json", "map.pgm.1-0.tmp"}) {
          EXPECT_EQ(Result("out", name), "of the other run");
        }
        EXPECT_EQ(FilesOf("out").size(), 2u);
      }
      EXPECT_EQ(RunWith(program, flags).exit_code, kExitDone);
    }
  }
}

TEST_F(InputsAndOutputsTest, AKilledRunLeavesItsFolderFree) {
  RunningProgram run(
      {std::string(PLUMBLINE_PROGRAMS_DIR) + "/plumbline_slam", "--log=" + folder_ + "a.clf",
       "--output_dir=" + folder_ + "out", "--solver=alternating_cg", "--coarse_rounds=0",
       "--cg_max_sweeps=100000000", "--cg_tolerance=0"},
      folder_ + "printed");
  ASSERT_TRUE(run.Prints("\n   3     1 "));
  EXPECT_THAT(Slam("a.clf").err, HasSubstr("is in use"));
  run.Send(SIGKILL);
  run.Wait();
  WriteFile(folder_ + "out/map.pgm.1-0.tmp", "left half-written");
  EXPECT_EQ(Slam("a.clf").exit_code, kExitDone);
  EXPECT_EQ(FilesOf("out"), kResults);
}

}  // namespace
}  // namespace plumbline
