#ifndef PLUMBLINE_APPS_EVALUATION_POSE_ERRORS_H_
#define PLUMBLINE_APPS_EVALUATION_POSE_ERRORS_H_

#include <cstddef>
#include <limits>
#include <vector>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// How a tool draws figures from errors; each metric keeps to the tool it is compared with.
enum class StatisticsConvention {
  kFreiburg,  ///< std over n - 1; of two middle values the median is the larger
  kEvo,       ///< std over n; of two middle values the median is the mean
};

/// Figures of a set of errors, in the errors' unit; NaN if the set is empty.
struct ErrorStatistics {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double mean = kNone;
  double std = kNone;  ///< 0 for a single error
  double rmse = kNone;
  double median = kNone;
  double p95 =
      kNone;  ///< the error at place floor(0.95 (n - 1)), counted from 0, of the sorted set
  double max = kNone;
};

ErrorStatistics Summarise(std::vector<double> errors, StatisticsConvention convention);

/// Figures of one metric over its relations, poses or steps.
struct PoseErrorStatistics {
  std::size_t num_matched = 0;
  std::size_t num_unmatched = 0;  ///< left out, as a pose that they need is missing
  ErrorStatistics translation_m;
  ErrorStatistics rotation_deg;
};

/// Collects the differences of pairs of poses.
class PoseErrors {
 public:
  explicit PoseErrors(StatisticsConvention convention) : convention_(convention) {}

  /// The motion from one to the other: its length, and its rotation without sign.
  void Add(const Pose2& expected, const Pose2& actual);
  void AddUnmatched() { ++num_unmatched_; }
  /// Adds all poses of an estimate, after the rigid motion that fits it to the truth best. The two
  /// are paired by index.
  void AddFitted(const std::vector<Pose2>& truth, const std::vector<Pose2>& estimate);

  PoseErrorStatistics Statistics() const;

 private:
  StatisticsConvention convention_;
  std::size_t num_unmatched_ = 0;
  std::vector<double> translations_m_;
  std::vector<double> rotations_deg_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_POSE_ERRORS_H_
