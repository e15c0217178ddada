// Numbers on the command line that make no sense, for all flags of all programs that are numbers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

struct Program {
  std::string name;
  std::string flags;  // "IN/" stands for the folder of the test, "OUT/" for one in it
  std::vector<std::string> choices;  // of which one at least reads the flag
};

// The flags of plumbline_benchmark's solvers are those of plumbline_slam.
const std::vector<Program> kPrograms = {
    {"slam",
     "--log=IN/a.clf --output_dir=OUT/out --picture_side_px=100",
     {"--shape", "--shape --solver=alternating_cg", "--solver=published", "--shape --solver=ceres",
      "--solver=sgd"}},
    {"simulate",
     "--world=" PLUMBLINE_WORLD " --log=OUT/sim.clf --num_beams=3",
     {"", "--fault=frozen", "--fault=slip", "--fault=mounting"}},
    {"evaluate", "--trajectory=IN/a.tum --truth=IN/a.tum --json=OUT/a.json", {""}},
    {"convert", "--input=IN/a.clf --output=OUT/map.pgm", {""}},
    {"benchmark",
     "--log=IN/a.clf --output_dir=OUT/out",
     {"--experiment=replay", "--experiment=solver_comparison --solvers=reduced"}}};

class NumberFlagsTest : public ProgramTest {
 protected:
  void SetUp() override {
    SimulateLog(3);
    limits_ = "timeout 10 ";
  }

  std::set<std::string> NumberFlagsOf(const std::string& program) const {
    std::set<std::string> flags;
    for (const std::string& line : Lines(Run(program, "--help").out)) {
      std::smatch match;
      const std::regex number("  --([a-z0-9_]+)=-?[0-9][-+.e0-9]*");
      if (std::regex_match(line, match, number)) flags.insert(match[1]);
    }
    flags.erase("max_memory");  // a size, as 4GB
    flags.erase("scans");       // a list
    return flags;
  }

  // With the first of the program's choices that reads the flag.
  Outcome RunWith(const Program& program, const std::string& flag) const {
    std::filesystem::remove_all(folder_ + "made");
    std::filesystem::create_directory(folder_ + "made");
    std::string flags = std::regex_replace(program.flags, std::regex("IN/"), folder_);
    flags = std::regex_replace(flags, std::regex("OUT/"), folder_ + "made/");
    Outcome run;
    for (const std::string& choice : program.choices) {
      run = Run(program.name, flags + ' ' + flag + ' ' + choice);
      const bool is_read = run.err.find("is ignored by") == std::string::npos &&
                           run.err.find("does not belong to") == std::string::npos;
      if (is_read) break;
    }
    return run;
  }

  void ExpectRunsOrNames(const Program& program, const std::string& flag) const {
    for (const char* value : {"0", "-1", "nan", "inf", "1e-300", "1e308", "2147483647"}) {
      const std::string setting = "--" + flag + "=" + value;
      SCOPED_TRACE(program.name + " " + setting);
      const Outcome run = RunWith(program, setting);
      EXPECT_THAT(run.exit_code, AnyOf(kExitDone, kExitWrongUsage)) << run.err;
      if (run.exit_code == kExitDone) continue;
      EXPECT_THAT(run.err, AnyOf(HasSubstr("--" + flag), HasSubstr("flag '" + flag + "'")));
      EXPECT_THAT(run.err, testing::Not(HasSubstr("is ignored by")));
      EXPECT_EQ(NumFilesIn(folder_ + "made"), 0);
    }
  }
};

TEST_F(NumberFlagsTest, ARunOrTheNameOfTheFlagComesOfAnyNumber) {
  std::set<std::string> of_slam;
  for (const Program& program : kPrograms) {
    std::set<std::string> flags = NumberFlagsOf(program.name);
    ASSERT_FALSE(flags.empty());
    if (program.name == "slam") of_slam = flags;
    if (program.name == "benchmark") {
      for (const std::string& flag : of_slam) flags.erase(flag);
    }
    for (const std::string& flag : flags) ExpectRunsOrNames(program, flag);
  }
}

TEST_F(NumberFlagsTest, NumbersBeyondAllReasonAreRefused) {
  for (const char* flag :
       {"--odometry_noise=rotation_floor_rad=1e20", "--sigma_range_m=1e20", "--sigma_range_m=1e308",
        "--manifold_gate=1e-300", "--map_resolution_m=1e308", "--landmark_size_m=1e308",
        "--threads=2147483647", "--calibrate=mounting,mounting"}) {
    const Outcome run = RunWith(kPrograms.front(), flag);
    EXPECT_EQ(run.exit_code, kExitWrongUsage) << flag << ' ' << run.err;
    EXPECT_THAT(run.err, HasSubstr(std::string(flag).substr(0, std::string(flag).find('='))));
    EXPECT_EQ(NumFilesIn(folder_ + "made"), 0);
  }
  EXPECT_EQ(RunWith(kPrograms.front(), "--manifold_gate=inf").exit_code, kExitDone);
}

}  // namespace
}  // namespace plumbline
