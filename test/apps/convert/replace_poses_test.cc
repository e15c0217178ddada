#include "plumbline/apps/convert/replace_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ReplacePosesTest : public testing::Test {
 protected:
  // Poses at these times in the origin, with a beam each that ends 2 m ahead.
  void MakeGraph(const std::vector<double>& times_s) {
    LaserModel laser;
    laser.num_beams = 1;
    const int laser_id = graph_.AddLaser(laser);
    for (const double time_s : times_s) {
      const int pose = graph_.AddPose(Pose2(), time_s);
      graph_.AddScan(pose, laser_id, {2.0});
    }
    state_ = graph_.InitialState();
  }
  // Poses at these times, one after the other on the x axis, from 1 m on.
  Status Replace(const std::vector<std::string>& times) {
    std::string text;
    int x = 0;
    for (const std::string& time : times) {
      text += time + ' ' + std::to_string(++x) + " 0 0 0 0 0 1\n";
    }
    WriteFile(path_, text);
    return ReplacePoses(path_, graph_, &state_);
  }
  std::vector<double> Places() const {
    std::vector<double> places;
    for (const Pose2& pose : PosesOf(state_.poses)) places.push_back(pose.x);
    return places;
  }

  const std::string path_ = TempFolder() + "a.tum";
  SlamGraph graph_;
  MapState state_;
};

TEST_F(ReplacePosesTest, TakesThePoseOfTheSameTime) {
  MakeGraph({1e9 + 2.5, 1e9 + 0.5, 1e9 + 1.5});
  ASSERT_TRUE(
      Replace({"1000000000.0", "1000000000.5004", "1000000001.5", "1000000002.4995", "1000000009"})
          .ok());
  EXPECT_THAT(Places(), ElementsAre(4.0, 2.0, 3.0));
  EXPECT_THAT(state_.points, ElementsAre(6.0, 0.0, 4.0, 0.0, 5.0, 0.0));
}

TEST_F(ReplacePosesTest, ScansOfOneTimeKeepTheirOwnPoses) {
  MakeGraph({1.0, 1.0, 1.0004, 0.5});
  ASSERT_TRUE(Replace({"1.0", "1.0", "1.0004", "0.5"}).ok());
  EXPECT_THAT(Places(), ElementsAre(1.0, 2.0, 3.0, 4.0));
}

TEST_F(ReplacePosesTest, AUselessClockNeedsAPoseForEach) {
  MakeGraph({1.0, 1.0, 1.0});
  ASSERT_TRUE(Replace({"1", "1", "1"}).ok());
  EXPECT_THAT(Places(), ElementsAre(1.0, 2.0, 3.0));
  const Status status = Replace({"1", "1"});
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr(path_ + ": its clock is useless"));
  EXPECT_THAT(Places(), ElementsAre(1.0, 2.0, 3.0));
}

TEST_F(ReplacePosesTest, NamesTheFirstPoseWithoutOne) {
  MakeGraph({1.0, 2.25, 3.0, 4.0});
  const Status status = Replace({"1", "2", "3.002", "4"});
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(), path_ +
                                  ": no pose at 2.25 s, the time of pose 1; the nearest is at 2 "
                                  "s. 2 of 4 poses have none within 0.001 s");
  EXPECT_THAT(Places(), ElementsAre(0.0, 0.0, 0.0, 0.0));
}

TEST_F(ReplacePosesTest, ATrajectoryThatCannotBeRead) {
  MakeGraph({1.0});
  EXPECT_EQ(ReplacePoses(path_, graph_, &state_).code(), StatusCode::kNotFound);
  EXPECT_THAT(Replace({"soon"}).message(), HasSubstr("a.tum:1: field 't'"));
  EXPECT_THAT(Replace({}).message(), HasSubstr("no pose"));
}

}  // namespace
}  // namespace plumbline
