#include "plumbline/apps/evaluation/trajectory_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// Poses along the x axis, one per second.
std::vector<TimedPose> Along(const std::vector<double>& x_m) {
  std::vector<TimedPose> trajectory;
  for (const double x : x_m) {
    trajectory.push_back({static_cast<double>(trajectory.size()), {x, 0.0, 0.0}});
  }
  return trajectory;
}

TEST(TrajectoryMetricsTest, AnotherWorldFrameIsNoError) {
  std::vector<TimedPose> truth, estimate;
  for (int i = 0; i < 50; ++i) {
    truth.push_back({0.1 * i, {0.2 * i, std::sin(0.3 * i), 0.4 * i}});
    estimate.push_back({0.1 * i, Pose2(30.0, -7.0, 2.5) * truth.back().world_from_robot});
  }
  const TrajectoryMetrics metrics = MeasureTrajectory(estimate, truth, TrajectoryMetricsOptions());
  EXPECT_EQ(metrics.absolute.num_matched, 50u);
  EXPECT_NEAR(metrics.absolute.translation_m.max, 0.0, 1e-12);
  EXPECT_NEAR(metrics.absolute.rotation_deg.max, 0.0, 1e-10);
  EXPECT_EQ(metrics.relative_frames.num_matched, 49u);
  EXPECT_NEAR(metrics.relative_frames.translation_m.max, 0.0, 1e-12);
  EXPECT_NEAR(metrics.relative_frames.rotation_deg.max, 0.0, 1e-10);
  EXPECT_GT(metrics.relative_metres.num_matched, 5u);
  EXPECT_NEAR(metrics.relative_metres.translation_m.max, 0.0, 1e-12);
}

TEST(TrajectoryMetricsTest, AbsoluteErrorWorkedByHand) {
  // A cross, seen turned by 90 deg and a tenth too large: the best motion takes the turn back and
  // leaves 0.1 m in every pose. The headings are 1, -1, 2, -2 deg off on top.
  const std::vector<TimedPose> truth = {{0.0, {1.0, 0.0, 0.0}},
                                        {1.0, {0.0, 1.0, 0.0}},
                                        {2.0, {-1.0, 0.0, 0.0}},
                                        {3.0, {0.0, -1.0, 0.0}}};
  const std::vector<TimedPose> estimate = {{0.0, {5.0, 1.1, DegToRad(91.0)}},
                                           {1.0, {3.9, 0.0, DegToRad(89.0)}},
                                           {2.0, {5.0, -1.1, DegToRad(92.0)}},
                                           {3.0, {6.1, 0.0, DegToRad(88.0)}}};
  const PoseErrorStatistics absolute =
      MeasureTrajectory(estimate, truth, TrajectoryMetricsOptions()).absolute;
  EXPECT_NEAR(absolute.translation_m.mean, 0.1, 1e-12);
  EXPECT_NEAR(absolute.translation_m.std, 0.0, 1e-12);
  EXPECT_NEAR(absolute.translation_m.rmse, 0.1, 1e-12);
  EXPECT_NEAR(absolute.rotation_deg.mean, 1.5, 1e-10);
  EXPECT_NEAR(absolute.rotation_deg.std, 0.5, 1e-10);
  EXPECT_NEAR(absolute.rotation_deg.median, 1.5, 1e-10);
  EXPECT_NEAR(absolute.rotation_deg.rmse, std::sqrt(2.5), 1e-10);
  EXPECT_NEAR(absolute.rotation_deg.max, 2.0, 1e-10);
}

TEST(TrajectoryMetricsTest, RelativeErrorsWorkedByHand) {
  const std::vector<TimedPose> truth = Along({0.0, 1.0, 2.0, 3.0, 4.0});
  const std::vector<TimedPose> estimate = Along({0.0, 1.1, 2.3, 3.6, 5.0});
  TrajectoryMetricsOptions options;
  TrajectoryMetrics metrics = MeasureTrajectory(estimate, truth, options);
  EXPECT_EQ(metrics.relative_frames.num_matched, 4u);  // 0.1, 0.2, 0.3, 0.4 m
  EXPECT_NEAR(metrics.relative_frames.translation_m.mean, 0.25, 1e-12);
  EXPECT_NEAR(metrics.relative_frames.translation_m.median, 0.25, 1e-12);
  EXPECT_NEAR(metrics.relative_frames.translation_m.rmse, std::sqrt(0.075), 1e-12);
  EXPECT_NEAR(metrics.relative_frames.translation_m.max, 0.4, 1e-12);
  EXPECT_EQ(metrics.relative_metres.num_matched, 3u);  // from the first metre on: 1, 2, 3, 4
  EXPECT_NEAR(metrics.relative_metres.translation_m.mean, 0.3, 1e-12);

  options.delta_frames = 2;
  options.delta_m = 2.0;
  metrics = MeasureTrajectory(estimate, truth, options);
  EXPECT_EQ(metrics.relative_frames.num_matched, 2u);  // 0.3 and 0.7 m
  EXPECT_NEAR(metrics.relative_frames.translation_m.mean, 0.5, 1e-12);
  EXPECT_EQ(metrics.relative_metres.num_matched, 1u);  // from 2.3 m to 5.0 m
  EXPECT_NEAR(metrics.relative_metres.translation_m.mean, 0.7, 1e-12);
}

TEST(TrajectoryMetricsTest, PairsThePosesNearestInTime) {
  const std::vector<TimedPose> truth = {{0.0, {0.0, 0.0, 0.0}},   {0.006, {9.0, 9.0, 0.0}},
                                        {1.0, {1.0, 0.0, 0.0}},   {2.02, {7.0, 7.0, 0.0}},
                                        {2.995, {3.0, 0.0, 0.0}}, {9.0, {5.0, 5.0, 0.0}}};
  std::vector<TimedPose> estimate = Along({0.0, 1.0, 2.0, 3.0});
  TrajectoryMetricsOptions options;
  TrajectoryMetrics metrics = MeasureTrajectory(estimate, truth, options);
  EXPECT_EQ(metrics.absolute.num_matched, 3u);
  EXPECT_EQ(metrics.absolute.num_unmatched, 1u);
  EXPECT_NEAR(metrics.absolute.translation_m.max, 0.0, 1e-12);
  // The shorter trajectory pairs with the longer one whichever is the truth.
  metrics = MeasureTrajectory(truth, estimate, options);
  EXPECT_EQ(metrics.absolute.num_matched, 3u);
  EXPECT_EQ(metrics.absolute.num_unmatched, 1u);
  EXPECT_NEAR(metrics.absolute.translation_m.max, 0.0, 1e-12);
  options.max_time_difference_s = 0.03;
  EXPECT_EQ(MeasureTrajectory(estimate, truth, options).absolute.num_matched, 4u);
}

TEST(TrajectoryMetricsTest, PairsByOrderWhereTimesDoNotTell) {
  std::vector<TimedPose> estimate = Along({0.0, 1.0, 3.0, 2.0});
  for (TimedPose& pose : estimate) pose.timestamp_s = 7.0;
  const TrajectoryMetricsOptions options;
  const TrajectoryMetrics metrics = MeasureTrajectory(estimate, estimate, options, {true, true});
  EXPECT_EQ(metrics.absolute.num_matched, 4u);
  EXPECT_NEAR(metrics.absolute.translation_m.max, 0.0, 1e-12);
  EXPECT_EQ(metrics.relative_frames.num_matched, 3u);
}

TEST(TrajectoryMetricsTest, StepsGoInOrderOfTimeAlsoIfPairsDoNot) {
  std::vector<TimedPose> estimate = Along({0.0, 1.0, 2.5, 3.0}), truth = Along({0, 1, 2, 3});
  const TrajectoryMetricsOptions options;
  const double in_order =
      MeasureTrajectory(estimate, truth, options).relative_frames.translation_m.mean;
  std::swap(estimate[0], estimate[2]);
  std::swap(truth[0], truth[2]);
  for (const bool by_order : {false, true}) {
    const TrajectoryMetrics metrics =
        MeasureTrajectory(estimate, truth, options, {by_order, false});
    EXPECT_NEAR(metrics.relative_frames.translation_m.mean, in_order, 1e-12);
  }
}

TEST(TrajectoryMetricsTest, WithoutACommonTimeThereAreNoFigures) {
  const TrajectoryMetrics metrics =
      MeasureTrajectory(Along({0.0, 1.0}), {{77.0, {0.0, 0.0, 0.0}}}, TrajectoryMetricsOptions());
  EXPECT_EQ(metrics.absolute.num_matched, 0u);
  EXPECT_EQ(metrics.absolute.num_unmatched, 1u);
  EXPECT_EQ(metrics.relative_frames.num_matched, 0u);
  EXPECT_TRUE(std::isnan(metrics.absolute.translation_m.rmse));
}

TEST(TrajectoryMetricsTest, OptionsOutOfRangeAreNamed) {
  std::string error;
  TrajectoryMetricsOptions options;
  EXPECT_TRUE(options.Check(&error));
  options.delta_frames = 0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_EQ(error, "delta_frames = 0, but it must be >= 1");
  options = TrajectoryMetricsOptions();
  options.delta_m = 0.0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_EQ(error, "delta_m = 0, but it must be >= 1e-6");
}

}  // namespace
}  // namespace plumbline
