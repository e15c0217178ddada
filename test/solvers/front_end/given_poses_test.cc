#include "plumbline/solvers/front_end/given_poses.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <vector>

namespace plumbline {
namespace {

// A drive in a large circle, one step a metre.
std::vector<Pose2> Circle() {
  std::vector<Pose2> poses{Pose2()};
  for (int i = 0; i < 400; ++i) poses.push_back(poses.back() * Pose2(1.0, 0.0, 0.03));
  return poses;
}

// With independent errors of the poses, as seen in another frame.
std::vector<Pose2> Given(const std::vector<Pose2>& poses, double sigma_m, double sigma_rad) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Pose2> given;
  for (const Pose2& pose : poses) {
    const Pose2 moved = Pose2(5.0, -3.0, 1.0) * pose;
    given.emplace_back(moved.x + sigma_m * normal(random), moved.y + sigma_m * normal(random),
                       moved.yaw + sigma_rad * normal(random));
  }
  return given;
}

TEST(GivenPosesTest, TheirNoiseIsMeasured) {
  const std::vector<Pose2> matched = Circle();
  const std::optional<PoseNoise> noise = MeasurePoseNoise(Given(matched, 0.4, 0.06), matched);
  ASSERT_TRUE(noise.has_value());
  EXPECT_NEAR(noise->position_m, 0.4, 0.03);
  EXPECT_NEAR(noise->yaw_rad, 0.06, 0.006);
}

TEST(GivenPosesTest, AMinorityThatIsMatchedWrongHasNoInfluence) {
  const std::vector<Pose2> truth = Circle();
  std::vector<Pose2> matched = truth;
  for (std::size_t i = 10; i < matched.size(); i += 20) matched[i].x += 10.0;
  const std::optional<PoseNoise> noise = MeasurePoseNoise(Given(truth, 0.4, 0.06), matched);
  ASSERT_TRUE(noise.has_value());
  EXPECT_NEAR(noise->position_m, 0.4, 0.06);
}

TEST(GivenPosesTest, OdometryIsToldApart) {
  const std::vector<Pose2> matched = Circle();
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.3);
  std::vector<Pose2> odometry{Pose2()};
  for (std::size_t i = 1; i < matched.size(); ++i) {
    odometry.push_back(odometry.back() * Pose2(1.0 + normal(random), normal(random), 0.03));
  }
  EXPECT_FALSE(MeasurePoseNoise(odometry, matched).has_value());
  EXPECT_FALSE(MeasurePoseNoise({Pose2(), Pose2()}, {Pose2(), Pose2()}).has_value());
}

TEST(GivenPosesTest, AStepLeadsToTheGivenPoseAsTheOnesBeforeAreMatched) {
  const std::vector<Pose2> matched = Circle();
  const std::vector<Pose2> exact = Given(matched, 0.0, 0.0);
  for (const int to : {1, 5, 100}) {
    const Pose2 step = StepToGivenPose(exact, matched, to);
    EXPECT_NEAR(step.x, 1.0, 1e-9) << to;
    EXPECT_NEAR(step.y, 0.0, 1e-9) << to;
    EXPECT_NEAR(step.yaw, 0.03, 1e-9) << to;
  }
  EXPECT_GT(StepNoise({0.4, 0.06}).translation_floor_m, 0.4);
}

}  // namespace
}  // namespace plumbline
