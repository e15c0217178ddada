#include "plumbline/solvers/front_end/odometry_noise.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/odometry_span.h"

namespace plumbline {
namespace {

constexpr double kSpanM = 1.0;
constexpr double kSpanRad = 1.0;
// Two variances and two systematic errors from fewer spans than this are not worth having.
constexpr int kMinSpans = 30;
// A match that knows a quantity has at most this share of the variance that the odometry gave it
// as a prior, so that the prior holds it back by less than this share of the odometry's error.
constexpr double kMaxKnowingShare = 0.25;
// Errors of a span beyond this many standard deviations count as this many.
constexpr double kGateSigmas = 3.0;

// The quantities by their index in Vector2d (forward [m], turn [rad]).
constexpr int kForward = 0;
constexpr int kTurn = 1;

// A quantity's variance by a covariance matrix of (x, y, yaw) in the frame of the robot.
double VarianceOf(int quantity, const Eigen::Matrix3d& covariance) {
  const int index = quantity == kForward ? 0 : 2;
  return covariance(index, index);
}

Eigen::Vector2d ForwardAndTurn(const Pose2& step) { return {step.x, NormalizeAngle(step.yaw)}; }

// Length driven [m] and turned [rad]. Counted in stretches, as the jitter of single steps, of
// matching and odometry alike, would make a turn of a straight line.
class Path {
 public:
  void Add(const Eigen::Vector2d& motion) {
    constexpr double kStretchM = 0.1;
    constexpr double kStretchRad = 0.1;
    stretch_ += motion;
    if (std::abs(stretch_.x()) < kStretchM && std::abs(stretch_.y()) < kStretchRad) return;
    completed_ += stretch_.cwiseAbs();
    stretch_.setZero();
  }

  Eigen::Vector2d length() const { return completed_ + stretch_.cwiseAbs(); }

 private:
  Eigen::Vector2d stretch_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d completed_ = Eigen::Vector2d::Zero();
};

// What odometry and matching say of the motion between two keyframes.
struct Span {
  Eigen::Vector2d error = Eigen::Vector2d::Zero();    // odometry minus matching
  Eigen::Vector2d matched = Eigen::Vector2d::Zero();  // with signs
  Path path;
  double match_variance = 0.0;  // of the quantity, at the span's end
};

struct Fit {
  Eigen::Vector2d systematic = Eigen::Vector2d::Zero();  // per m, per rad
  Eigen::Vector2d systematic_sigma = Eigen::Vector2d::Zero();
  Eigen::Vector2d variance_growth = Eigen::Vector2d::Zero();  // per m, per rad
};

// Variance of a quantity by the match of a keyframe alone.
double MatchVariance(const Keyframe& key, int quantity) {
  constexpr double kUnknown = 1e-3;  // keeps a match without information invertible
  return VarianceOf(quantity, (key.information + kUnknown * Eigen::Matrix3d::Identity()).inverse());
}

// Whether the match has measured the quantity, rather than followed the odometry.
bool Knows(const Keyframe& key, const Pose2& step, const MotionOptions& motion, int quantity) {
  const Eigen::Matrix3d predicted = RotateAxes(MotionCovariance(step, motion), -step.yaw);
  return MatchVariance(key, quantity) < kMaxKnowingShare * VarianceOf(quantity, predicted);
}

Pose2 MatchedStep(const SequentialTrajectory& trajectory, int pose) {
  return Between(trajectory.world_from_robot[pose - 1], trajectory.world_from_robot[pose]);
}

// The spans at each of whose keyframes the match knows the quantity.
std::vector<Span> CollectSpans(const SequentialTrajectory& trajectory, const MotionOptions& motion,
                               int quantity) {
  std::vector<Span> spans;
  Span span;
  bool known = false;  // at all keyframes of the span so far, the one at its start included
  int pose = 0;
  for (const Keyframe& key : trajectory.keyframes) {
    while (pose < key.pose) {
      ++pose;
      const Eigen::Vector2d matched = ForwardAndTurn(MatchedStep(trajectory, pose));
      span.error += ForwardAndTurn(trajectory.odometry[pose]) - matched;
      span.matched += matched;
      span.path.Add(matched);
    }
    const bool key_knows = Knows(key, trajectory.odometry[key.pose], motion, quantity);
    known = known && key_knows;
    if (known && span.path.length().x() < kSpanM && span.path.length().y() < kSpanRad) continue;
    if (known) {
      span.match_variance = MatchVariance(key, quantity);
      spans.push_back(span);
    }
    span = Span();
    known = key_knows;
  }
  return spans;
}

// The growth [per m, per rad] if the errors were all due to the one or all due to the other.
Eigen::Vector2d LargestGrowth(const std::vector<Span>& spans, int quantity) {
  double sum_squares = 0.0;
  Eigen::Vector2d path = Eigen::Vector2d::Zero();
  for (const Span& span : spans) {
    sum_squares += span.error[quantity] * span.error[quantity];
    path += span.path.length();
  }
  return sum_squares * (path.array() > 0.0).select(path.cwiseInverse(), 0.0);
}

// Alternates until both have settled: systematic errors for given variances, by weighted least
// squares, and variances for given systematic errors, by the multiplicative update of Zhou, Hu,
// Zhou, Lange (MM algorithms for variance components models, 2019), which keeps them positive.
// Maximum likelihood, but for the gate. is_systematic: 1 where the error has a constant part per m
// and per rad, otherwise 0.
Fit FitErrors(const std::vector<Span>& spans, int quantity, const Eigen::Vector2d& is_systematic) {
  // Belief in errors as large as the motion itself; keeps a log without turns solvable.
  constexpr double kPriorInformation = 1.0;
  constexpr int kIterations = 100;
  Fit fit;
  fit.variance_growth = LargestGrowth(spans, quantity);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix2d information = kPriorInformation * Eigen::Matrix2d::Identity();
    Eigen::Vector2d weighted_error = Eigen::Vector2d::Zero();
    Eigen::Vector2d seen = Eigen::Vector2d::Zero(), expected = Eigen::Vector2d::Zero();
    for (const Span& span : spans) {
      const double variance = fit.variance_growth.dot(span.path.length()) + span.match_variance;
      const Eigen::Vector2d motion = span.matched.cwiseProduct(is_systematic);
      const double residual = span.error[quantity] - motion.dot(fit.systematic);
      const double sigmas = std::abs(residual) / std::sqrt(variance);
      const double weight = std::min(1.0, kGateSigmas / sigmas) / variance;
      information += weight * motion * motion.transpose();
      weighted_error += weight * span.error[quantity] * motion;
      const double gated = std::min(sigmas, kGateSigmas);
      seen += gated * gated / variance * span.path.length();
      expected += span.path.length() / variance;
    }
    const Eigen::Matrix2d covariance = information.inverse();
    fit.systematic = covariance * weighted_error;
    fit.systematic_sigma = covariance.diagonal().cwiseSqrt();
    for (int i = 0; i < 2; ++i) {
      if (expected[i] > 0.0) fit.variance_growth[i] *= std::sqrt(seen[i] / expected[i]);
    }
  }
  return fit;
}

RandomError EstimateErrors(const SequentialTrajectory& trajectory, const MotionOptions& given,
                           int quantity, SystematicError* per_m, SystematicError* per_rad) {
  const std::vector<Span> spans = CollectSpans(trajectory, given, quantity);
  RandomError random;
  random.num_spans = static_cast<int>(spans.size());
  random.estimated = random.num_spans >= kMinSpans;
  if (!random.estimated) return random;
  const Fit fit = FitErrors(spans, quantity, {per_m != nullptr, per_rad != nullptr});
  if (per_m != nullptr) *per_m = {fit.systematic[0], fit.systematic_sigma[0]};
  if (per_rad != nullptr) *per_rad = {fit.systematic[1], fit.systematic_sigma[1]};
  random.sigma_per_sqrt_m = std::sqrt(fit.variance_growth[0]);
  random.sigma_per_sqrt_rad = std::sqrt(fit.variance_growth[1]);
  return random;
}

MotionOptions StepNoise(const SequentialTrajectory& trajectory, const RandomError& translation,
                        const RandomError& rotation, const MotionOptions& given) {
  Path path;
  for (std::size_t pose = 1; pose < trajectory.odometry.size(); ++pose) {
    path.Add(ForwardAndTurn(MatchedStep(trajectory, static_cast<int>(pose))));
  }
  MotionOptions motion = given;
  // Sets an alpha so that all steps together have the variance of the random error.
  const auto set = [&](double MotionOptions::*alpha, int quantity, double sigma_per_sqrt,
                       double length) {
    MotionOptions unit{0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    unit.*alpha = 1.0;
    double unit_variance = 0.0;
    for (std::size_t pose = 1; pose < trajectory.odometry.size(); ++pose) {
      unit_variance += VarianceOf(quantity, MotionCovariance(trajectory.odometry[pose], unit));
    }
    constexpr double kMax = 1e6;  // that MotionOptions allow
    const double variance = sigma_per_sqrt * sigma_per_sqrt * length;
    if (unit_variance > 0.0) motion.*alpha = std::min(std::sqrt(variance / unit_variance), kMax);
  };
  const Eigen::Vector2d length = path.length();
  if (translation.estimated) {
    set(&MotionOptions::translation_per_translation, kForward, translation.sigma_per_sqrt_m,
        length.x());
    set(&MotionOptions::translation_per_rotation_m_rad, kForward, translation.sigma_per_sqrt_rad,
        length.y());
  }
  if (rotation.estimated) {
    set(&MotionOptions::rotation_per_translation_rad_m, kTurn, rotation.sigma_per_sqrt_m,
        length.x());
    set(&MotionOptions::rotation_per_rotation, kTurn, rotation.sigma_per_sqrt_rad, length.y());
  }
  return motion;
}

}  // namespace

bool IsLeap(const Pose2& odometry, const Pose2& matched, const MotionOptions& motion) {
  const Eigen::Matrix3d covariance = MotionCovariance(odometry, motion);
  const double sigma_m = std::sqrt(covariance(0, 0) + covariance(1, 1));
  const double sigma_rad = std::sqrt(covariance(2, 2));
  return std::hypot(matched.x - odometry.x, matched.y - odometry.y) >
             std::max(kLeapM, kLeapSigmas * sigma_m) ||
         std::abs(NormalizeAngle(matched.yaw - odometry.yaw)) >
             std::max(kLeapRad, kLeapSigmas * sigma_rad);
}

OdometryNoiseReport EstimateOdometryNoise(const SequentialTrajectory& trajectory,
                                          const MotionOptions& given) {
  OdometryNoiseReport report;
  report.translation =
      EstimateErrors(trajectory, given, kForward, &report.translation_scale, nullptr);
  report.rotation =
      EstimateErrors(trajectory, given, kTurn, &report.heading_drift_rad_m, &report.rotation_scale);
  report.motion = StepNoise(trajectory, report.translation, report.rotation, given);
  for (std::size_t pose = 1; pose < trajectory.odometry.size(); ++pose) {
    const Pose2 odometry = CorrectStep(trajectory.odometry[pose], report);
    const Pose2 matched = MatchedStep(trajectory, static_cast<int>(pose));
    if (IsLeap(odometry, matched, report.motion)) ++report.num_leaps;
  }
  return report;
}

MotionOptions RefinementMotion(const OdometryNoiseReport& report, const MotionOptions& given) {
  constexpr double kJitterM = 0.005;  // 10 ms between the clocks of wheels and laser at 0.5 m/s
  MotionOptions motion = given;
  if (!report.translation.estimated) return motion;
  motion.translation_per_translation =
      std::min(given.translation_per_translation, report.motion.translation_per_translation);
  motion.translation_floor_m = std::min(given.translation_floor_m, kJitterM);
  return motion;
}

Pose2 CorrectStep(const Pose2& step, const OdometryNoiseReport& report) {
  const auto significant = [](const SystematicError& error) {
    return error.IsSignificant() ? error.value : 0.0;
  };
  const double scale = 1.0 / (1.0 + significant(report.translation_scale));
  const Pose2 forward(scale * step.x, scale * step.y, 0.0);
  const double yaw = NormalizeAngle(step.yaw);
  const double true_yaw = (yaw - significant(report.heading_drift_rad_m) * forward.x) /
                          (1.0 + significant(report.rotation_scale));
  // Half of the excess turn comes before the middle of the step.
  const Pose2 half_excess(0.0, 0.0, 0.5 * (true_yaw - yaw));
  return half_excess * Pose2(forward.x, forward.y, yaw) * half_excess;
}

void CorrectOdometry(std::vector<Pose2> corrected, const MotionOptions& motion,
                     SequentialTrajectory* trajectory) {
  const std::vector<Pose2>& poses = trajectory->world_from_robot;
  KeyframeGraph keys;
  keys.keyframes = trajectory->keyframes;
  keys.sequential.resize(std::max(1, keys.size()) - 1);
  for (const Keyframe& key : keys.keyframes) keys.world_from_key.push_back(poses[key.pose]);
  for (int k = 1; k < keys.size(); ++k) {
    const Keyframe& from = keys.keyframes[k - 1];
    const Keyframe& to = keys.keyframes[k];
    const Pose2 matched = Between(poses[from.pose], poses[to.pose]);
    const OdometrySpan before = ChainOdometry(trajectory->odometry, from.pose, to.pose, motion);
    const OdometrySpan after = ChainOdometry(corrected, from.pose, to.pose, motion);
    const Eigen::Vector3d change(after.from_from_to.x - before.from_from_to.x,
                                 after.from_from_to.y - before.from_from_to.y,
                                 NormalizeAngle(after.from_from_to.yaw - before.from_from_to.yaw));
    // The share of the change that a match of this information lets through. Applied twice: a
    // little of each edge's change is the map's drag on the match, which does not add up over the
    // edges, while along a corridor the share is 1 and stays so.
    const Eigen::Matrix3d prior = before.covariance.inverse();
    const Eigen::Matrix3d match = RotateAxes(to.information, matched.yaw);
    const Eigen::Matrix3d share = (match + prior).inverse() * prior;
    const Eigen::Vector3d moved = share * share * change;
    keys.world_from_key[k] =
        keys.world_from_key[k - 1] *
        Pose2(matched.x + moved.x(), matched.y + moved.y(), matched.yaw + moved.z());
  }
  trajectory->world_from_robot = PosesFollowingKeyframes(keys, poses);
  trajectory->odometry = std::move(corrected);
}

}  // namespace plumbline
