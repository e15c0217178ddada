#include "plumbline/solvers/front_end/odometry_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"
#include "plumbline/core/sweep_motion.h"

namespace plumbline {
namespace {

constexpr double kMaxOffsetS = 1.0;
// Longest gap between scans [s]: over a longer one the robot need not have moved steadily.
constexpr double kMaxGapS = 1.0;
// Largest share of stamps that repeat the one before. Where more do, they are rounded, or not those
// of the scans.
constexpr double kMaxRepeatedShare = 0.02;
// Offsets are tried this far apart, up to a margin beyond the largest, where a best one is none.
constexpr double kSpacingS = 0.02;
constexpr int kNumTriedEachWay = 60;
constexpr int kNumTried = 2 * kNumTriedEachWay + 1;
// Headings are averaged over a window and compared over a span [s], each of several scans: the
// noise of single scans depends on where between them a heading is interpolated, which is no
// offset.
constexpr double kWindowS = 0.25, kSpanS = 0.5, kMinPeriods = 5.0;
constexpr double kSampleSpacingS = 0.2;
constexpr std::size_t kMinSamples = 100, kMaxSamples = 3000;
// Prior sigma of the odometry's gain on turns, relative. Without it a gain of 0 would explain any.
constexpr double kGainSigma = 0.05;
// Residuals count as this many robust standard deviations at most.
constexpr double kMaxSigmas = 3.0;
// Doubled log-likelihood ratio to the best offset below which an offset is possible: four standard
// deviations.
constexpr double kPossible = 16.0;

// Mean headings of a robot that turns steadily from scan to scan.
class HeadingMean {
 public:
  HeadingMean(const std::vector<double>& times_s, std::vector<double> headings)
      : times_s_(times_s), headings_(std::move(headings)), integral_(1, 0.0) {
    for (std::size_t i = 1; i < times_s_.size(); ++i) {
      integral_.push_back(integral_.back() + 0.5 * (headings_[i] + headings_[i - 1]) *
                                                 (times_s_[i] - times_s_[i - 1]));
    }
  }

  // From the mean over a window about a time to that over the window a span later.
  double Turn(double from_s, double window_s, double span_s) const {
    return (Integral(from_s + span_s + 0.5 * window_s) -
            Integral(from_s + span_s - 0.5 * window_s) - Integral(from_s + 0.5 * window_s) +
            Integral(from_s - 0.5 * window_s)) /
           window_s;
  }

 private:
  // From the first time to one between the first and the last.
  double Integral(double time_s) const {
    const auto after = std::upper_bound(times_s_.begin() + 1, times_s_.end() - 1, time_s);
    const std::size_t i = after - times_s_.begin() - 1;
    const double step_s = times_s_[i + 1] - times_s_[i], part_s = time_s - times_s_[i];
    const double rate = step_s > 0.0 ? (headings_[i + 1] - headings_[i]) / step_s : 0.0;
    return integral_[i] + (headings_[i] + 0.5 * rate * part_s) * part_s;
  }

  const std::vector<double>& times_s_;
  std::vector<double> headings_, integral_;
};

// A turn by the odometry, and what the matching says of it for every offset tried.
struct TurnSample {
  double by_odometry = 0.0;
  std::array<double, kNumTried> matched{};
};

// Median time between scans whose stamps differ [s]; 0 if stamps fall, or if too many repeat.
double PeriodOf(const std::vector<double>& times_s) {
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    const double period_s = times_s[i] - times_s[i - 1];
    if (!(period_s >= 0.0)) return 0.0;
    if (period_s > 0.0) periods_s.push_back(period_s);
  }
  const double num_steps = static_cast<double>(times_s.size()) - 1.0;
  const double num_repeated = num_steps - static_cast<double>(periods_s.size());
  if (periods_s.empty() || num_repeated > kMaxRepeatedShare * num_steps) return 0.0;
  return Median(std::move(periods_s));
}

class TurnComparison {
 public:
  TurnComparison(const std::vector<double>& times_s, double period_s,
                 const SequentialTrajectory& trajectory) {
    const double window_s = std::max(kWindowS, kMinPeriods * period_s);
    const double span_s = std::max(kSpanS, kMinPeriods * period_s);
    std::vector<double> matched = {0.0}, by_odometry = {0.0};
    for (std::size_t pose = 1; pose < times_s.size(); ++pose) {
      const std::vector<Pose2>& poses = trajectory.world_from_robot;
      matched.push_back(matched.back() + NormalizeAngle(poses[pose].yaw - poses[pose - 1].yaw));
      by_odometry.push_back(by_odometry.back() + NormalizeAngle(trajectory.odometry[pose].yaw));
    }
    const HeadingMean mean(times_s, std::move(matched)),
        of_odometry(times_s, std::move(by_odometry));
    for (const double from_s : SampleTimes(times_s, window_s, span_s)) {
      TurnSample sample;
      sample.by_odometry = of_odometry.Turn(from_s, window_s, span_s);
      for (int i = 0; i < kNumTried; ++i) {
        sample.matched[i] =
            mean.Turn(from_s + (i - kNumTriedEachWay) * kSpacingS, window_s, span_s);
      }
      samples_.push_back(sample);
    }
    num_independent_ = sampled_s_ / (window_s + span_s);
  }

  bool HasEnoughSamples() const { return samples_.size() >= kMinSamples; }

  // Minus twice the log-likelihood of every offset tried, relative to the best.
  std::array<double, kNumTried> Unlikeliness() const {
    std::array<double, kNumTried> result{};
    for (int i = 0; i < kNumTried; ++i) result[i] = std::log(MeanSquare(i));
    const double best = *std::min_element(result.begin(), result.end());
    for (double& value : result) value = num_independent_ * (value - best);
    return result;
  }

 private:
  // Times whose windows, shifted by any offset, lie within a stretch without a gap.
  std::vector<double> SampleTimes(const std::vector<double>& times_s, double window_s,
                                  double span_s) {
    const double before_s = kNumTriedEachWay * kSpacingS + 0.5 * window_s;
    const double after_s = before_s + span_s;
    std::vector<double> samples_s;
    std::size_t first = 0;
    for (std::size_t i = 1; i <= times_s.size(); ++i) {
      if (i < times_s.size() && times_s[i] - times_s[i - 1] <= kMaxGapS) continue;
      const double end_s = times_s[i - 1] - after_s;
      const double begin_s = times_s[first] + before_s;
      sampled_s_ += std::max(0.0, end_s - begin_s);
      for (int k = 0; begin_s + k * kSampleSpacingS < end_s; ++k) {
        samples_s.push_back(begin_s + k * kSampleSpacingS);
      }
      first = i;
    }
    const std::size_t stride = samples_s.size() / kMaxSamples + 1;
    std::size_t num_kept = 0;
    for (std::size_t i = 0; i < samples_s.size(); i += stride) samples_s[num_kept++] = samples_s[i];
    samples_s.resize(num_kept);
    return samples_s;
  }

  // Mean square of the residuals for the best gain of the odometry (iteratively reweighted least
  // squares, Huber loss).
  double MeanSquare(int offset) const {
    constexpr int kIterations = 3;
    double gain = 1.0, mean_square = 0.0;
    std::vector<double> residuals(samples_.size());
    for (int iteration = 0;; ++iteration) {
      for (std::size_t i = 0; i < samples_.size(); ++i) {
        residuals[i] = std::abs(samples_[i].by_odometry - gain * samples_[i].matched[offset]);
      }
      constexpr double kSigmaOfMedian = 1.4826;  // of a normal distribution
      constexpr double kLeastRad = 1e-5;
      const double gate = kMaxSigmas * std::max(kLeastRad, kSigmaOfMedian * Median(residuals));
      double sum_squares = kLeastRad * kLeastRad;
      for (const double residual : residuals) sum_squares += std::pow(std::min(residual, gate), 2);
      mean_square = sum_squares / static_cast<double>(samples_.size());
      if (iteration == kIterations) return mean_square;
      double information = mean_square / (kGainSigma * kGainSigma), weighted = 0.0;
      for (std::size_t i = 0; i < samples_.size(); ++i) {
        const double turn = samples_[i].matched[offset];
        const double weight = residuals[i] > gate ? gate / residuals[i] : 1.0;
        information += weight * turn * turn;
        weighted += weight * turn * (samples_[i].by_odometry - turn);
      }
      gain = 1.0 + weighted / information;
    }
  }

  double sampled_s_ = 0.0;
  double num_independent_ = 0.0;
  std::vector<TurnSample> samples_;
};

// Width [s] of the possible offsets on one side of the best one; negative if they reach to the end
// of those tried, or if there are others beyond impossible ones.
double PossibleWidth(const std::array<double, kNumTried>& unlikeliness, int best, int direction) {
  double width_s = -1.0;
  for (int i = best + direction; i >= 0 && i < kNumTried; i += direction) {
    const bool is_possible = unlikeliness[i] < kPossible;
    if (is_possible && width_s >= 0.0) return -1.0;
    if (is_possible || width_s >= 0.0) continue;
    // The curve is a parabola about its minimum.
    width_s = std::abs(i - best) * kSpacingS * std::sqrt(kPossible / unlikeliness[i]);
  }
  return width_s;
}

}  // namespace

ClockOffset EstimateClockOffset(const SlamGraph& graph, const SequentialTrajectory& trajectory) {
  ClockOffset offset;
  const std::vector<double>& times_s = graph.timestamps_s();
  if (times_s.size() < 3) return offset;
  const double period_s = PeriodOf(times_s);
  if (!(period_s > 0.0) || period_s > kMaxGapS) return offset;
  const TurnComparison comparison(times_s, period_s, trajectory);
  if (!comparison.HasEnoughSamples()) return offset;
  const std::array<double, kNumTried> unlikeliness = comparison.Unlikeliness();
  const int best = static_cast<int>(std::min_element(unlikeliness.begin(), unlikeliness.end()) -
                                    unlikeliness.begin());
  const double before_s = PossibleWidth(unlikeliness, best, -1);
  const double after_s = PossibleWidth(unlikeliness, best, 1);
  if (before_s < 0.0 || after_s < 0.0) return offset;
  // Both neighbours are there. The vertex of the parabola through the three:
  const double left = unlikeliness[best - 1], right = unlikeliness[best + 1];
  const double vertex = 0.5 * (left - right) / (left + right);
  const double value_s = (best - kNumTriedEachWay + vertex) * kSpacingS;
  if (std::abs(value_s) > kMaxOffsetS) return offset;
  offset.value_s = value_s;
  offset.sigma_s = std::max(before_s, after_s) / std::sqrt(kPossible);
  return offset;
}

std::vector<Pose2> OdometryInTime(const SlamGraph& graph, const std::vector<Pose2>& odometry,
                                  double offset_s) {
  if (odometry.size() < 2) return odometry;
  std::vector<Pose2> poses = {Pose2()};
  for (std::size_t pose = 1; pose < odometry.size(); ++pose) {
    poses.push_back(poses.back() * odometry[pose]);
  }
  const std::vector<double>& times_s = graph.timestamps_s();
  // Nothing before the first scan, after the last one, and in gaps.
  const auto pose_at = [&](double time_s) -> std::optional<Pose2> {
    const auto after = std::upper_bound(times_s.begin() + 1, times_s.end() - 1, time_s);
    const std::size_t from = after - times_s.begin() - 1;
    const double step_s = times_s[from + 1] - times_s[from];
    const double share = step_s > 0.0 ? (time_s - times_s[from]) / step_s : 0.0;
    if (!(share >= 0.0 && share <= 1.0 && step_s <= kMaxGapS)) return std::nullopt;
    return poses[from] * PartOfMotion(odometry[from + 1], share);
  };
  std::vector<Pose2> steps = odometry;
  for (std::size_t pose = 1; pose < odometry.size(); ++pose) {
    const std::optional<Pose2> from = pose_at(times_s[pose - 1] - offset_s);
    const std::optional<Pose2> to = pose_at(times_s[pose] - offset_s);
    if (from && to) steps[pose] = Between(*from, *to);
  }
  return steps;
}

}  // namespace plumbline
