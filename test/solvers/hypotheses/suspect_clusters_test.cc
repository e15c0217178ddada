#include "plumbline/solvers/hypotheses/suspect_clusters.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

// Along a line and back again, 2 m apart; closures between keyframes that lie at the same place.
KeyframeGraph ThereAndBack() {
  KeyframeGraph keys;
  for (int k = 0; k < 80; ++k) {
    Keyframe key;
    key.pose = key.scan = k;
    key.path_m = 2.0 * k;
    keys.keyframes.push_back(key);
    keys.world_from_key.emplace_back(k < 40 ? 2.0 * k : 2.0 * (79 - k), 0.0, 0.0);
  }
  for (const int second : {45, 46, 74, 75}) {
    keys.closures.push_back({79 - second, second, Pose2(), Eigen::Matrix3d::Identity()});
  }
  return keys;
}

MapConsistency ConflictsAt(int pose, int num_conflicting) {
  MapConsistency consistency;
  for (int k = 0; k < 80; ++k) {
    ViewpointConflict viewpoint;
    viewpoint.pose = k;
    viewpoint.between_passes.num_compared = 100;
    viewpoint.between_passes.num_conflicting = k == pose ? num_conflicting : 0;
    consistency.viewpoints.push_back(viewpoint);
  }
  return consistency;
}

TEST(SuspectClusters, AreThoseWithConflictsAroundThem) {
  const auto suspects = SuspectClusters(ThereAndBack(), ConflictsAt(77, 5000), 0.06);
  ASSERT_EQ(suspects.size(), 1u);
  ASSERT_EQ(suspects[0].size(), 2u);
  EXPECT_EQ(suspects[0][0].to, 74);
  EXPECT_EQ(suspects[0][1].to, 75);
  EXPECT_TRUE(SuspectClusters(ThereAndBack(), ConflictsAt(77, 5), 0.06).empty());
}

TEST(SuspectClusters, AndThoseThatStrainTheGraph) {
  KeyframeGraph keys = ThereAndBack();
  keys.closures[0].from_from_to = Pose2(5.0, 0.0, 0.0);  // five standard deviations
  const auto suspects = SuspectClusters(keys, ConflictsAt(77, 5000), 0.06);
  ASSERT_EQ(suspects.size(), 2u);
  EXPECT_EQ(suspects[0][0].to, 74);
  EXPECT_EQ(suspects[1][0].to, 45);
}

TEST(SuspectClusters, AreNoneWithoutClosures) {
  KeyframeGraph keys = ThereAndBack();
  keys.closures.clear();
  EXPECT_TRUE(SuspectClusters(keys, ConflictsAt(77, 5000), 0.06).empty());
}

}  // namespace
}  // namespace plumbline
