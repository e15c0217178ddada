// plumbline_convert from end to end, as a user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/ply_reader.h"
#include "plumbline/core/point_index.h"
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
  ExpectError(Convert("b.graph", "c.g2o", "--sweep_time_s=0.1"), "--sweep_time_s goes with a log");
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

TEST_F(ConvertProgramTest, ReturnsOfASweepAreWhereTheRobotWasAtTheirTimes) {
  SimulateLog(60, "--sweep_time_s=0.15");
  std::vector<double> hits;
  for (const std::string& line : Lines(ReadFile(folder_ + "a.hits"))) {
    double time_s = 0.0, beam = 0.0, x = 0.0, y = 0.0;
    std::istringstream(line) >> time_s >> beam >> x >> y;
    hits.insert(hits.end(), {x, y});
  }
  const PointIndex true_points(std::move(hits));
  std::vector<PointIndex::Neighbor> nearest;
  double mean_error_m[2] = {};
  for (const bool as_swept : {false, true}) {
    const Outcome run =
        Convert("a.clf", "a.ply," + folder_ + "b.g2o",
                "--trajectory=" + folder_ + "a.tum --sweep_time_s=" + (as_swept ? "0" : "0.15"));
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.out.find("Sweeps: measured first beam first") == run.out.npos, as_swept);
    EXPECT_EQ(run.err.find("b.g2o: left out 60 sweep times; g2o") == run.err.npos, as_swept);
    std::vector<double> points;
    ASSERT_TRUE(ReadPointsPly(folder_ + "a.ply", &points).ok());
    ASSERT_GT(points.size(), 10000u);
    for (std::size_t i = 0; i < points.size(); i += 2) {
      true_points.FindNearest({points[i], points[i + 1]}, 1, &nearest);
      mean_error_m[as_swept] += std::sqrt(nearest[0].squared_distance);
    }
    mean_error_m[as_swept] /= 0.5 * static_cast<double>(points.size());
  }
  EXPECT_LT(mean_error_m[false], 0.02);  // range noise
  EXPECT_GT(mean_error_m[true], 1.3 * mean_error_m[false]);
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
