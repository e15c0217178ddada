// plumbline_convert from end to end, as a user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class ConvertProgramTest : public ProgramTest {
 protected:
  Outcome Convert(const std::string& input, const std::string& output,
                  const std::string& flags = "") const {
    return Run("convert",
               "--input=" + folder_ + input + " --output=" + folder_ + output + " " + flags);
  }
};

TEST_F(ConvertProgramTest, ALogSurvivesTheWayThroughPoseGraphs) {
  SimulateLog(5);
  const Outcome g2o = Convert("a.clf", "a.g2o");
  ASSERT_EQ(g2o.exit_code, 0) << g2o.err;
  EXPECT_THAT(g2o.err, IsEmpty());
  EXPECT_THAT(g2o.out, AllOf(HasSubstr("a.clf: 5 poses, 4 edges, 5 scans, "),
                             HasSubstr("Wrote " + folder_ + "a.g2o (g2o)\n")));
  ASSERT_EQ(Convert("a.g2o", "b.graph").exit_code, 0);
  ASSERT_EQ(Convert("b.graph", "b.g2o").exit_code, 0);
  EXPECT_EQ(ReadFile(folder_ + "a.g2o"), ReadFile(folder_ + "b.g2o"));
  ASSERT_EQ(Convert("a.clf", "a.tum").exit_code, 0);
  ASSERT_EQ(Convert("b.g2o", "b.tum").exit_code, 0);
  EXPECT_EQ(ReadFile(folder_ + "a.tum"), ReadFile(folder_ + "b.tum"));
}

TEST_F(ConvertProgramTest, ARefinedDriveGoesOnAsAGraph) {
  SimulateLog(60);
  ASSERT_EQ(Slam("a.clf", "", "log").exit_code, 0);
  const Outcome convert =
      Convert("a.clf", "a.g2o", "--trajectory=" + folder_ + "log/trajectory_seed.tum");
  ASSERT_EQ(convert.exit_code, 0) << convert.err;
  const Outcome slam = Slam("a.g2o");
  ASSERT_EQ(slam.exit_code, 0) << slam.err;
  EXPECT_THAT(slam.out, HasSubstr("60 poses, 59 edges, 60 scans"));
  // As good as from the log.
  const auto thickness = [&](const std::string& run) {
    const auto stages = nlohmann::json::parse(Result(run, "summary.json"))["stages"];
    return stages.back()["wall_thickness_m"].get<double>();
  };
  EXPECT_NEAR(thickness("out"), thickness("log"), 0.02 * thickness("log"));
}

TEST_F(ConvertProgramTest, SaysWhatItLeavesOut) {
  SimulateLog(5);
  const Outcome run = Convert("a.clf", "floor", "--format=ros_map --map_resolution_m=0.1");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              HasSubstr("Wrote " + folder_ + "floor.pgm " + folder_ + "floor.yaml (ros_map)\n"));
  EXPECT_EQ(run.err, folder_ +
                         "floor: left out 5 poses, 4 edges, 5 scans; ros_map has no place for "
                         "them\n");
  EXPECT_THAT(ReadFile(folder_ + "floor.yaml"), HasSubstr("\nresolution: 0.1\n"));
}

TEST_F(ConvertProgramTest, ErrorsAreOneLineAndAnExitCode) {
  SimulateLog(2);
  WriteFile(folder_ + "gap.tum", "77 0 0 0 0 0 0 1\n");
  ExpectUsageError(Run("convert", ""), "plumbline_convert: --input is missing; see --help");
  ExpectUsageError(Run("convert", "--input=a.clf"), "--output is missing; see --help");
  ExpectUsageError(Convert("a.clf", "a.obj"), "a.obj: the extension tells the format");
  ExpectUsageError(Convert("a.clf", "a.tum", "--format=csv"), "--format=csv: no such format");
  ExpectError(Convert("none.clf", "a.tum"), "cannot open '" + folder_ + "none.clf'");
  ExpectError(Convert("a.clf", "none/a.tum"), "cannot write '" + folder_ + "none/a.tum'",
              kExitCannotWrite);
  ExpectUsageError(Convert("a.clf", "map.pgm," + folder_ + "map.yaml"),
                   "--output means the file '" + folder_ + "map.pgm' twice");
  ExpectError(Convert("a.clf", "a.tum", "--trajectory=" + folder_ + "gap.tum"),
              "gap.tum: no pose at ");
  ExpectUsageError(Convert("a.clf", "a.tum", "more"), "unexpected argument 'more'");
}

TEST_F(ConvertProgramTest, HelpTellsWhatFormatsHold) {
  const Outcome run = Run("convert", "--help");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, IsEmpty());
  for (const char* text : {"--input=", "--output=", "--format=", "--trajectory=",
                           "--map_resolution_m=0.05", "measured ends of the beams"}) {
    EXPECT_THAT(run.out, HasSubstr(text));
  }
}

}  // namespace
}  // namespace plumbline
