#ifndef PLUMBLINE_APPS_EVALUATION_TRAJECTORY_METRICS_H_
#define PLUMBLINE_APPS_EVALUATION_TRAJECTORY_METRICS_H_

#include <string>
#include <vector>

#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/trajectory_io.h"

namespace plumbline {

struct TrajectoryMetricsOptions {
  /// Poses of the two trajectories are a pair if their times differ by no more than this [s], up to
  /// an hour.
  double max_time_difference_s = 0.01;
  /// Step of the relative error, in pairs.
  int delta_frames = 1;
  /// Step of the relative error in path length of the estimate [m], from 1e-6 to 1e7, as far as
  /// poses may lie apart.
  double delta_m = 1.0;

  bool Check(std::string* error) const;
};

/// Errors of an estimated trajectory against the true one.
struct TrajectoryMetrics {
  /// Absolute error per pair, after the motion that brings the positions closest. num_unmatched
  /// counts poses of the shorter trajectory.
  PoseErrorStatistics absolute;
  /// Relative errors over steps that follow one another without overlap.
  PoseErrorStatistics relative_frames, relative_metres;
};

/// ATE and RPE with the conventions of the tool evo (M. Grupp), `evo_ape --align` and `evo_rpe`:
/// each pose of the shorter trajectory pairs with the nearest in time of the longer; a step in
/// metres ends at the first pose at least delta_m further along the path, the first step starting
/// where the first delta_m end. Steps go in order of time; if pairing says by order, pose i of the
/// one pairs with pose i of the other, and with a useless clock steps go in this order.
TrajectoryMetrics MeasureTrajectory(const std::vector<TimedPose>& estimate,
                                    const std::vector<TimedPose>& truth,
                                    const TrajectoryMetricsOptions& options,
                                    const Pairing& pairing = Pairing());

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_TRAJECTORY_METRICS_H_
