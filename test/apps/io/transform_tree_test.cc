#include "plumbline/apps/io/transform_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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
  std::optional<Eigen::Isometry3d> transform;
  const Status status = tree.Find(target, source, stamp_s, &transform);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(transform.has_value());
  return transform.value_or(Eigen::Isometry3d::Identity());
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
  EXPECT_EQ(tree.Samples("base")[0].stamp_s, 10.0);
}

TEST(TransformTreeTest, TheWayUpEndsAtTheRoot) {
  std::vector<std::string> path;
  ASSERT_TRUE(Robot().PathUp("laser", &path).ok());
  EXPECT_THAT(path, ElementsAre("laser", "mast", "base", "odom"));
  ASSERT_TRUE(Robot().PathUp("stranger", &path).ok());
  EXPECT_THAT(path, ElementsAre("stranger"));
}

TEST(TransformTreeTest, FramesWithoutConnectionHaveNoTransform) {
  std::optional<Eigen::Isometry3d> transform = Eigen::Isometry3d::Identity();
  ASSERT_TRUE(Robot().Find("base", "stranger", 0.0, &transform).ok());
  EXPECT_FALSE(transform);
  EXPECT_EQ(Robot().FrameNames(), "base, laser, mast, odom, wheel");
  EXPECT_EQ(TransformTree().FrameNames(), "none");
}

TEST(TransformTreeTest, TwoParentsAreAnErrorOnTheWayOnly) {
  TransformTree tree = Robot();
  tree.Add("elsewhere", "wheel", {0.0, Transform(0.0, 0.0, 0.0, 0.0)});
  std::optional<Eigen::Isometry3d> transform;
  EXPECT_TRUE(tree.Find("base", "laser", 0.0, &transform).ok());
  const Status status = tree.Find("base", "wheel", 0.0, &transform);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("'wheel' has two parents, 'base' and 'elsewhere'"));
}

TEST(TransformTreeTest, ACycleIsAnError) {
  TransformTree tree = Robot();
  tree.Add("laser", "odom", {0.0, Transform(0.0, 0.0, 0.0, 0.0)});
  std::vector<std::string> path;
  EXPECT_THAT(tree.PathUp("base", &path).message(), HasSubstr("'base' is above itself"));
}

TEST(TransformTreeTest, ThePlaneKeepsThePlaceAndTheDirectionOfTheXAxis) {
  const Pose2 pose = InPlane(Transform(1.0, 2.0, 3.0, 30.0, 180.0));
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, 2.0, 1e-12);
  EXPECT_NEAR(pose.yaw, DegToRad(30.0), 1e-12);
}

}  // namespace
}  // namespace plumbline
