// The examples that refine a file, as a user runs them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/room_as_g2o.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class RefineG2oTest : public ProgramTest {
 protected:
  Outcome Refine(const std::string& text) const {
    WriteFile(folder_ + "in.g2o", text);
    return Run("example_refine_g2o", folder_ + "in.g2o " + folder_ + "out.g2o");
  }
  std::string Refined() const { return ReadFile(folder_ + "out.g2o"); }
  void ExpectFailure(const std::string& text, const std::string& message) const {
    const Outcome run = Refine(text);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out.g2o"));
  }
};

// Mean distance [m] of the file's vertices from the truth.
double MeanErrorOf(const std::string& g2o, const std::vector<Pose2>& truth) {
  double sum_m = 0.0;
  std::size_t i = 0;
  for (const std::string& line : Lines(g2o)) {
    std::istringstream fields(line);
    std::string keyword;
    long long id = 0;
    Pose2 pose;
    if (!(fields >> keyword >> id >> pose.x >> pose.y >> pose.yaw) || keyword != "VERTEX_SE2") {
      continue;
    }
    sum_m += (pose.translation() - truth.at(i++).translation()).norm();
  }
  EXPECT_EQ(i, truth.size());
  return sum_m / truth.size();
}

TEST_F(RefineG2oTest, RefinesTheVerticesAndNothingElse) {
  const NoisyRoom room = MakeNoisyRoom();
  const std::string given = "# a comment\nFIX 0\n" + AsG2o(room) + "PARAMS_SE2OFFSET 0 0 0 0\n";
  const Outcome run = Refine(given);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, AllOf(HasSubstr("12 poses, 12 edges, 12 scans"), HasSubstr("energy"),
                             HasSubstr("poses moved by")));
  EXPECT_LT(MeanErrorOf(Refined(), room.truth), 0.1 * MeanErrorOf(given, room.truth));
  EXPECT_LT(MeanErrorOf(Refined(), room.truth), 0.004);
  const std::vector<std::string> before = Lines(given), after = Lines(Refined());
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].rfind("VERTEX_SE2", 0) == 0) continue;
    EXPECT_EQ(after[i], before[i]);
  }
}

TEST_F(RefineG2oTest, WithoutScansTheEdgesDecide) {
  const Outcome run = Refine(
      "EDGE_SE2 7 -3 1 0 0 100 0 0 100 0 100\nVERTEX_SE2 7 0 0 0\nVERTEX_SE2 -3 1.5 0.2 0.1\n");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("no scans"));
  EXPECT_NEAR(MeanErrorOf(Refined(), {{0, 0, 0}, {1, 0, 0}}), 0.0, 1e-9);
}

TEST_F(RefineG2oTest, AnErrorNamesItsLine) {
  const std::string vertices = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n";
  ExpectFailure("", "in.g2o: there is no VERTEX_SE2");
  ExpectFailure("VERTEX_SE2 0 0 oops 0\n", "in.g2o:1: VERTEX_SE2 wants: id x y yaw");
  ExpectFailure("VERTEX_SE2 0 0 nan 0\n", "in.g2o:1: ");
  ExpectFailure(vertices + "VERTEX_SE2 1 1 0 0\n", "in.g2o:3: vertex 1 was there before");
  ExpectFailure(vertices + "EDGE_SE2 0 1 1 0 0 1 0 0 1 0\n", "in.g2o:3: EDGE_SE2 wants: from to");
  ExpectFailure(vertices + "EDGE_SE2 0 9 1 0 0 1 0 0 1 0 1\n", "in.g2o:3: there is no vertex 9");
  ExpectFailure(vertices + "EDGE_SE2 0 0 1 0 0 1 0 0 1 0 1\n", "in.g2o:3: ");
  ExpectFailure(vertices + "EDGE_SE2 0 1 1 0 0 1 0 0 -1 0 1\n",
                "in.g2o:3: relative pose 0 (0 -> 1)");
  ExpectFailure(vertices + "FIX 4\n", "in.g2o:3: there is no vertex 4");
  ExpectFailure(vertices + "FIX 0 x\n", "in.g2o:3: FIX wants");
  ExpectFailure(vertices + "EDGE_SE2_XY 0 1 1 0 1 0 1\n",
                "in.g2o:3: EDGE_SE2_XY is not understood");
  const std::string laser = "ROBOTLASER1 0 -1.5 3.1 0.1 30 0.01 0 ";
  ExpectFailure(laser + "2 1 2 0 0 0 0 0 0 0\n", "in.g2o:1: no vertex before the scan");
  ExpectFailure(vertices + laser + "3 1 2 x 0 0 0 0 0 0 0\n", "in.g2o:3: ROBOTLASER1 wants");
  ExpectFailure(vertices + laser + "-1\n", "in.g2o:3: ROBOTLASER1 wants");
  const Outcome missing = Run("example_refine_g2o", folder_ + "none.g2o " + folder_ + "out.g2o");
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, HasSubstr("none.g2o"));
  EXPECT_EQ(Run("example_refine_g2o", "").exit_code, 1);
}

TEST_F(RefineG2oTest, AnOutputThatCannotBeWrittenIsAnError) {
  WriteFile(folder_ + "in.g2o", "VERTEX_SE2 0 0 0 0\n");
  const Outcome run =
      Run("example_refine_g2o", folder_ + "in.g2o " + folder_ + "no_such_folder/out.g2o");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("cannot write"));
}

// Readings of every kind, and parts that no edge joins.
TEST_F(RefineG2oTest, BearsNoReturnsAndIslands) {
  const std::string laser = "ROBOTLASER1 0 -1.5 3.1 0.1 30 0.01 0 5 nan inf 0 30 2 0 ";
  const std::string rest = "0 0 0 0 0 0 0 0 0 0 0 1.0 host 0\n";
  const Outcome run = Refine("VERTEX_SE2 0 0 0 0\n" + laser + rest + "VERTEX_SE2 1 1 0 0\n" +
                             laser + rest + "VERTEX_SE2 2 5 5 0\nVERTEX_SE2 3 7 5 0\n" +
                             "EDGE_SE2 0 1 1.1 0 0 100 0 0 100 0 100\n" +
                             "EDGE_SE2 2 3 2.1 0 0 100 0 0 100 0 100\n");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("2 returns"));
  EXPECT_THAT(Refined(), Not(HasSubstr("nan 0 0")));
}

}  // namespace
}  // namespace plumbline
