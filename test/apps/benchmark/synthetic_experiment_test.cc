#include "plumbline/apps/benchmark/synthetic_experiment.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// Of the published method, which takes its time.
MapLogOptions FewPasses() {
  MapLogOptions options;
  options.solver.published.max_passes = 2;
  return options;
}

const SyntheticNoise kNoise{"30 mm", 0.03, 0.0017, 1.0};

TEST(SyntheticExperiment, CountsFailuresAndKeepsThem) {
  std::vector<SyntheticOutcome> outcomes(3);
  const double means_m[] = {0.01, 0.02, 4.0}, largest_m[] = {0.02, 0.5, 9.0};
  for (int i = 0; i < 3; ++i) {
    outcomes[i].mapper = Mapper::kPlumbline;
    outcomes[i].pose_m.mean = means_m[i];
    outcomes[i].max_pose_m = largest_m[i];
  }
  std::vector<SyntheticSummary> summaries = SummariseOutcomes(outcomes);
  ASSERT_EQ(summaries.size(), 1u);
  EXPECT_EQ(summaries[0].num_runs, 3);
  EXPECT_EQ(summaries[0].num_failures, 1);
  EXPECT_DOUBLE_EQ(summaries[0].pose_mean_m.median, 0.02);
  EXPECT_DOUBLE_EQ(summaries[0].pose_mean_m.high, 2.01);
  outcomes[0].max_pose_m = std::nan("");  // a map that is not one
  EXPECT_EQ(SummariseOutcomes(outcomes)[0].num_failures, 2);
}

TEST(SyntheticExperiment, TheJointEstimateIsBetterThanMatchingScans) {
  ThreadPool pool(2);
  std::vector<SyntheticOutcome> outcomes;
  constexpr int kNumSeeds = 9;
  ASSERT_TRUE(RunSyntheticExperiment(kNumSeeds, {kNoise}, FewPasses(), &pool, &outcomes).ok());
  ASSERT_EQ(outcomes.size(), static_cast<std::size_t>(kNumSeeds * kNumMappers));
  const std::vector<SyntheticSummary> summaries = SummariseOutcomes(outcomes);
  const auto of = [&](Mapper mapper) { return summaries[static_cast<int>(mapper)]; };
  const SyntheticSummary joint = of(Mapper::kPlumbline);
  EXPECT_EQ(joint.num_failures, 0);
  EXPECT_LT(joint.pose_mean_m.median, 0.1 * of(Mapper::kOlson).pose_mean_m.median);
  EXPECT_LT(joint.pose_mean_m.median, 0.55 * of(Mapper::kSeed).pose_mean_m.median);
  EXPECT_LT(joint.point_mean_m.median, 0.6 * of(Mapper::kTruePoses).point_mean_m.median);
  EXPECT_LT(joint.point_mean_m.median, 0.75 * of(Mapper::kSeed).point_mean_m.median);
  EXPECT_LT(of(Mapper::kKnownWalls).pose_mean_m.median, joint.pose_mean_m.median);
  // The baselines err as in the paper, 0.597 / 0.702 m and 0.088 / 0.115 m.
  EXPECT_NEAR(of(Mapper::kPlainIcp).pose_mean_m.median, 0.597, 0.15);
  EXPECT_NEAR(of(Mapper::kPlainIcp).point_mean_m.median, 0.702, 0.15);
  EXPECT_NEAR(of(Mapper::kOlson).pose_mean_m.median, 0.088, 0.02);
  EXPECT_NEAR(of(Mapper::kOlson).point_mean_m.median, 0.115, 0.03);
  // Its method starts at the ICP over all scans, which it improves.
  EXPECT_LT(of(Mapper::kPublishedStart).pose_mean_m.median, 0.035);
  EXPECT_LT(of(Mapper::kPublished).pose_mean_m.median, 0.035);
  EXPECT_LT(of(Mapper::kPublished).point_mean_m.median,
            of(Mapper::kPublishedStart).point_mean_m.median);
  EXPECT_EQ(of(Mapper::kOdometry).num_failures, kNumSeeds);
  EXPECT_EQ(of(Mapper::kTruePoses).pose_mean_m.high, 0.0);
}

TEST(SyntheticExperiment, IsTheSameOnAnyNumberOfThreads) {
  std::vector<SyntheticOutcome> expected, outcomes;
  ThreadPool one(1), three(3);
  ASSERT_TRUE(RunSyntheticExperiment(2, {kNoise}, FewPasses(), &one, &expected).ok());
  ASSERT_TRUE(RunSyntheticExperiment(2, {kNoise}, FewPasses(), &three, &outcomes).ok());
  ASSERT_EQ(outcomes.size(), expected.size());
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    EXPECT_EQ(outcomes[i].seed, expected[i].seed);
    EXPECT_EQ(outcomes[i].pose_errors_m, expected[i].pose_errors_m);
    EXPECT_EQ(outcomes[i].point_m.mean, expected[i].point_m.mean);
  }
}

TEST(SyntheticExperiment, TheMedianSeedIsOfOneMapperAtOneNoise) {
  std::vector<SyntheticOutcome> outcomes;
  const auto add = [&outcomes](std::uint64_t seed, int noise, Mapper mapper, double pose_m) {
    SyntheticOutcome outcome;
    outcome.seed = seed;
    outcome.noise = noise;
    outcome.mapper = mapper;
    outcome.pose_m.mean = pose_m;
    outcomes.push_back(outcome);
  };
  add(1, 0, Mapper::kOlson, 0.3);
  add(2, 0, Mapper::kOlson, 0.1);
  add(3, 0, Mapper::kOlson, 0.2);
  add(4, 1, Mapper::kOlson, 0.2);
  add(5, 0, Mapper::kSeed, 0.2);
  EXPECT_EQ(MedianSeed(outcomes, 0, Mapper::kOlson), 3u);
  EXPECT_EQ(MedianSeed(outcomes, 1, Mapper::kOlson), 4u);
  add(6, 0, Mapper::kOlson, 0.9);
  EXPECT_EQ(MedianSeed(outcomes, 0, Mapper::kOlson), 3u);  // the lower of two
}

TEST(SyntheticExperiment, FailsWithADriveThatFails) {
  ThreadPool pool(1);
  std::vector<SyntheticOutcome> outcomes(1);
  EXPECT_FALSE(
      RunSyntheticExperiment(1, {{"bad", -1.0, 0.002, 1.0}}, FewPasses(), &pool, &outcomes).ok());
  EXPECT_EQ(outcomes.size(), 1u);
}

}  // namespace
}  // namespace plumbline
