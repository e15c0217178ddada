// Logs without odometry in the programs, from end to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "plumbline/apps/io/text_reader.h"
#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A FLASER record with all poses at zero; nothing of an ODOM record.
std::string WithoutPoses(const std::string& line) {
  std::istringstream fields(line);
  std::vector<std::string> words;
  for (std::string word; fields >> word;) words.push_back(word);
  if (words.empty() || words[0] == "ODOM") return "";
  if (words[0] == "FLASER") {
    const std::size_t first = 2 + std::stoul(words[1]);
    for (std::size_t i = first; i < first + 6; ++i) words[i] = "0";
  }
  std::string text;
  for (const std::string& word : words) text += word + ' ';
  return text + '\n';
}

class ScanOnlyTest : public ProgramTest {
 protected:
  void WriteWithoutPoses(const std::string& path) const {
    TextReader reader;
    ASSERT_TRUE(reader.Open(path).ok());
    std::string text;
    for (std::string_view line; reader.NextLine(&line);) text += WithoutPoses(std::string(line));
    ASSERT_TRUE(reader.status().ok());
    WriteFile(folder_ + "scans.clf", text);
  }
};

TEST_F(ScanOnlyTest, ALogWhoseOdometryNeverChangesIsMappedByItsScans) {
  SimulateLog(300);
  WriteWithoutPoses(folder_ + "a.clf");
  const Outcome run = Slam("scans.clf", "--picture_side_px=200 --truth=" + folder_ + "a.tum");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
  EXPECT_THAT(run.err, HasSubstr("warning: " + folder_ + "scans.clf: there is no odometry"));
  EXPECT_THAT(run.out, HasSubstr("The refined map is consistent"));
  EXPECT_LT(Summary()["stages"].back()["mean_pose_error_m"], 0.03);
}

TEST_F(ScanOnlyTest, AStandingRobotStands) {
  std::string ranges = "180";
  for (int i = 0; i < 180; ++i) ranges += ' ' + std::to_string(2.0 + 0.01 * (i % 60));
  WriteStandingLog(20, ranges);
  const Outcome run = Slam("a.clf", "--picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const std::string& line : Lines(Result("out", "trajectory.tum"))) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    double time_s = 0.0, x = 1.0, y = 1.0;
    fields >> time_s >> x >> y;
    EXPECT_NEAR(x, 0.0, 1e-3);
    EXPECT_NEAR(y, 0.0, 1e-3);
  }
}

TEST_F(ScanOnlyTest, Fr079) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "set PLUMBLINE_DATASETS to the folder of the logs";
  WriteWithoutPoses(DatasetsFolder() + "/fr079.clf.gz");
  const Outcome run = Slam("scans.clf", "--picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("there is no odometry"));
  const Outcome evaluated = Run(
      "evaluate", "--trajectory=" + folder_ + "out/trajectory.tum --relations=" + DatasetsFolder() +
                      "/fr079.relations --json=" + folder_ + "figures.json");
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.err;
  std::istringstream lines(evaluated.out);
  double mean_m = 1.0;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find("relations, all            m");
    if (at != line.npos) mean_m = std::stod(line.substr(at + 27));
  }
  EXPECT_LT(mean_m, 0.035) << evaluated.out;
}

}  // namespace
}  // namespace plumbline
