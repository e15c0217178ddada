#ifndef PLUMBLINE_SOLVERS_FRONT_END_MOTION_PREDICTION_H_
#define PLUMBLINE_SOLVERS_FRONT_END_MOTION_PREDICTION_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/odometry_report.h"

namespace plumbline {

/// Whether the graph has several poses and no odometry at all, so that the scans alone tell how the
/// robot moved.
bool LacksOdometry(const SlamGraph& graph);

/// Predicts the motion of a robot without odometry: it keeps its speed and turn rate.
///
/// Time is counted in periods of the laser. A laser turns at a constant rate, so that the time from
/// one scan to the next is a whole number of periods, and more than one where scans are missing.
/// The period is the median interval. Stamps with other intervals tell when a computer found the
/// time to write. These are no use here, as are stamps that do not change: each step then takes one
/// period.
class MotionPrediction {
 public:
  /// For the times of the graph's poses.
  explicit MotionPrediction(const SlamGraph& graph);
  /// For poses at these times [s].
  explicit MotionPrediction(const std::vector<double>& timestamps_s);

  /// The step from pose to - 1 to pose `to`: the median motion per period of the last three steps,
  /// as a single step may be a mistake. No motion where there is no step before. poses:
  /// world_from_robot, those before `to` are used; `to` is at least 1.
  Pose2 Step(const std::vector<Pose2>& poses, int to) const;

  /// The period of the laser [s]; 0 if the stamps do not tell.
  double period_s() const { return period_s_; }

 private:
  double period_s_ = 0.0;
  std::vector<double> num_periods_;  // of the step to each pose
};

/// The noise of predicted steps before anything was matched: a robot may start, stop and turn from
/// one scan to the next, as far as the matcher can follow. `given`: the alphas are as there.
MotionOptions PredictionPrior(const MotionOptions& given);

/// The noise of predicted steps, as the matched poses differ from them: the floors of `motion` are
/// the root mean squares of these differences, but not below those of `given`.
OdometryNoiseReport MeasurePredictionNoise(const SlamGraph& graph, const std::vector<Pose2>& poses,
                                           const MotionOptions& given);

/// Adds odometry to a graph that lacks it: the predicted steps for these poses.
Status AddPredictedSteps(const std::vector<Pose2>& poses, SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_MOTION_PREDICTION_H_
