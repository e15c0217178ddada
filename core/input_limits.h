#ifndef PLUMBLINE_CORE_INPUT_LIMITS_H_
#define PLUMBLINE_CORE_INPUT_LIMITS_H_

#include <cmath>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// What numbers from outside may be at most, either way: enough for UTM coordinates and for a
/// robot that keeps turning, and far from where cells, angles and squares lose their digits or
/// overflow.
constexpr double kMaxCoordinateM = 1e7;
constexpr double kMaxYawRad = 1e6;
constexpr double kMaxTimeS = 1e12;
/// Of the standard deviations of a relative pose [m, rad].
constexpr double kMinSigma = 1e-9, kMaxSigma = 1e9;

/// False also if a number is not finite.
inline bool IsWithinLimits(const Pose2& pose) {
  return std::abs(pose.x) <= kMaxCoordinateM && std::abs(pose.y) <= kMaxCoordinateM &&
         std::abs(pose.yaw) <= kMaxYawRad;
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_INPUT_LIMITS_H_
