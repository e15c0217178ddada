#include "plumbline/factors/range_beam_factor.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include "plumbline/core/laser_scan.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

struct Twin {
  RangeBeamResidual fixed;

  template <typename T>
  bool operator()(const T* pose, const T* point, T* residuals) const {
    using std::atan2;
    using std::sqrt;
    const Pose2& mount = fixed.robot_from_laser;
    const SE2<T> robot_from_laser(T(mount.x), T(mount.y), T(mount.yaw));
    const Eigen::Matrix<T, 2, 1> q =
        (SE2<T>(pose) * robot_from_laser).Inverse() * Eigen::Matrix<T, 2, 1>(point[0], point[1]);
    residuals[0] = (sqrt(q.squaredNorm()) - fixed.range_m) * fixed.inv_sigma_range;
    residuals[1] =
        NormalizeAngle(T(atan2(q.y(), q.x()) - fixed.bearing_rad)) * fixed.inv_sigma_bearing;
    return true;
  }
};

// A laser 0.3 m ahead, 0.1 m to the right, turned by 0.2 rad.
RangeBeamResidual Beam(double range_m, double bearing_rad) {
  return {{0.3, -0.1, 0.2}, range_m, bearing_rad, 20.0, 50.0};
}

// Where the beam would end if its laser turned and its reading grew by this much.
Eigen::Vector2d EndOf(const RangeBeamResidual& beam, const Pose2& pose, double turn_rad = 0.0,
                      double growth_m = 0.0) {
  return pose * beam.robot_from_laser *
         BeamEnd(beam.range_m + growth_m, beam.bearing_rad + turn_rad);
}

TEST(RangeBeamFactor, HasTheHandWorkedValueAndDerivative) {
  // The laser sits at (1, 2.5) and looks along +y; the point is 4 m ahead and 3 m to the left.
  const RangeBeamFactor factor({{0.5, 0.0, 0.0}, 4.9, 0.6, 10.0, 100.0});
  const Blocks blocks = {{1.0, 2.0, kPi / 2.0}, {-2.0, 6.5}};
  ExpectResiduals(factor, blocks, {1.0, 100.0 * (0.64350110879328437 - 0.6)}, 1e-10);
  // Turning left carries the laser along -x, towards the point, by 0.5 m per rad.
  Eigen::Matrix<double, 2, 3> d_pose;
  d_pose << 6.0, -8.0, -3.0, 16.0, 12.0, 100.0 * (-1.0 - 0.5 * 0.16);
  Eigen::Matrix2d d_point;
  d_point << -6.0, 8.0, -16.0, -12.0;
  const FactorEvaluation at = Evaluate(factor, blocks);
  EXPECT_LT((at.jacobians[0] - d_pose).norm(), 1e-10) << at.jacobians[0];
  EXPECT_LT((at.jacobians[1] - d_point).norm(), 1e-10) << at.jacobians[1];
}

TEST(RangeBeamFactor, IsZeroAtTheEndOfTheBeam) {
  RandomStates random(3);
  for (int i = 0; i < 20; ++i) {
    const RangeBeamResidual beam = Beam(random.Uniform(0.1, 30.0), random.Uniform(-kPi, kPi));
    const Pose2 pose = random.Pose();
    ExpectResiduals(RangeBeamFactor(beam), {ToBlock(pose), ToBlock(EndOf(beam, pose))}, {0.0, 0.0},
                    1e-11);
  }
}

TEST(RangeBeamFactor, ObeysTheFactorLaws) {
  // Short, usual, and straight behind, where atan2 jumps but the wrapped error does not.
  for (const RangeBeamResidual& beam : {Beam(0.05, 0.4), Beam(2.0, -1.2), Beam(1.5, kPi)}) {
    ExpectFactorLaws(RangeBeamFactor(beam),
                     ceres::AutoDiffCostFunction<Twin, 2, 3, 2>(new Twin{beam}),
                     [&beam](RandomStates* random) -> Blocks {
                       const Pose2 pose = random->Pose();
                       const double turn = random->Uniform(-1.5, 1.5);
                       const double growth = random->Uniform(-0.4, 0.4) * beam.range_m;
                       return {ToBlock(pose), ToBlock(EndOf(beam, pose, turn, growth))};
                     });
  }
}

TEST(RangeBeamFactor, WrapsTheBearingError) {
  const Pose2 pose(0.4, -0.6, 2.0);
  for (const double side : {1.0, -1.0}) {
    RangeBeamResidual beam = Beam(2.0, side * (kPi - 0.01));
    const Eigen::Vector2d point = EndOf(beam, pose);
    beam.bearing_rad = -beam.bearing_rad;
    ExpectResiduals(RangeBeamFactor(beam), {ToBlock(pose), ToBlock(point)},
                    {0.0, -side * 0.02 * 50.0}, 1e-11);
  }
}

TEST(RangeBeamFactor, IsUnchangedWhenTheWorldMoves) {
  const RangeBeamFactor factor(Beam(2.0, 0.7));
  ExpectSameCostAfterMove(factor, factor, {10.0, -20.0, 2.5}, {{1.0, 2.0, -0.6}, {2.5, 1.0}});
}

TEST(RangeBeamFactor, RefusesAPointAtTheLaser) {
  const RangeBeamFactor factor({{0.5, 0.0, 0.0}, 1.0, 0.0, 1.0, 1.0});
  EXPECT_FALSE(Evaluate(factor, {{1.0, 2.0, 0.0}, {1.5, 2.0}}).ok);
  EXPECT_FALSE(Evaluate(factor, {{1.0, 2.0, 0.0}, {1e200, 2.0}}).ok);
}

TEST(EvaluateRangeBeam, GivesTheSameWithAnySubsetOfDerivatives) {
  const RangeBeamResidual beam = Beam(2.0, 0.7);
  const double pose[3] = {1.0, 2.0, -0.6}, point[2] = {2.5, 1.0};
  double all[2], none[2], d_pose[6], d_point[4], d_pose_alone[6], d_point_alone[4];
  ASSERT_TRUE(beam.Evaluate(pose, point, all, d_pose, d_point));
  ASSERT_TRUE(beam.Evaluate(pose, point, none, nullptr, nullptr));
  ASSERT_TRUE(beam.Evaluate(pose, point, none, d_pose_alone, nullptr));
  ASSERT_TRUE(beam.Evaluate(pose, point, none, nullptr, d_point_alone));
  for (int i = 0; i < 2; ++i) EXPECT_EQ(none[i], all[i]);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(d_pose_alone[i], d_pose[i]);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(d_point_alone[i], d_point[i]);
}

}  // namespace
}  // namespace plumbline
