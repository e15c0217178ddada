#include "plumbline/core/copy_factor.h"

#include <ceres/sized_cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace plumbline {
namespace {

// The distance of a point from a pose.
class Reach final : public ceres::SizedCostFunction<1, 3, 2> {
 public:
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Vector2d off(blocks[1][0] - blocks[0][0], blocks[1][1] - blocks[0][1]);
    residuals[0] = off.norm();
    if (jacobians == nullptr) return true;
    const Eigen::Vector2d direction = off.normalized();
    Eigen::Map<Eigen::RowVector3d>(jacobians[0]) << -direction.x(), -direction.y(), 0.0;
    std::copy_n(direction.data(), 2, jacobians[1]);
    return true;
  }
};

class CopyFactorTest : public testing::Test {
 protected:
  CopyFactorTest() {
    LaserModel laser;
    laser.num_beams = 3;
    laser.first_bearing_rad = -0.5;
    laser.bearing_step_rad = 0.5;
    laser.max_range_m = 10.0;
    const int id = from_.AddLaser(laser);
    for (int pose = 0; pose < 3; ++pose) {
      from_.AddPose(Pose2(pose, 0.0, 0.0), pose);
      from_.AddScan(pose, id, {1.0, 2.0, 3.0 + pose});
    }
    from_.AddFactor("reach", std::make_shared<Reach>(), {2}, {7});
    to_.AddPose(from_.InitialPose(2), 2.0);
    to_.AddScanOf(from_, 2, 0);
  }

  static int OnlyTheLast(int id) { return id == 2 ? 0 : -1; }

  SlamGraph from_, to_;
};

TEST_F(CopyFactorTest, GivesItTheIdsThatItsPosesAndReturnsHaveThere) {
  ASSERT_TRUE(from_.status().ok()) << from_.status().message();
  CopyFactor(from_, from_.factors()[0], OnlyTheLast, OnlyTheLast, &to_);
  ASSERT_EQ(to_.factors().size(), 1u);
  EXPECT_EQ(to_.factors()[0].name, "reach");
  EXPECT_EQ(to_.factors()[0].poses, std::vector<int>{0});
  EXPECT_EQ(to_.factors()[0].points, std::vector<std::size_t>{1});
}

TEST_F(CopyFactorTest, LeavesOutWhatSeesMoreThanIsThere) {
  const auto nowhere = [](int) { return -1; };
  CopyFactor(from_, from_.factors()[0], OnlyTheLast, nowhere, &to_);
  CopyFactor(from_, from_.factors()[0], nowhere, OnlyTheLast, &to_);
  EXPECT_TRUE(to_.factors().empty());
  EXPECT_TRUE(to_.status().ok());
}

TEST_F(CopyFactorTest, AFactorBetweenPosesAndPointsLeavesTheFirstPoseFixed) {
  EXPECT_EQ(from_.fixed_poses().size(), 1u);
}

}  // namespace
}  // namespace plumbline
