#ifndef PLUMBLINE_SOLVERS_FRONT_END_GIVEN_POSES_H_
#define PLUMBLINE_SOLVERS_FRONT_END_GIVEN_POSES_H_

#include <optional>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/odometry_report.h"

namespace plumbline {

/// The noise of given poses, from how they disagree with matched ones. Robust against poses that
/// are matched wrong: a minority of them has no influence. std::nullopt if the disagreement between
/// two poses grows with the number of steps between them, or if there are too few poses to tell.
/// given, matched: world_from_robot, one per pose.
std::optional<PoseNoise> MeasurePoseNoise(const std::vector<Pose2>& given,
                                          const std::vector<Pose2>& matched);

/// Step from pose to - 1 to pose `to` that leads to the given pose, once the last few given poses
/// before it are aligned with the matched poses. given, matched: world_from_robot from the first
/// pose on, given up to `to`, matched up to to - 1; to >= 1.
Pose2 StepToGivenPose(const std::vector<Pose2>& given, const std::vector<Pose2>& matched, int to);

/// Noise of such a step, for a matching.
MotionOptions StepNoise(const PoseNoise& noise);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_GIVEN_POSES_H_
