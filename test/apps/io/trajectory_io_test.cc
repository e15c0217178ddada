#include "plumbline/apps/io/trajectory_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

TEST(TrajectoryIoTest, WritesOneTumLinePerPose) {
  const std::string path = TempFolder() + "a.tum";
  // Half of 90 deg has sine = cosine = sqrt(1/2); 270 deg is -90 deg.
  ASSERT_TRUE(WriteTumTrajectory(path, {{976052857.3375304, {1.5, -2.25, 0.0}},
                                        {1.0, {0.123456789012, 3000.0, DegToRad(90.0)}},
                                        {2.5, {0.0, 0.0, DegToRad(270.0)}}})
                  .ok());
  EXPECT_EQ(ReadFile(path),
            "976052857.337530 1.500000000 -2.250000000 0 0 0 0.000000000 1.000000000\n"
            "1.000000 0.123456789 3000.000000000 0 0 0 0.707106781 0.707106781\n"
            "2.500000 0.000000000 0.000000000 0 0 0 -0.707106781 0.707106781\n");
}

TEST(TrajectoryIoTest, ReadsBackWhatItWrote) {
  const std::string path = TempFolder() + "a.tum";
  std::vector<TimedPose> written;
  for (int i = -35; i <= 35; ++i) written.push_back({0.1 * i, {1e3 * i, -0.3 * i, 0.0897 * i}});
  ASSERT_TRUE(WriteTumTrajectory(path, written).ok());
  std::vector<TimedPose> read;
  ASSERT_TRUE(ReadTumTrajectory(path, &read).ok());
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].timestamp_s, written[i].timestamp_s, 1e-6);
    EXPECT_NEAR(read[i].world_from_robot.x, written[i].world_from_robot.x, 1e-9);
    EXPECT_NEAR(read[i].world_from_robot.y, written[i].world_from_robot.y, 1e-9);
    EXPECT_NEAR(read[i].world_from_robot.yaw, written[i].world_from_robot.yaw, 2e-9);
  }
}

TEST(TrajectoryIoTest, SkipsCommentsAndDropsWhatLeavesThePlane) {
  const std::string path = TempFolder() + "a.tum";
  // Yaw 90 deg after a roll of 90 deg: q = (0.5, 0.5, 0.5, 0.5), the x axis points along y.
  WriteFile(path, "# timestamp tx ty tz qx qy qz qw\n\n  3 1 2 9 0.5 0.5 0.5 0.5\r\n");
  std::vector<TimedPose> read;
  ASSERT_TRUE(ReadTumTrajectory(path, &read).ok());
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].timestamp_s, 3.0);
  EXPECT_EQ(read[0].world_from_robot.x, 1.0);
  EXPECT_EQ(read[0].world_from_robot.y, 2.0);
  EXPECT_NEAR(read[0].world_from_robot.yaw, DegToRad(90.0), 1e-15);
}

TEST(TrajectoryIoTest, ErrorsNameFileLineAndField) {
  const std::string path = TempFolder() + "a.tum";
  const auto read = [&path](const std::string& content) {
    WriteFile(path, content);
    std::vector<TimedPose> trajectory(1);
    const Status status = ReadTumTrajectory(path, &trajectory);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(trajectory.size(), 1u);  // Untouched.
    return status.message();
  };
  EXPECT_EQ(read("1 2 3 0 0 0 0 1\n2 x 3 0 0 0 0 1\n"),
            path + ":2: field 'x': 'x' is not a number");
  EXPECT_EQ(read("1 2 3 0 0 0 0\n"), path + ":1: field 'qw': is missing, the line ends before it");
  EXPECT_EQ(read("1 2 3 0 0 0 0 1 7\n"),
            path + ":1: field 'end of line': '7' is one field too many");
  EXPECT_EQ(read("1 2 nan 0 0 0 0 1\n"), path + ":1: field 'y': 'nan' is not a finite number");
  EXPECT_THAT(read("1 2 3 0 0 0 0 0.5\n"),
              HasSubstr(":1: field 'qw': the quaternion's norm is 0.5"));
  EXPECT_EQ(read("# nothing\n"), path + ": no pose");
}

TEST(TrajectoryIoTest, MissingFileIsNotFound) {
  std::vector<TimedPose> trajectory;
  EXPECT_EQ(ReadTumTrajectory(TempFolder() + "none", &trajectory).code(), StatusCode::kNotFound);
}

TEST(TrajectoryIoTest, TakesPosesOfAStateAndTimesOfItsGraph) {
  SlamGraph graph;
  graph.AddPose({1.0, 2.0, 3.0}, 10.0);
  graph.AddPose({4.0, 5.0, 6.0}, 11.0);
  MapState state = graph.InitialState();
  state.SetPose(1, {7.0, 5.0, 6.0});
  const std::vector<TimedPose> trajectory = TrajectoryOf(graph, state);
  ASSERT_EQ(trajectory.size(), 2u);
  EXPECT_EQ(trajectory[1].timestamp_s, 11.0);
  EXPECT_EQ(trajectory[1].world_from_robot.x, 7.0);
  EXPECT_EQ(trajectory[1].world_from_robot.yaw, 6.0);
}

}  // namespace
}  // namespace plumbline
