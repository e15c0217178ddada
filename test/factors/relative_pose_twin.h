#ifndef PLUMBLINE_TEST_FACTORS_RELATIVE_POSE_TWIN_H_
#define PLUMBLINE_TEST_FACTORS_RELATIVE_POSE_TWIN_H_

#include <ceres/autodiff_cost_function.h>

#include <functional>

#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {

/// The relative pose residual for automatic differentiation, built on the composition of poses.
struct RelativePoseTwinFunctor {
  RelativePoseResidual fixed;

  template <typename T>
  bool operator()(const T* a, const T* b, T* residuals) const {
    const SE2<T> a_from_b = SE2<T>(a).Inverse() * SE2<T>(b);
    const Eigen::Matrix<T, 3, 1> error(a_from_b.x - fixed.a_from_b.x, a_from_b.y - fixed.a_from_b.y,
                                       NormalizeAngle(T(a_from_b.yaw - fixed.a_from_b.yaw)));
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(residuals);
    whitened = fixed.sqrt_information.cast<T>() * error;
    return true;
  }
};

using RelativePoseTwin = ceres::AutoDiffCostFunction<RelativePoseTwinFunctor, 3, 3, 3>;

/// Pairs of poses anywhere in the plane, up to 2.9 rad off the measured turn.
inline std::function<Blocks(RandomStates*)> RelativePoseStates(const Pose2& a_from_b) {
  return [a_from_b](RandomStates* random) -> Blocks {
    const Pose2 a = random->Pose();
    Pose2 b = random->Pose();
    b.yaw = a.yaw + a_from_b.yaw + random->Uniform(-2.9, 2.9);
    return {ToBlock(a), ToBlock(b)};
  };
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_FACTORS_RELATIVE_POSE_TWIN_H_
