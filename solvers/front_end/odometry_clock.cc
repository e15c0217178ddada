#include "plumbline/solvers/front_end/odometry_clock.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"
#include "plumbline/core/sweep_motion.h"

namespace plumbline {
namespace {

constexpr double kMaxOffsetS = 1.0;
// Over a longer gap the robot need not have moved steadily.
constexpr double kMaxStepS = 1.0;
// Fewer steps say little, and more hardly more.
constexpr std::size_t kMinTurnSteps = 100, kMaxTurnSteps = 5000;
// Of the offsets that are tried. Scans may have stamps that lie closer than the robot can turn.
constexpr double kFinestSpacingS = 0.02;
// Residuals count as this many robust standard deviations at most.
constexpr double kMaxSigmas = 3.0;

// Where a time lies among rising times: from `pose` on, by this share of the step to the next.
struct Moment {
  std::size_t pose;
  double share;  // 0 to 1
};

// Of every pose, the moment `shift_s` after it, or the end that it is beyond. times_s: two or more,
// in order.
std::vector<Moment> MomentsAfter(const std::vector<double>& times_s, double shift_s) {
  std::vector<Moment> moments;
  std::size_t from = 0;
  for (const double time_s : times_s) {
    while (from + 2 < times_s.size() && times_s[from + 1] <= time_s + shift_s) ++from;
    const double step_s = times_s[from + 1] - times_s[from];
    const double share = step_s > 0.0 ? (time_s + shift_s - times_s[from]) / step_s : 0.0;
    moments.push_back({from, std::clamp(share, 0.0, 1.0)});
  }
  return moments;
}

class TurnComparison {
 public:
  TurnComparison(const SlamGraph& graph, const SequentialTrajectory& trajectory) {
    const std::vector<Pose2>& poses = trajectory.world_from_robot;
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
      times_s_.push_back(graph.timestamp_s(static_cast<int>(pose)));
      if (pose == 0) {
        heading_.push_back(0.0);
        continue;
      }
      const double turn = NormalizeAngle(poses[pose].yaw - poses[pose - 1].yaw);
      heading_.push_back(heading_.back() + turn);
      const double step_s = times_s_[pose] - times_s_[pose - 1];
      if (!(step_s > 0.0) || step_s > kMaxStepS) continue;
      steps_.push_back({pose, NormalizeAngle(trajectory.odometry[pose].yaw),
                        Between(poses[pose - 1], poses[pose]).x});
    }
    ThinOut();
  }

  bool HasEnoughSteps() const { return steps_.size() >= kMinTurnSteps; }

  double TypicalPeriodS() const {
    std::vector<double> periods_s;
    for (const Step& step : steps_) {
      periods_s.push_back(times_s_[step.pose] - times_s_[step.pose - 1]);
    }
    return Median(std::move(periods_s));
  }

  struct Fit {
    double noise_rad = 0.0;  // of a step's turn, robust
    double step_s = 0.0;     // towards a better offset
    double sigma_s = 0.0;
  };

  // The best constant errors for an offset, and where they would have it, by what the turns are
  // `spacing_s` before and after it.
  Fit FitAt(double offset_s, double spacing_s) const {
    const std::vector<double> turns = TurnsAt(offset_s), before = TurnsAt(offset_s - spacing_s),
                              after = TurnsAt(offset_s + spacing_s);
    std::vector<Eigen::Vector4d> rows;  // offset, per rad, per m; difference
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      rows.emplace_back((after[i] - before[i]) / (2.0 * spacing_s), turns[i], steps_[i].forward_m,
                        steps_[i].turn_rad - turns[i]);
    }
    Eigen::Vector3d solution = Eigen::Vector3d::Zero();
    Fit fit;
    fit.noise_rad = RobustSigma(rows, solution);
    constexpr int kIterations = 5;
    for (int i = 0; i < kIterations; ++i) {
      // Belief in errors of 1 s, 1 rad/rad and 1 rad/m: keeps a drive without turns solvable.
      Eigen::Matrix3d information = fit.noise_rad * fit.noise_rad * Eigen::Matrix3d::Identity();
      Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
      for (const Eigen::Vector4d& row : rows) {
        const Eigen::Vector3d by = row.head<3>();
        const double residual = std::abs(row[3] - by.dot(solution));
        const double gate = kMaxSigmas * fit.noise_rad;
        const double weight = residual > gate ? gate / residual : 1.0;
        information += weight * by * by.transpose();
        weighted += weight * row[3] * by;
      }
      const Eigen::Matrix3d inverse = information.inverse();
      solution = inverse * weighted;
      fit.noise_rad = RobustSigma(rows, solution);
      fit.sigma_s = fit.noise_rad * std::sqrt(inverse(0, 0));
    }
    fit.step_s = solution[0];
    // What the offset itself could still explain belongs to other offsets.
    solution[0] = 0.0;
    fit.noise_rad = RobustSigma(rows, solution);
    return fit;
  }

 private:
  struct Step {
    std::size_t pose;  // at its end
    double turn_rad;   // by the odometry
    double forward_m;  // as matched
  };

  // Leaves every second step, or every third and so on.
  void ThinOut() {
    const std::size_t stride = (steps_.size() + kMaxTurnSteps - 1) / kMaxTurnSteps;
    if (stride <= 1) return;
    std::size_t num_kept = 0;
    for (std::size_t i = 0; i < steps_.size(); i += stride) steps_[num_kept++] = steps_[i];
    steps_.resize(num_kept);
  }

  // As matched, of every step, from `offset_s` after the scan before to as long after its own.
  std::vector<double> TurnsAt(double offset_s) const {
    const std::vector<Moment> moments = MomentsAfter(times_s_, offset_s);
    std::vector<double> turns;
    for (const Step& step : steps_) {
      turns.push_back(HeadingAt(moments[step.pose]) - HeadingAt(moments[step.pose - 1]));
    }
    return turns;
  }

  double HeadingAt(const Moment& moment) const {
    const double turn = heading_[moment.pose + 1] - heading_[moment.pose];
    return heading_[moment.pose] + moment.share * turn;
  }

  // Root mean square of the residuals, each of which counts as at most a few medians.
  static double RobustSigma(const std::vector<Eigen::Vector4d>& rows,
                            const Eigen::Vector3d& solution) {
    std::vector<double> residuals;
    for (const Eigen::Vector4d& row : rows) {
      residuals.push_back(std::abs(row[3] - row.head<3>().dot(solution)));
    }
    constexpr double kSigmaOfMedian = 1.4826;  // of a normal distribution
    constexpr double kLeastRad = 1e-5;
    const double gate = kMaxSigmas * std::max(kLeastRad, kSigmaOfMedian * Median(residuals));
    double sum_squares = 0.0;
    for (const double residual : residuals) {
      const double gated = std::min(residual, gate);
      sum_squares += gated * gated;
    }
    return std::max(kLeastRad, std::sqrt(sum_squares / static_cast<double>(residuals.size())));
  }

  std::vector<double> times_s_;
  std::vector<double> heading_;  // as matched, summed up over all turns
  std::vector<Step> steps_;
};

}  // namespace

ClockOffset EstimateClockOffset(const SlamGraph& graph, const SequentialTrajectory& trajectory) {
  ClockOffset offset;
  const TurnComparison comparison(graph, trajectory);
  if (!comparison.HasEnoughSteps()) return offset;
  // The turns of one period look alike, so the right one is found by trying.
  const double spacing_s = std::max(kFinestSpacingS, 0.5 * comparison.TypicalPeriodS());
  const int num_tried = static_cast<int>(std::ceil(kMaxOffsetS / spacing_s));
  TurnComparison::Fit best = comparison.FitAt(0.0, spacing_s);
  for (int i = -num_tried; i <= num_tried; ++i) {
    const TurnComparison::Fit fit = comparison.FitAt(i * spacing_s, spacing_s);
    if (fit.noise_rad >= best.noise_rad) continue;
    best = fit;
    offset.value_s = i * spacing_s;
  }
  constexpr int kIterations = 10;
  for (int i = 0; i < kIterations; ++i) {
    offset.value_s += std::clamp(best.step_s, -spacing_s, spacing_s);
    best = comparison.FitAt(offset.value_s, spacing_s);
  }
  offset.sigma_s = best.sigma_s;
  return offset;
}

std::vector<Pose2> OdometryInTime(const SlamGraph& graph, const std::vector<Pose2>& odometry,
                                  double offset_s) {
  std::vector<double> times_s;
  std::vector<Pose2> poses;
  for (std::size_t pose = 0; pose < odometry.size(); ++pose) {
    times_s.push_back(graph.timestamp_s(static_cast<int>(pose)));
    poses.push_back(pose == 0 ? Pose2() : poses.back() * odometry[pose]);
  }
  if (poses.size() < 2) return odometry;
  std::vector<Pose2> in_time;
  for (const Moment& moment : MomentsAfter(times_s, -offset_s)) {
    in_time.push_back(poses[moment.pose] * PartOfMotion(odometry[moment.pose + 1], moment.share));
  }
  std::vector<Pose2> steps(odometry.size());
  for (std::size_t pose = 1; pose < odometry.size(); ++pose) {
    const bool is_known = times_s[pose - 1] - offset_s >= times_s.front() &&
                          times_s[pose] - offset_s <= times_s.back();
    steps[pose] = is_known ? Between(in_time[pose - 1], in_time[pose]) : odometry[pose];
  }
  return steps;
}

}  // namespace plumbline
