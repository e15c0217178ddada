#include "plumbline/apps/io/transform_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Eigen::Isometry3d Transform(double x, double y, double z, double yaw_deg, double roll_deg = 0.0) {
  return Eigen::Translation3d(x, y, z) *
         Eigen::AngleAxisd(DegToRad(yaw_deg), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(DegToRad(roll_deg), Eigen::Vector3d::UnitX());
}

// odom -> base moves and turns within 10 s; base -> mast -> laser rest, and so does base -> wheel.
TransformTree Robot() {
  TransformTree tree;
  tree.Add("odom", "base", {20.0, Transform(2.0, 0.0, 0.0, 90.0)});
  tree.Add("odom", "base", {10.0, Transform(0.0, 0.0, 0.0, 0.0)});  // comes late
  tree.Add("base", "mast", {0.0, Transform(0.1, 0.0, 0.5, 0.0)});
  tree.Add("mast", "laser", {0.0, Transform(0.0, 0.2, 0.0, 90.0, 180.0)});
  tree.Add("base", "wheel", {0.0, Transform(0.0, -0.3, 0.0, 0.0)});
  return tree;
}

Eigen::Isometry3d Found(const TransformTree& tree, const std::string& target,
                        const std::string& source, double stamp_s) {
  std::optional<TransformPath> path;
  const Status status = tree.FindPath(target, source, &path);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(path.has_value());
  return path ? tree.At(*path, stamp_s) : Eigen::Isometry3d::Identity();
}

TEST(TransformTreeTest, ChainsTransformsUpAndDown) {
  const TransformTree tree = Robot();
  EXPECT_TRUE(
      Found(tree, "base", "laser", 5.0).isApprox(Transform(0.1, 0.2, 0.5, 90.0, 180.0), 1e-12));
  EXPECT_TRUE(
      Found(tree, "wheel", "laser", 5.0).isApprox(Transform(0.1, 0.5, 0.5, 90.0, 180.0), 1e-12));
  EXPECT_TRUE(Found(tree, "laser", "base", 5.0)
                  .isApprox(Transform(0.1, 0.2, 0.5, 90.0, 180.0).inverse(), 1e-12));
  EXPECT_TRUE(Found(tree, "base", "base", 5.0).isApprox(Eigen::Isometry3d::Identity()));
}

TEST(TransformTreeTest, InterpolatesAndRestsBeyondTheEnds) {
  const TransformTree tree = Robot();
  EXPECT_TRUE(Found(tree, "odom", "base", 15.0).isApprox(Transform(1.0, 0.0, 0.0, 45.0), 1e-12));
  EXPECT_TRUE(Found(tree, "odom", "base", 1.0).isApprox(Eigen::Isometry3d::Identity(), 1e-12));
  EXPECT_TRUE(Found(tree, "odom", "base", 99.0).isApprox(Transform(2.0, 0.0, 0.0, 90.0), 1e-12));
  EXPECT_EQ(tree.Samples("odom", "base")[0].stamp_s, 10.0);
}

TEST(TransformTreeTest, TheWayUpEndsAtTheRoot) {
  EXPECT_THAT(Robot().PathToRoot("laser"), ElementsAre("laser", "mast", "base", "odom"));
  EXPECT_THAT(Robot().PathToRoot("stranger"), ElementsAre("stranger"));
}

TEST(TransformTreeTest, TheWayUpEndsAtTheWantedFrame) {
  std::vector<std::string> path;
  ASSERT_TRUE(Robot().PathUp("laser", "base", &path).ok());
  EXPECT_THAT(path, ElementsAre("laser", "mast", "base"));
  ASSERT_TRUE(Robot().PathUp("laser", "wheel", &path).ok());
  EXPECT_THAT(path, IsEmpty());
  ASSERT_TRUE(Robot().PathUp("stranger", "stranger", &path).ok());
  EXPECT_THAT(path, ElementsAre("stranger"));
}

TEST(TransformTreeTest, FramesWithoutConnectionHaveNoTransform) {
  std::optional<TransformPath> path = TransformPath();
  ASSERT_TRUE(Robot().FindPath("base", "stranger", &path).ok());
  EXPECT_FALSE(path);
  EXPECT_EQ(Robot().FrameNames(), "base, laser, mast, odom, wheel");
  EXPECT_EQ(TransformTree().FrameNames(), "none");
}

TEST(TransformTreeTest, ASecondParentThatDoesNotLeadToTheWantedFrameIsIgnored) {
  TransformTree tree = Robot();
  tree.Add("map", "base", {0.0, Transform(9.0, 9.0, 0.0, 0.0)});
  tree.Add("map", "odom", {0.0, Transform(9.0, 9.0, 0.0, 0.0)});
  tree.Add("elsewhere", "laser", {0.0, Transform(9.0, 9.0, 0.0, 0.0)});
  EXPECT_TRUE(
      Found(tree, "base", "laser", 5.0).isApprox(Transform(0.1, 0.2, 0.5, 90.0, 180.0), 1e-12));
  std::vector<std::string> path;
  ASSERT_TRUE(tree.PathUp("laser", "odom", &path).ok());
  EXPECT_THAT(path, ElementsAre("laser", "mast", "base", "odom"));
  EXPECT_THAT(tree.PathToRoot("mast"), ElementsAre("mast", "base"));
  EXPECT_THAT(tree.IgnoredText(), HasSubstr("'laser' has several parents, 'mast', 'elsewhere'"));
}

TEST(TransformTreeTest, TwoWaysToTheWantedFrameAreAnError) {
  TransformTree tree = Robot();
  tree.Add("base", "laser", {0.0, Transform(9.0, 9.0, 0.0, 0.0)});
  std::optional<TransformPath> path;
  const Status status = tree.FindPath("base", "laser", &path);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("'laser' has two parents, 'mast' and 'base'"));
}

TEST(TransformTreeTest, ACycleEndsTheWayUp) {
  TransformTree tree = Robot();
  tree.Add("laser", "odom", {0.0, Transform(0.0, 0.0, 0.0, 0.0)});
  EXPECT_THAT(tree.PathToRoot("base"), ElementsAre("base", "odom", "laser", "mast"));
  std::vector<std::string> path;
  ASSERT_TRUE(tree.PathUp("base", "stranger", &path).ok());
  EXPECT_THAT(path, IsEmpty());
  ASSERT_TRUE(tree.PathUp("laser", "base", &path).ok());
  EXPECT_THAT(path, ElementsAre("laser", "mast", "base"));
}

TEST(TransformTreeTest, TransformsThatTf2IgnoresAreIgnoredAndCounted) {
  TransformTree tree = Robot();
  tree.Add("base", "base", {0.0, Transform(1.0, 0.0, 0.0, 0.0)});
  tree.Add("", "base", {0.0, Transform(1.0, 0.0, 0.0, 0.0)});
  tree.Add("base", "", {0.0, Transform(1.0, 0.0, 0.0, 0.0)});
  tree.AddBad("", "base", "no rotation", "/tf message 3: no rotation");
  EXPECT_EQ(tree.IgnoredText(), "1 from 'base' to itself; 3 without the name of a frame");
  EXPECT_EQ(Robot().IgnoredText(), "");
  EXPECT_EQ(tree.FrameNames(), "base, laser, mast, odom, wheel");
  EXPECT_THAT(tree.PathToRoot("laser"), ElementsAre("laser", "mast", "base", "odom"));
}

TEST(TransformTreeTest, BadSamplesMatterOnTheWayOnly) {
  TransformTree tree = Robot();
  tree.AddBad("base", "wheel", "no rotation", "/tf message 3: no rotation");
  std::optional<TransformPath> path;
  ASSERT_TRUE(tree.FindPath("base", "laser", &path).ok());
  EXPECT_THAT(tree.BadSamplesText(*path), IsEmpty());
  ASSERT_TRUE(tree.FindPath("base", "wheel", &path).ok());
  EXPECT_THAT(tree.BadSamplesText(*path),
              ElementsAre("1 of 2 transforms from 'base' to 'wheel' cannot be used: no rotation "
                          "(1); the first one: /tf message 3: no rotation"));
  for (int i = 0; i < 10; ++i) tree.AddBad("base", "wheel", "no rotation", "more");
  EXPECT_THAT(tree.FindPath("base", "wheel", &path).message(), HasSubstr("11 of 12 transforms"));
  tree.AddBad("base", "camera", "no rotation", "/tf message 4: no rotation");
  EXPECT_THAT(tree.FindPath("base", "camera", &path).message(), HasSubstr("/tf message 4"));
}

TEST(TransformTreeTest, TheTimesOfRecordingCanTakeThePlaceOfTheStamps) {
  TransformTree tree;
  tree.Add("odom", "base", {0.0, Transform(0.0, 0.0, 0.0, 0.0), 10.0});
  tree.Add("odom", "base", {0.0, Transform(2.0, 0.0, 0.0, 90.0), 20.0});
  EXPECT_TRUE(Found(tree.ByRecordClock(), "odom", "base", 15.0)
                  .isApprox(Transform(1.0, 0.0, 0.0, 45.0), 1e-12));
}

TEST(TransformTreeTest, ThePlaneKeepsThePlaceAndTheDirectionOfTheXAxis) {
  const Pose2 pose = InPlane(Transform(1.0, 2.0, 3.0, 30.0, 180.0));
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, 2.0, 1e-12);
  EXPECT_NEAR(pose.yaw, DegToRad(30.0), 1e-12);
}

}  // namespace
}  // namespace plumbline
