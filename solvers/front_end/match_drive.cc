#include "plumbline/solvers/front_end/match_drive.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/given_poses.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/odometry_clock.h"
#include "plumbline/solvers/front_end/odometry_noise.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/front_end/still_wheels.h"

namespace plumbline {
namespace {

// Largest relative scale error of wheels in order, from worn tyres or a wrong wheel radius. A
// larger error is a wrong unit, gear or sign.
constexpr double kMaxScaleError = 0.2;
// Smallest scale of an odometry that reports translations at all.
constexpr double kMinScale = 0.05;
// Shortest path [m] over which a missing translation is recognised.
constexpr double kMinPathM = 1.0;
// Largest TroubleShare of odometry in order: 0.025 on orebro, 0.016 on fr-clinic, at most 0.002 on
// fr079, intel, aces and mit-killian.
constexpr double kMaxTroubleShare = 0.03;

// Largest noise of given poses [m] that the matching of a step can follow without a search.
double MaxPositionSigmaM() { return 0.5 * ScanMatchOptions().coarse_gate_m; }

// Whether an offset of the clocks makes the turns of odometry and scans agree better. What looks
// like one may be the jitter of the stamps: the odometry of intel's first third fits best 50 ms
// later, and is then in error by half as much again.
bool Explains(const OdometryNoiseReport& in_time, const OdometryNoiseReport& as_given) {
  return !in_time.rotation.estimated || !as_given.rotation.estimated ||
         in_time.motion.rotation_per_rotation < as_given.motion.rotation_per_rotation;
}

// Takes the errors that stay the same for the whole log out of the odometry.
OdometryNoiseReport MeasureOdometry(const SlamGraph& graph, const MotionOptions& motion,
                                    SequentialTrajectory* trajectory) {
  const ClockOffset clock_offset = EstimateClockOffset(graph, *trajectory);
  OdometryNoiseReport report = EstimateOdometryNoise(*trajectory, motion);
  std::vector<Pose2> odometry = trajectory->odometry;
  if (clock_offset.IsSignificant()) {
    SequentialTrajectory in_time = *trajectory;
    in_time.odometry = OdometryInTime(graph, odometry, clock_offset.value_s);
    const OdometryNoiseReport report_in_time = EstimateOdometryNoise(in_time, motion);
    if (Explains(report_in_time, report)) {
      report = report_in_time;
      report.clock_offset = clock_offset;
      odometry = std::move(in_time.odometry);
    }
  } else {
    report.clock_offset = clock_offset;
  }
  for (Pose2& step : odometry) step = CorrectStep(step, report);
  CorrectOdometry(std::move(odometry), motion, trajectory);
  return report;
}

Status Match(const SeedingOptions& options, const MotionOptions& motion, const StepSource& steps,
             const SeedingProgress& progress, ThreadPool* pool, ScanSurfaces* surfaces,
             SequentialTrajectory* trajectory, SeedingReport* report) {
  const bool is_prediction = steps.odometry.empty();
  PLUMBLINE_RETURN_IF_ERROR(SeedSequentially(options, motion, steps, progress, pool, surfaces,
                                             trajectory, &report->sequential));
  // Nothing was measured there: not the predictions' errors, either.
  for (std::size_t pose = 1; pose < steps.is_still.size(); ++pose) {
    if (steps.is_still[pose] == 0) continue;
    trajectory->odometry[pose] =
        Between(trajectory->world_from_robot[pose - 1], trajectory->world_from_robot[pose]);
  }
  report->odometry_noise =
      is_prediction
          ? MeasurePredictionNoise(surfaces->graph(), trajectory->world_from_robot, motion)
          : MeasureOdometry(surfaces->graph(), motion, trajectory);
  report->odometry_noise.num_still_steps =
      static_cast<int>(std::count(steps.is_still.begin(), steps.is_still.end(), 1));
  return Status::Ok();
}

// Path length of the odometry divided by that of the matching, both from keyframe to keyframe,
// which leaves out the jitter of a standing robot. 1 if the path is shorter than kMinPathM.
double ReportedShare(const SequentialTrajectory& trajectory) {
  double reported_m = 0.0, driven_m = 0.0;
  for (std::size_t k = 1; k < trajectory.keyframes.size(); ++k) {
    const int from = trajectory.keyframes[k - 1].pose, to = trajectory.keyframes[k].pose;
    Pose2 step;
    for (int pose = from + 1; pose <= to; ++pose) step = step * trajectory.odometry[pose];
    reported_m += step.translation().norm();
    driven_m += Between(trajectory.world_from_robot[from], trajectory.world_from_robot[to])
                    .translation()
                    .norm();
  }
  return driven_m < kMinPathM ? 1.0 : reported_m / driven_m;
}

// Translation of the odometry per unit of the true motion: 1 if it is within kMaxScaleError of 1,
// and 0 if the odometry reports no translation.
double GrossScale(const OdometryNoiseReport& noise, const SequentialTrajectory& trajectory) {
  if (!noise.translation.estimated) return ReportedShare(trajectory) < kMinScale ? 0.0 : 1.0;
  const SystematicError& error = noise.translation_scale;
  if (std::abs(error.value) <= std::max(kMaxScaleError, 4.0 * error.sigma)) return 1.0;
  const double scale = 1.0 + error.value;
  return std::abs(scale) < kMinScale ? 0.0 : scale;
}

// Share of the scans that match nothing near by, match only far from the odometry, or contradict
// it.
double TroubleShare(const SeedingReport& report, std::size_t num_steps) {
  const int num_troubles = report.sequential.num_unmatched + report.sequential.num_recovered +
                           report.odometry_noise.num_leaps;
  return num_troubles / static_cast<double>(num_steps);
}

// What a matching without odometry says of a drive that the odometry has misled.
struct BlindMeasurement {
  double gross_scale = 1.0;
  std::optional<PoseNoise> given_poses;
  std::vector<char> still_wheels;  // FindStillWheels
};

Status MeasureBlindly(const SeedingOptions& options, const MotionOptions& motion,
                      const std::vector<Pose2>& odometry, const SeedingProgress& progress,
                      ThreadPool* pool, ScanSurfaces* surfaces, BlindMeasurement* measured) {
  const MotionOptions prior = PredictionPrior(motion);
  SequentialTrajectory blind;
  SequentialSeedingReport report;
  PLUMBLINE_RETURN_IF_ERROR(
      SeedSequentially(options, motion, StepSource(), progress, pool, surfaces, &blind, &report));
  measured->given_poses =
      MeasurePoseNoise(PosesOf(surfaces->graph().initial_poses()), blind.world_from_robot);
  measured->still_wheels = FindStillWheels(odometry, blind);
  blind.odometry = odometry;
  measured->gross_scale = GrossScale(EstimateOdometryNoise(blind, prior), blind);
  return Status::Ok();
}

Status MatchGivenPoses(const SeedingOptions& options, const PoseNoise& noise,
                       const SeedingProgress& progress, ThreadPool* pool, ScanSurfaces* surfaces,
                       SequentialTrajectory* trajectory, SeedingReport* report) {
  StepSource steps;
  steps.given_poses = PosesOf(surfaces->graph().initial_poses());
  report->odometry_noise = OdometryNoiseReport();
  report->odometry_noise.is_prediction = true;
  report->odometry_noise.given_poses = noise;
  report->odometry_noise.motion = StepNoise(noise);
  PLUMBLINE_RETURN_IF_ERROR(SeedSequentially(options, report->odometry_noise.motion, steps,
                                             progress, pool, surfaces, trajectory,
                                             &report->sequential));
  trajectory->given_poses = std::move(steps.given_poses);
  trajectory->given_noise = noise;
  return Status::Ok();
}

// Per pose, whether the step to it was not measured; empty if all steps were.
std::vector<char> UnmeasuredSteps(const SlamGraph& graph) {
  std::vector<char> unmeasured(graph.num_poses(), 0);
  bool is_any = false;
  for (const OdometryConstraint& step : graph.odometry()) {
    if (step.is_measured || step.to != step.from + 1) continue;
    unmeasured[step.to] = 1;
    is_any = true;
  }
  return is_any ? unmeasured : std::vector<char>();
}

}  // namespace

Status MatchDrive(const SeedingOptions& options, const MotionOptions& motion,
                  const SeedingProgress& progress, ThreadPool* pool, ScanSurfaces* surfaces,
                  SequentialTrajectory* trajectory, SeedingReport* report) {
  StepSource steps;
  std::vector<Pose2>& odometry = steps.odometry;
  PLUMBLINE_RETURN_IF_ERROR(OdometrySteps(surfaces->graph(), &odometry));
  steps.is_still = UnmeasuredSteps(surfaces->graph());
  const auto match = [&] {
    return Match(options, motion, steps, progress, pool, surfaces, trajectory, report);
  };
  PLUMBLINE_RETURN_IF_ERROR(match());
  if (odometry.empty()) return Status::Ok();
  double scale = GrossScale(report->odometry_noise, *trajectory);
  // Odometry that misled the matching cannot be measured by it.
  if (scale == 1.0 && std::max(TroubleShare(*report, odometry.size()),
                               trajectory->worst_trouble_share) > kMaxTroubleShare) {
    BlindMeasurement measured;
    PLUMBLINE_RETURN_IF_ERROR(
        MeasureBlindly(options, motion, odometry, progress, pool, surfaces, &measured));
    if (measured.given_poses && measured.given_poses->position_m > MaxPositionSigmaM()) {
      return MatchGivenPoses(options, *measured.given_poses, progress, pool, surfaces, trajectory,
                             report);
    }
    if (!report->odometry_noise.translation.estimated) scale = measured.gross_scale;
    const std::vector<char>& still = measured.still_wheels;
    if (scale == 1.0 && std::find(still.begin(), still.end(), 1) != still.end()) {
      steps.is_still.resize(still.size(), 0);
      for (std::size_t pose = 0; pose < still.size(); ++pose) {
        if (still[pose] != 0) steps.is_still[pose] = 1;
      }
      return match();
    }
  }
  if (scale == 1.0) return Status::Ok();
  if (scale != 0.0) {
    for (Pose2& step : odometry) step = Pose2(step.x / scale, step.y / scale, step.yaw);
    PLUMBLINE_RETURN_IF_ERROR(match());
    if (GrossScale(report->odometry_noise, *trajectory) != 1.0) scale = 0.0;
  }
  if (scale == 0.0) {
    odometry.clear();
    steps.is_still.clear();
    PLUMBLINE_RETURN_IF_ERROR(match());
  }
  report->odometry_noise.gross_translation_scale = scale;
  return Status::Ok();
}

}  // namespace plumbline
