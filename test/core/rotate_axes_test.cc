#include "plumbline/core/rotate_axes.h"

#include <gtest/gtest.h>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

TEST(RotateAxes, TurnsTheRowsAndTheColumns) {
  Eigen::Matrix3d in_b;
  in_b << 4.0, 0.0, 2.0, 0.0, 1.0, 0.0, 2.0, 0.0, 9.0;
  Eigen::Matrix3d in_a;  // a sees the x axis of b as its y axis
  in_a << 1.0, 0.0, 0.0, 0.0, 4.0, 2.0, 0.0, 2.0, 9.0;
  EXPECT_TRUE(RotateAxes(in_b, 0.5 * kPi).isApprox(in_a, 1e-12));
  EXPECT_TRUE(RotateAxes(RotateAxes(in_b, 0.7), -0.7).isApprox(in_b, 1e-12));
}

}  // namespace
}  // namespace plumbline
