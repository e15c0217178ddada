#include "plumbline/solvers/front_end/motion_prediction.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"
#include "plumbline/solvers/front_end/scan_matcher.h"

namespace plumbline {
namespace {

// An interval is a whole number of periods if it is off by no more than this share of a period.
constexpr double kMaxOffPeriod = 0.25;
// The stamps are those of the laser if this share of the intervals are such.
constexpr double kMinWholeShare = 0.9;
constexpr int kStepsBefore = 3;
// The coarse gate of the matcher, seen from here [m], is the turn that it can follow: a robot's
// surroundings are rarely nearer all round.
constexpr double kSurroundingsM = 2.0;

// No motion where there is no step before.
double MedianOrZero(const std::vector<double>& values) {
  return values.empty() ? 0.0 : Median(values);
}

}  // namespace

bool LacksOdometry(const SlamGraph& graph) {
  return graph.num_poses() > 1 && graph.odometry().empty();
}

MotionPrediction::MotionPrediction(const SlamGraph& graph)
    : MotionPrediction(graph.timestamps_s()) {}

MotionPrediction::MotionPrediction(const std::vector<double>& timestamps_s)
    : num_periods_(timestamps_s.size(), 1.0) {
  std::vector<double> intervals_s;
  for (std::size_t pose = 1; pose < timestamps_s.size(); ++pose) {
    intervals_s.push_back(timestamps_s[pose] - timestamps_s[pose - 1]);
  }
  const double period_s = MedianOrZero(intervals_s);
  if (!(period_s > 0.0)) return;
  std::vector<double> num_periods(num_periods_);
  std::size_t num_whole = 0;
  for (std::size_t i = 0; i < intervals_s.size(); ++i) {
    const double periods = intervals_s[i] / period_s;
    num_periods[i + 1] = std::max(1.0, std::round(periods));
    if (std::abs(periods - num_periods[i + 1]) <= kMaxOffPeriod) ++num_whole;
  }
  if (static_cast<double>(num_whole) < kMinWholeShare * static_cast<double>(intervals_s.size())) {
    return;
  }
  period_s_ = period_s;
  num_periods_ = std::move(num_periods);
}

Pose2 MotionPrediction::Step(const std::vector<Pose2>& poses, int to) const {
  std::vector<double> x, y, yaw;
  for (int pose = std::max(1, to - kStepsBefore); pose < to; ++pose) {
    const Pose2 step = Between(poses[pose - 1], poses[pose]);
    x.push_back(step.x / num_periods_[pose]);
    y.push_back(step.y / num_periods_[pose]);
    yaw.push_back(NormalizeAngle(step.yaw) / num_periods_[pose]);
  }
  const double periods = num_periods_[to];
  return {periods * MedianOrZero(x), periods * MedianOrZero(y),
          NormalizeAngle(periods * MedianOrZero(yaw))};
}

MotionOptions PredictionPrior(const MotionOptions& given) {
  MotionOptions prior = given;
  const double off_m = ScanMatchOptions().coarse_gate_m;
  prior.translation_floor_m = std::max(given.translation_floor_m, off_m);
  prior.rotation_floor_rad = std::max(given.rotation_floor_rad, off_m / kSurroundingsM);
  return prior;
}

OdometryNoiseReport MeasurePredictionNoise(const SlamGraph& graph, const std::vector<Pose2>& poses,
                                           const MotionOptions& given) {
  const MotionPrediction prediction(graph);
  double sum_m2 = 0.0, sum_rad2 = 0.0;
  for (int to = 1; to < graph.num_poses(); ++to) {
    const Pose2 off = Between(prediction.Step(poses, to), Between(poses[to - 1], poses[to]));
    sum_m2 += off.translation().squaredNorm();
    sum_rad2 += off.yaw * off.yaw;
  }
  const double num_steps = std::max(1, graph.num_poses() - 1);
  OdometryNoiseReport report;
  report.is_prediction = true;
  report.motion = given;
  // Of each axis.
  report.motion.translation_floor_m =
      std::max(given.translation_floor_m, std::sqrt(0.5 * sum_m2 / num_steps));
  report.motion.rotation_floor_rad =
      std::max(given.rotation_floor_rad, std::sqrt(sum_rad2 / num_steps));
  return report;
}

Status AddPredictedSteps(const std::vector<Pose2>& poses, SlamGraph* graph) {
  const MotionPrediction prediction(*graph);
  for (int to = 1; to < graph->num_poses(); ++to) {
    graph->AddOdometry({to - 1, to, prediction.Step(poses, to)});
  }
  return graph->status();
}

}  // namespace plumbline
