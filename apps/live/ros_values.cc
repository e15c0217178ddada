#include "plumbline/apps/live/ros_values.h"

#include <cmath>

namespace plumbline {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

// Standard deviations that poses are given with.
constexpr double kPoseSigmaM = 0.05, kPoseSigmaRad = 0.02;

}  // namespace

RosTime ToRosTime(double stamp_s) {
  double seconds = std::floor(stamp_s);
  double nanoseconds = std::round((stamp_s - seconds) * kNanosecondsPerSecond);
  if (nanoseconds >= kNanosecondsPerSecond) {
    seconds += 1.0;
    nanoseconds = 0.0;
  }
  // By way of 64 bits, in which times after 2038 wrap around.
  return {static_cast<std::int32_t>(static_cast<std::int64_t>(seconds)),
          static_cast<std::uint32_t>(nanoseconds)};
}

double ToSeconds(const RosTime& time) {
  return static_cast<double>(time.sec) + 1e-9 * static_cast<double>(time.nanosec);
}

std::int8_t ToRosCell(Occupancy occupancy) {
  switch (occupancy) {
    case Occupancy::kOccupied:
      return 100;
    case Occupancy::kFree:
      return 0;
    case Occupancy::kUnknown:
      break;
  }
  return -1;
}

std::array<double, 36> RosPoseCovariance() {
  constexpr double kVarianceM2 = kPoseSigmaM * kPoseSigmaM;
  std::array<double, 36> covariance{};
  covariance[0] = covariance[7] = kVarianceM2;
  covariance[35] = kPoseSigmaRad * kPoseSigmaRad;
  return covariance;
}

}  // namespace plumbline
