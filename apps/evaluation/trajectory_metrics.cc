#include "plumbline/apps/evaluation/trajectory_metrics.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

// Poses of the same times, paired by index.
struct PosePairs {
  std::vector<Pose2> estimate, truth;
  std::size_t num_unmatched = 0;
};

PosePairs PairByTime(const PoseTimeline& estimate, const PoseTimeline& truth,
                     double max_time_difference_s) {
  const bool from_truth = estimate.poses().size() > truth.poses().size();
  PosePairs pairs;
  for (const TimedPose& pose : (from_truth ? truth : estimate).poses()) {
    const TimedPose* nearest =
        (from_truth ? estimate : truth).Nearest(pose.timestamp_s, max_time_difference_s);
    if (nearest == nullptr) {
      ++pairs.num_unmatched;
      continue;
    }
    pairs.estimate.push_back((from_truth ? *nearest : pose).world_from_robot);
    pairs.truth.push_back((from_truth ? pose : *nearest).world_from_robot);
  }
  return pairs;
}

// As many poses, of the same times one by one.
PosePairs PairByOrder(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                      bool clock_is_useless) {
  std::vector<std::size_t> order(estimate.size());
  std::iota(order.begin(), order.end(), 0);
  if (!clock_is_useless) {
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return estimate[a].timestamp_s < estimate[b].timestamp_s;
    });
  }
  PosePairs pairs;
  for (const std::size_t i : order) {
    pairs.estimate.push_back(estimate[i].world_from_robot);
    pairs.truth.push_back(truth[i].world_from_robot);
  }
  return pairs;
}

PoseErrorStatistics AbsoluteErrors(const PosePairs& pairs) {
  PoseErrors errors(StatisticsConvention::kEvo);
  for (std::size_t i = 0; i < pairs.num_unmatched; ++i) errors.AddUnmatched();
  errors.AddFitted(pairs.truth, pairs.estimate);
  return errors.Statistics();
}

// From each of these places to the next.
PoseErrorStatistics RelativeErrors(const PosePairs& pairs, const std::vector<std::size_t>& places) {
  PoseErrors errors(StatisticsConvention::kEvo);
  for (std::size_t k = 1; k < places.size(); ++k) {
    const std::size_t from = places[k - 1], to = places[k];
    errors.Add(Between(pairs.truth[from], pairs.truth[to]),
               Between(pairs.estimate[from], pairs.estimate[to]));
  }
  return errors.Statistics();
}

std::vector<std::size_t> PlacesByFrames(std::size_t num_pairs, int delta_frames) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < num_pairs; i += delta_frames) places.push_back(i);
  return places;
}

std::vector<std::size_t> PlacesByPath(const std::vector<Pose2>& poses, double delta_m) {
  std::vector<std::size_t> places;
  double path_m = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    path_m += (poses[i].translation() - poses[i - 1].translation()).norm();
    if (path_m < delta_m) continue;
    places.push_back(i);
    path_m = 0.0;
  }
  return places;
}

}  // namespace

bool TrajectoryMetricsOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(max_time_difference_s, 0.0, 3600.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(delta_frames, 1, 1000000000);
  PLUMBLINE_CHECK_OPTION_WITHIN(delta_m, 1e-6, 1e7);
  return true;
}

TrajectoryMetrics MeasureTrajectory(const std::vector<TimedPose>& estimate,
                                    const std::vector<TimedPose>& truth,
                                    const TrajectoryMetricsOptions& options,
                                    const Pairing& pairing) {
  const PosePairs pairs = pairing.by_order ? PairByOrder(estimate, truth, pairing.clock_is_useless)
                                           : PairByTime(PoseTimeline(estimate), PoseTimeline(truth),
                                                        options.max_time_difference_s);
  return {AbsoluteErrors(pairs),
          RelativeErrors(pairs, PlacesByFrames(pairs.estimate.size(), options.delta_frames)),
          RelativeErrors(pairs, PlacesByPath(pairs.estimate, options.delta_m))};
}

}  // namespace plumbline
