#include "plumbline/core/pose_frame.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

TEST(PoseFrameTest, TurnsAVectorByAnyAngle) {
  const Eigen::Vector2d v(3.0, -4.0);
  for (const double angle_rad :
       {0.0, 1e-9, -1e-4, 0.02, 0.0499, -0.0499, 0.0501, -0.0501, 0.3, -3.0, 7.0}) {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    const Eigen::Vector2d expected(c * v.x() - s * v.y(), s * v.x() + c * v.y());
    EXPECT_LT((Turned(v, angle_rad) - expected).norm(), 5e-15) << angle_rad;
  }
}

}  // namespace
}  // namespace plumbline
