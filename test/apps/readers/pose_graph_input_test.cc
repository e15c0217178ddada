#include "plumbline/apps/readers/pose_graph_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/test/apps/saved_maps/pbstream_testing.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class PoseGraphInputTest : public testing::Test {
 protected:
  std::string Holding(const std::string& name, const std::string& content) const {
    WriteFile(folder_ + name, content);
    return folder_ + name;
  }

  const std::string folder_ = TempFolder();
  PoseGraphInput input_;
};

TEST_F(PoseGraphInputTest, FormatsAreToldByTheirContent) {
  EXPECT_TRUE(IsPoseGraph(Holding("a", "VERTEX_SE2 0 0 0 0\n")));
  EXPECT_TRUE(IsPoseGraph(Holding("a", PbFile(PbMessages(SmallPbState())))));
  EXPECT_FALSE(IsPoseGraph(Holding("a", "FLASER 1 2.5 0 0 0 0 0 0 1 host 1\n")));
  EXPECT_FALSE(IsPoseGraph(folder_ + "none"));
}

TEST_F(PoseGraphInputTest, AFileOfTextIsWrittenBackInItsFormat) {
  const std::string start = "# comment\nVERTEX2 4 ", end = " 0 0\nEDGE2 4 9 1 0 0 4 0 4 4 0 0\n";
  const std::string path = Holding("a", start + "0 0 0\nVERTEX2 9 1" + end);
  ASSERT_TRUE(ReadPoseGraph(path, 0.0, &input_).ok());
  EXPECT_EQ(input_.format, "toro");
  EXPECT_EQ(input_.num_robot_poses, 2);
  EXPECT_THAT(input_.note, IsEmpty());
  std::vector<double> poses = input_.graph.initial_poses();
  poses[3] = 2.0;
  ASSERT_TRUE(input_.write(folder_ + "b", poses).ok());
  EXPECT_EQ(ReadFile(folder_ + "b"), start + "0 0 0\nVERTEX2 9 2" + end);
}

TEST_F(PoseGraphInputTest, AStateOfCartographerHasPosesOfSubmapsBehindThoseOfTheRobot) {
  PbState state = SmallPbState();
  state.pose_graph_extras = PbBytes(5, "");
  const std::string path = Holding("a", PbFile(PbMessages(state)));
  ASSERT_TRUE(ReadPoseGraph(path, 0.0, &input_).ok());
  EXPECT_EQ(input_.format, "pbstream");
  EXPECT_EQ(input_.graph.num_poses(), 5);
  EXPECT_EQ(input_.num_robot_poses, 3);
  EXPECT_EQ(input_.note,
            "  3 nodes, 2 submaps; matches are off by 14.4 mm and 0.4 deg (sigma); 0 of 4 are off "
            "by more than three sigmas, and count for less\n");
  ASSERT_EQ(input_.warnings.size(), 1u);
  EXPECT_EQ(input_.warnings[0].id, "landmarks_unused");
  EXPECT_EQ(input_.warnings[0].message, folder_ + "a: landmarks are neither used nor moved");
  std::vector<double> poses = input_.graph.initial_poses();
  poses[3] += 0.5;
  ASSERT_TRUE(input_.write(folder_ + "b", poses).ok());
  PoseGraphInput again;
  ASSERT_TRUE(ReadPoseGraph(folder_ + "b", 0.0, &again).ok());
  EXPECT_NEAR(again.graph.InitialPose(1).x, poses[3], 1e-15);
}

TEST_F(PoseGraphInputTest, WhatCannotBeReadLeavesTheInputAlone) {
  input_.format = "before";
  EXPECT_THAT(ReadPoseGraph(Holding("a", "VERTEX2 0 x\n"), 0.0, &input_).message(),
              HasSubstr("a:1: VERTEX2 field 'x'"));
  EXPECT_THAT(ReadPoseGraph(Holding("a", kPbMagic), 0.0, &input_).message(),
              HasSubstr("a: cannot be read as a state of Cartographer"));
  const std::string state = PbFile(PbMessages(SmallPbState()));
  EXPECT_THAT(ReadPoseGraph(Holding("a", state), 100.0, &input_).message(),
              HasSubstr("takes more memory than"));
  EXPECT_EQ(input_.format, "before");
}

}  // namespace
}  // namespace plumbline
