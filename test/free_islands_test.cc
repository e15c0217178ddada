#include "plumbline/solvers/reduced/free_islands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Sightings as pairs of pose and patch, in order of patches.
PatchSightings SightingsOf(int num_poses, const std::vector<std::pair<int, int>>& pairs) {
  PatchSightings sightings;
  for (const auto& [pose, patch] : pairs) {
    sightings.sightings.emplace_back();
    sightings.sightings.back().pose = pose;
    sightings.sightings.back().patch = patch;
  }
  sightings.first_of_pose.resize(num_poses + 1);
  return sightings;
}

// A graph of poses with its first one fixed, and odometry between some.
PoseTerms TermsOf(int num_poses, const std::vector<std::pair<int, int>>& edges) {
  SlamGraph graph;
  int id = 0;
  for (int i = 0; i < num_poses; ++i) EXPECT_TRUE(graph.AddPose(Pose2(i, 0, 0), i, &id).ok());
  for (const auto& [from, to] : edges) {
    EXPECT_TRUE(graph.AddOdometry({from, to, Pose2(to - from, 0, 0)}).ok());
  }
  return PoseTerms(graph, FactorOptions());
}

TEST(FreeIslandsTest, EveryPoseAloneButTheFixedOneIsFree) {
  EXPECT_THAT(FindFreeIslands(SightingsOf(3, {}), TermsOf(3, {})), ElementsAre(1, 2));
}

TEST(FreeIslandsTest, TermsAndSharedPatchesHoldPosesTogether) {
  // 0-1 by odometry, 1-4 by a patch, 2-3 by another patch, 5 alone although it sees a patch.
  const PatchSightings sightings = SightingsOf(6, {{1, 0}, {4, 0}, {2, 1}, {3, 1}, {5, 2}});
  EXPECT_THAT(FindFreeIslands(sightings, TermsOf(6, {{0, 1}})), ElementsAre(2, 5));
  EXPECT_THAT(FindFreeIslands(sightings, TermsOf(6, {{0, 1}, {3, 5}, {4, 2}})), IsEmpty());
}

}  // namespace
}  // namespace plumbline
