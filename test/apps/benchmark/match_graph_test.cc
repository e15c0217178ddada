#include "plumbline/apps/benchmark/match_graph.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plumbline/apps/benchmark/synthetic_drive.h"

namespace plumbline {
namespace {

TEST(MatchGraph, ChainsConsecutiveScansAndClosesTheLoop) {
  SyntheticDrive drive;
  ASSERT_TRUE(MakeSyntheticDrive(2, {"", 0.01, 0.002, 1.0}, &drive).ok());
  const MatchGraph matches = BuildMatchGraph(PlainIcp(drive.graph), MatchGraphOptions());
  ASSERT_EQ(matches.chain.size(), 16u);
  ASSERT_GT(matches.edges.size(), 20u);
  bool closes_the_loop = false;
  for (std::size_t i = 0; i < matches.edges.size(); ++i) {
    const RelativePoseConstraint& edge = matches.edges[i];
    if (i < 15) {
      EXPECT_EQ(edge.from, static_cast<int>(i));
      EXPECT_EQ(edge.to, edge.from + 1);
    }
    closes_the_loop = closes_the_loop || edge.to - edge.from > 8;
    const Pose2 off = Between(Between(drive.truth.poses[edge.from], drive.truth.poses[edge.to]),
                              edge.from_from_to);
    EXPECT_LT(off.translation().norm(), 0.25) << edge.from << " to " << edge.to;
    EXPECT_LT(std::abs(off.yaw), 0.06) << edge.from << " to " << edge.to;
  }
  EXPECT_TRUE(closes_the_loop);
}

TEST(MatchGraph, MatchesOnlyScansThatAreNearAndSeeTheSame) {
  SyntheticDrive drive;
  ASSERT_TRUE(MakeSyntheticDrive(2, {"", 0.01, 0.002, 1.0}, &drive).ok());
  const PlainIcp icp(drive.graph);
  MatchGraphOptions options;
  options.radius_m = 0.0;
  EXPECT_EQ(BuildMatchGraph(icp, options).edges.size(), 15u);
  options = MatchGraphOptions();
  options.min_matched_ratio = 1.01;
  EXPECT_EQ(BuildMatchGraph(icp, options).edges.size(), 15u);
}

}  // namespace
}  // namespace plumbline
