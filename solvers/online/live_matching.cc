#include "plumbline/solvers/online/live_matching.h"

#include <algorithm>
#include <cstddef>

#include "plumbline/solvers/front_end/motion_prediction.h"

namespace plumbline {

LiveMatching::LiveMatching(const SeedingOptions& options, const MotionOptions& motion,
                           const ReturnNormalOptions& normals)
    : options_(options),
      motion_(motion),
      normals_(normals),
      pool_(1),
      tracker_(options_, motion_, /*sign_lost=*/false, Pose2()) {}

void LiveMatching::Match(LiveScan* scan) {
  scan->surface = MeasureSurface(scan->measured, normals_, &pool_);
  const SurfacePoints surface = ThinnedSurfaceOf(scan->measured, 0, scan->surface, kPointSpacingM);
  const int id = static_cast<int>(timestamps_s_.size());
  timestamps_s_.push_back(scan->measured.timestamp_s(0));
  const bool is_measured = scan->step && faults_.translation_scale != 0.0;
  Pose2 step;
  if (is_measured) {
    step = *scan->step;
    step.x /= faults_.translation_scale;
    step.y /= faults_.translation_scale;
  } else if (id > 0) {
    step = PredictedStep();
  }
  const int num_unmatched = report_.num_unmatched;
  const std::size_t num_keyframes = tracker_.matcher().keyframes().size();
  tracker_.Add(id, surface.empty() ? -1 : id, surface,
               is_measured ? StepKind::kMeasured : StepKind::kPredicted, step, &report_);
  const std::vector<Pose2>& poses = tracker_.poses();
  scan->world_from_robot = poses.back();
  scan->is_matched = report_.num_unmatched == num_unmatched;
  if (id > 0) scan->matched_step = Between(poses[id - 1], poses[id]);
  scan->step_as_driven = tracker_.steps().back();
  const std::vector<Keyframe>& keyframes = tracker_.matcher().keyframes();
  if (keyframes.size() == num_keyframes) return;
  tracker_.matcher().ForgetOldSurfaces();
  scan->keyframe = keyframes.back();
  scan->key_surface = std::make_shared<const PackedSurface>(surface);
}

void LiveMatching::SetOdometryFaults(const OdometryFaults& faults) {
  faults_ = faults;
  tracker_.matcher().set_sign_lost(faults.sign_lost);
}

// From the newest poses, and the period of the laser as their stamps show it.
Pose2 LiveMatching::PredictedStep() const {
  constexpr std::ptrdiff_t kMaxPoses = 100;
  const std::vector<Pose2>& poses = tracker_.poses();
  const std::ptrdiff_t num_poses = std::min<std::ptrdiff_t>(kMaxPoses, poses.size());
  const MotionPrediction prediction(
      std::vector<double>(timestamps_s_.end() - num_poses - 1, timestamps_s_.end()));
  return prediction.Step({poses.end() - num_poses, poses.end()}, static_cast<int>(num_poses));
}

}  // namespace plumbline
