#include "plumbline/solvers/online/kept_scans.h"

#include <cmath>

namespace plumbline {

bool KeptScans::Keep(LiveScan* scan) {
  if (min_step_m_ == 0.0) return true;
  if (step_ && scan->step) {
    step_ = *step_ * *scan->step;
  } else {
    step_.reset();
  }
  as_driven_ = as_driven_ * scan->step_as_driven;
  constexpr double kRadPerM = 1.0;
  const Pose2 moved = Between(last_, scan->world_from_robot);
  const bool is_kept = !has_any_ || scan->keyframe || moved.translation().norm() >= min_step_m_ ||
                       std::abs(moved.yaw) >= kRadPerM * min_step_m_;
  if (!is_kept) return false;
  if (has_any_) {
    scan->step = step_;
    scan->matched_step = moved;
    scan->step_as_driven = as_driven_;
  }
  has_any_ = true;
  last_ = scan->world_from_robot;
  step_ = Pose2();
  as_driven_ = Pose2();
  return true;
}

}  // namespace plumbline
