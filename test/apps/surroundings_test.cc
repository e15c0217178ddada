// What is around a program and its files does not change what it does: the language of the system,
// line ends, names.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/pose2.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/mcap_writer.h"
#include "plumbline/test/apps/bags/sqlite_writer.h"
#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/room_as_g2o.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

// Paths of files begin with IN and OUT.
struct Use {
  const char* program;
  std::vector<std::string> flags;
};
const std::vector<Use> kUses = {
    {"simulate",
     {"--world=INa.world", "--num_beams=40", "--log=OUTs.clf", "--truth=OUTs.tum",
      "--hits=OUTs.hits"}},
    {"slam",
     {"--log=INa.clf", "--truth=INa.tum", "--hits=INa.hits", "--output_dir=OUTlog",
      "--picture_side_px=100"}},
    {"slam", {"--log=INa.g2o", "--output_dir=OUTg2o", "--picture_side_px=100"}},
    {"slam", {"--log=INa.toro", "--output_dir=OUTtoro", "--picture_side_px=100"}},
    {"evaluate",
     {"--trajectory=INa.tum", "--relations=INa.relations", "--truth=INa.tum", "--log=INa.clf",
      "--points=OUTlog/points.ply", "--csv=OUTe.csv", "--json=OUTe.json"}},
    {"convert",
     {"--input=INa.clf", "--trajectory=INa.tum",
      "--output=OUTc.g2o,OUTc.toro,"
      "OUTc.tum,OUTc.ply,OUTc.pcd,OUTc.yaml"}},
    {"convert", {"--input=INa.db3", "--output=OUTd.g2o"}},
    {"convert", {"--input=INa.mcap", "--output=OUTm.g2o"}}};

class SurroundingsTest : public ProgramTest {
 protected:
  void SetUp() override {
    SimulateLog(20);
    std::filesystem::create_directories(in_);
    for (const char* name : {"a.clf", "a.tum", "a.hits"}) {
      std::filesystem::rename(folder_ + name, in_ + name);
    }
    std::filesystem::copy_file(PLUMBLINE_WORLD, in_ + "a.world");
    WriteFile(in_ + "a.g2o", AsG2o(MakeNoisyRoom()));
    const Outcome toro = Run("convert", "--input=" + in_ + "a.g2o --output=" + in_ + "a.toro");
    ASSERT_EQ(toro.exit_code, 0) << toro.err;
    WriteFile(in_ + "a.relations", "0.0 1.5 0.75 0.01 0 0 0 0.02\n1.5 3.0 0.75 0.01 0 0 0 0.02\n");
    WriteSqliteBag(in_ + "a.db3", SmallBag());
    WriteFile(in_ + "a.mcap", McapBytes(SmallBag()));
    usual_ = ResultsWith(in_, folder_ + "out/");
    EXPECT_GT(usual_.size(), 50u);
  }

  // Runs all programs and gives their files, by their paths behind `out`.
  std::map<std::string, std::string> ResultsWith(const std::string& in, const std::string& out) {
    const std::filesystem::path folder = std::filesystem::path(out).parent_path();
    std::filesystem::create_directories(folder);
    for (const Use& use : kUses) {
      std::string arguments;
      for (const std::string& flag : use.flags) {
        arguments += " " + InQuotationMarks(Replaced(Replaced(flag, "IN", in), "OUT", out));
      }
      const Outcome run = Run(use.program, arguments);
      EXPECT_EQ(run.exit_code, 0) << arguments << '\n' << run.err;
      printed_ += run.out + run.err;
    }
    std::map<std::string, std::string> results;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      EXPECT_EQ(entry.path().string().find(out), 0u);
      results[entry.path().string().substr(out.size())] = ReadFile(entry.path().string());
    }
    return results;
  }
  static std::string Replaced(const std::string& text, const std::string& word,
                              const std::string& by) {
    std::string result;
    std::size_t begin = 0;
    for (std::size_t at = 0; (at = text.find(word, begin)) != text.npos; begin = at + word.size()) {
      result += text.substr(begin, at - begin) + by;
    }
    return result + text.substr(begin);
  }

  // Of the shell.
  static std::string InQuotationMarks(const std::string& argument) {
    return "'" + Replaced(argument, "'", "'\\''") + "'";
  }

  void ExpectUsual(const std::map<std::string, std::string>& results) const {
    EXPECT_EQ(results.size(), usual_.size());
    for (const auto& [name, bytes] : usual_) {
      const std::string stem = std::filesystem::path(name).filename().string();
      if (stem == "summary.json" || stem == "report.html") continue;  // they hold times
      ASSERT_EQ(results.count(name), 1u) << name;
      EXPECT_TRUE(results.at(name) == bytes) << name;
    }
  }

  const std::string in_ = folder_ + "in/";
  std::map<std::string, std::string> usual_;
  std::string printed_;
};

TEST_F(SurroundingsTest, ADecimalCommaChangesNothing) {
  const std::string make = "localedef -i de_DE -f UTF-8 " + folder_ + "de_DE.UTF-8 2>&1";
  const std::string in_german = "LOCPATH=" + folder_ + " LC_ALL=de_DE.UTF-8 ";
  const std::string comma = folder_ + "comma";
  if (std::system((make + " && " + in_german + "locale decimal_point >" + comma).c_str()) != 0) {
    GTEST_SKIP() << "the locale de_DE.UTF-8 cannot be made: Debian's package locales is missing";
  }
  ASSERT_EQ(ReadFile(comma), ",\n");
  limits_ = in_german;
  ExpectUsual(ResultsWith(in_, folder_ + "german/"));
}

TEST_F(SurroundingsTest, LineEndsOfWindowsChangeNothing) {
  const std::string in = folder_ + "windows/";
  std::filesystem::copy(in_, in);
  for (const char* name :
       {"a.clf", "a.tum", "a.hits", "a.world", "a.g2o", "a.toro", "a.relations"}) {
    WriteFile(in + name, Replaced(ReadFile(in_ + name), "\n", "\r\n"));
  }
  ExpectUsual(ResultsWith(in, folder_ + "from_windows/"));
}

TEST_F(SurroundingsTest, FilesMayHaveAnyNames) {
  const std::string odd = " '\"%41?#\n<b>&amp;", folder = folder_ + "\xff" + odd + "/";
  std::filesystem::create_directory(folder);
  for (const auto& entry : std::filesystem::directory_iterator(in_)) {
    std::filesystem::copy_file(entry.path(), folder + odd + entry.path().filename().string());
  }
  printed_.clear();
  auto results = ResultsWith(folder + odd, folder_ + "out of " + odd + "/" + odd);
  // The one file that has a name in it.
  const YAML::Node map = YAML::Load(results.at("c.yaml"));
  EXPECT_EQ(map["image"].as<std::string>(), odd + "c.pgm");
  results["c.yaml"] = usual_["c.yaml"];
  ExpectUsual(results);
  EXPECT_THAT(printed_, HasSubstr(Legible(folder + odd) + "a.clf"));
  EXPECT_THAT(printed_, Not(HasSubstr("\xff")));
  for (const char* run : {"log/", "g2o/", "toro/"}) {
    EXPECT_TRUE(nlohmann::json::accept(results[run + std::string("summary.json")])) << run;
    EXPECT_THAT(results[run + std::string("report.html")], Not(HasSubstr("<b>&amp;"))) << run;
  }
}

// The C library rounds sines and exponentials otherwise where it cannot multiply and add at once.
TEST_F(SurroundingsTest, AnOlderProcessorChangesNoPoseByAMillimetre) {
  SimulateLog(150);
  limits_ = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable ";
  ASSERT_EQ(Slam("a.clf", "", "older").exit_code, 0);
  limits_.clear();
  ASSERT_EQ(Slam("a.clf", "", "usual").exit_code, 0);
  for (const char* name : {"trajectory_seed.tum", "trajectory.tum"}) {
    std::vector<TimedPose> older, usual;
    ASSERT_TRUE(ReadTumTrajectory(folder_ + "older/" + name, &older).ok());
    ASSERT_TRUE(ReadTumTrajectory(folder_ + "usual/" + name, &usual).ok());
    ASSERT_EQ(older.size(), usual.size());
    ASSERT_EQ(usual.size(), 150u);
    for (std::size_t i = 0; i < usual.size(); ++i) {
      const Pose2 moved = Between(usual[i].world_from_robot, older[i].world_from_robot);
      EXPECT_LT(std::hypot(moved.x, moved.y), 1e-3) << name << ' ' << i;
      EXPECT_LT(std::abs(moved.yaw), 1e-3) << name << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace plumbline
