#include "plumbline/apps/benchmark/mapper_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// Three times around a circle of 20 m.
std::vector<Pose2> Laps() {
  std::vector<Pose2> poses;
  for (int i = 0; i < 600; ++i) {
    const double turn = 2.0 * kPi * i / 200.0;
    poses.emplace_back(3.2 * std::cos(turn), 3.2 * std::sin(turn), turn + 0.5 * kPi);
  }
  return poses;
}

struct Counts {
  int steps = 0, closures = 0, false_edges = 0, longest_run = 0;
};

// Checks every edge against the truth.
Counts Check(FalseClosures kind, double share) {
  const std::vector<Pose2> truth = Laps();
  NoiseSource source(3, 1);
  const MapperEdges mapper = MakeMapperEdges(truth, kind, share, &source);
  EXPECT_EQ(mapper.edges.size(), mapper.is_false.size());
  Counts counts;
  int run = 0;
  for (std::size_t i = 0; i < mapper.edges.size(); ++i) {
    const RelativePoseConstraint& edge = mapper.edges[i];
    const Pose2 error = Between(Between(truth[edge.from], truth[edge.to]), edge.from_from_to);
    const double sigma_m = std::sqrt(edge.covariance(0, 0));
    ++(edge.to - edge.from == 1 ? counts.steps : counts.closures);
    run = mapper.is_false[i] ? run + 1 : 0;
    counts.longest_run = std::max(counts.longest_run, run);
    counts.false_edges += mapper.is_false[i] ? 1 : 0;
    if (!mapper.is_false[i]) {
      EXPECT_LT(std::hypot(error.x, error.y), 5.0 * sigma_m);
    } else if (kind == FalseClosures::kBiased) {
      EXPECT_NEAR(std::abs(error.x), 0.3, 0.2 + 5.0 * sigma_m);
      EXPECT_LT(std::abs(error.y), 5.0 * sigma_m);
    }
  }
  return counts;
}

TEST(MapperEdgesTest, JoinEveryPoseToTheNextAndToThePassBefore) {
  const Counts counts = Check(FalseClosures::kGross, 0.0);
  EXPECT_EQ(counts.steps, 599);
  EXPECT_NEAR(counts.closures, 400, 15);
  EXPECT_EQ(counts.false_edges, 0);
}

TEST(MapperEdgesTest, AShareOfTheClosuresIsFalse) {
  const Counts gross = Check(FalseClosures::kGross, 0.3);
  EXPECT_NEAR(gross.false_edges, 0.3 * gross.closures, 0.1 * gross.closures);
  EXPECT_LT(gross.longest_run, 10);
  const Counts biased = Check(FalseClosures::kBiased, 0.3);
  EXPECT_NEAR(biased.false_edges, 0.3 * biased.closures, 0.12 * biased.closures);
  EXPECT_GE(biased.longest_run, 10);
}

}  // namespace
}  // namespace plumbline
