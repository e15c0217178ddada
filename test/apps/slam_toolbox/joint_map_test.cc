#include "plumbline/apps/slam_toolbox/joint_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr double kNoReturn = std::numeric_limits<double>::infinity();

using testing::HasSubstr;

constexpr int kFirstId = 100;  // ids are the mapper's: neither from 0 nor without gaps

Eigen::Matrix3d Covariance(double sigma) {
  return Eigen::Vector3d::Constant(sigma * sigma).asDiagonal();
}

// The drive through the room, from poses that are a few centimetres off; `place` moves it
// elsewhere.
void AddRoom(const NoisyRoom& room, int first_id, const Pose2& place, JointMap* map) {
  RandomStates random(4);
  const int num_poses = static_cast<int>(room.truth.size());
  for (int i = 0; i < num_poses; ++i) {
    const double yaw = random.Gaussian(0.03), y = random.Gaussian(0.03);
    const Pose2 off = i == 0 ? Pose2() : Pose2(random.Gaussian(0.03), y, yaw);
    const int id = first_id + 2 * i;
    ASSERT_TRUE(map->AddNode(id, place * room.truth[i] * off, 0.5 * i).ok());
    ASSERT_TRUE(
        map->SetScan(id, room.graph.LaserOfScan(i), room.graph.RangesOfScan(i, kNoReturn)).ok());
    if (i == 0) continue;
    ASSERT_TRUE(map->AddConstraint(id - 2, id, Between(room.truth[i - 1], room.truth[i]) * off,
                                   Covariance(0.05))
                    .ok());
  }
}

double WorstError(const NoisyRoom& room, int first_id, const Pose2& place, const JointMap& map) {
  double worst_m = 0.0;
  for (std::size_t i = 0; i < room.truth.size(); ++i) {
    const Pose2* pose = map.FindPose(first_id + 2 * static_cast<int>(i));
    worst_m =
        std::max(worst_m, (pose->translation() - (place * room.truth[i]).translation()).norm());
  }
  return worst_m;
}

TEST(JointMapTest, FitsNodesToConstraintsAndScans) {
  const NoisyRoom room = MakeNoisyRoom();
  JointMap map;
  AddRoom(room, kFirstId, {}, &map);
  const Pose2 first = *map.FindPose(kFirstId);
  EXPECT_GT(WorstError(room, kFirstId, {}, map), 0.03);
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_LT(WorstError(room, kFirstId, {}, map), 0.01);
  EXPECT_EQ(map.FindPose(kFirstId)->x, first.x);
  EXPECT_EQ(map.FindPose(kFirstId)->yaw, first.yaw);
  EXPECT_EQ(map.Poses().size(), room.truth.size());
}

TEST(JointMapTest, WhatContradictsTheMapIsToldOnceByItsNodes) {
  const NoisyRoom room = MakeNoisyRoom();
  JointMap map;
  AddRoom(room, kFirstId, {}, &map);
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_TRUE(map.TakeWarnings().empty());
  const int last = kFirstId + 2 * (static_cast<int>(room.truth.size()) - 1);
  for (const int from : {kFirstId, kFirstId + 2, kFirstId + 4}) {
    ASSERT_TRUE(map.AddConstraint(from, last, {1.5, -1.0, 0.3}, Covariance(0.01)).ok());
  }
  ASSERT_TRUE(map.Estimate().ok());
  const std::vector<std::string> warnings = map.TakeWarnings();
  ASSERT_EQ(warnings.size(), 4u);
  EXPECT_THAT(warnings[0],
              testing::StartsWith("constraint 100 -> " + std::to_string(last) + " is "));
  EXPECT_THAT(warnings[0], HasSubstr("its scans contradict it, it is ignored"));
  EXPECT_THAT(warnings[3], testing::StartsWith("the map may be wrong around "));
  EXPECT_THAT(warnings[3], HasSubstr("3 of 3 loop closures contradict the map, by up to "));
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_TRUE(map.TakeWarnings().empty());
}

TEST(JointMapTest, PartsThatNothingJoinsAreFittedEachForItself) {
  const NoisyRoom room = MakeNoisyRoom();
  const Pose2 elsewhere(200.0, 50.0, 1.0);
  JointMap map;
  AddRoom(room, kFirstId, {}, &map);
  AddRoom(room, kFirstId + 1, elsewhere, &map);
  const Status status = map.Estimate();
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_LT(WorstError(room, kFirstId, {}, map), 0.01);
  EXPECT_LT(WorstError(room, kFirstId + 1, elsewhere, map), 0.1);
  // One node alone, too.
  ASSERT_TRUE(map.AddNode(9, {-300.0, 0.0, 0.0}, 0.0).ok());
  ASSERT_TRUE(
      map.SetScan(9, room.graph.LaserOfScan(0), room.graph.RangesOfScan(0, kNoReturn)).ok());
  ASSERT_TRUE(map.AddNode(999, {-600.0, 0.0, 0.0}, 0.0).ok());
  ASSERT_TRUE(
      map.SetScan(999, room.graph.LaserOfScan(0), room.graph.RangesOfScan(0, kNoReturn)).ok());
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_LT(WorstError(room, kFirstId, {}, map), 0.1);
  EXPECT_NEAR(map.FindPose(999)->x, -600.0, 0.1);
}

TEST(JointMapTest, NodesWithoutScansHaveTheirConstraints) {
  JointMap map;
  EXPECT_TRUE(map.Estimate().ok());
  ASSERT_TRUE(map.AddNode(3, {}, 0.0).ok());
  ASSERT_TRUE(map.AddNode(5, {0.5, 0.0, 0.0}, 1.0).ok());
  ASSERT_TRUE(map.AddConstraint(3, 5, {1.0, 0.0, 0.1}, Covariance(0.01)).ok());
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_NEAR(map.FindPose(5)->x, 1.0, 1e-6);
  EXPECT_NEAR(map.FindPose(5)->yaw, 0.1, 1e-6);
  // What was estimated stays until something is new.
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_NEAR(map.FindPose(5)->x, 1.0, 1e-6);
  map.RemoveConstraint(5, 3);
  ASSERT_TRUE(map.MoveNode(5, {4.0, 0.0, 0.0}).ok());
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_EQ(map.FindPose(5)->x, 4.0);
  map.RemoveNode(5);
  EXPECT_EQ(map.FindPose(5), nullptr);
  EXPECT_EQ(map.Poses().size(), 1u);
  map.Clear();
  EXPECT_TRUE(map.Poses().empty());
}

TEST(JointMapTest, AKnownIdGivesWayWithItsConstraints) {
  JointMap map;
  ASSERT_TRUE(map.AddNode(1, {}, 0.0).ok());
  ASSERT_TRUE(map.AddNode(2, {}, 0.0).ok());
  ASSERT_TRUE(map.AddConstraint(1, 2, {1.0, 0.0, 0.0}, Covariance(0.01)).ok());
  ASSERT_TRUE(map.AddNode(2, {3.0, 0.0, 0.0}, 0.0).ok());
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_EQ(map.FindPose(2)->x, 3.0);
}

TEST(JointMapTest, RefusesByNameAndChangesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  JointMap map;
  ASSERT_TRUE(map.AddNode(1, {}, 0.0).ok());
  ASSERT_TRUE(map.AddNode(2, {1.0, 0.0, 0.0}, 0.0).ok());
  EXPECT_THAT(map.AddNode(2, {nan, 0.0, 0.0}, 0.0).message(), HasSubstr("node 2"));
  EXPECT_THAT(map.AddNode(3, {}, nan).message(), HasSubstr("node 3"));
  EXPECT_THAT(map.MoveNode(2, {nan, 0.0, 0.0}).message(), HasSubstr("node 2"));
  EXPECT_THAT(map.MoveNode(3, {}).message(), HasSubstr("node 3"));
  EXPECT_EQ(map.FindPose(2)->x, 1.0);
  EXPECT_EQ(map.FindPose(3), nullptr);

  const LaserModel laser = PanoramicLaser(4);
  EXPECT_THAT(map.SetScan(3, laser, {1, 1, 1, 1}).message(), HasSubstr("node 3"));
  EXPECT_THAT(map.SetScan(2, laser, {1, 1, 1}).message(), HasSubstr("node 2"));
  LaserModel bad = laser;
  bad.max_range_m = -1.0;
  EXPECT_THAT(map.SetScan(2, bad, {1, 1, 1, 1}).message(), HasSubstr("max_range_m"));

  EXPECT_THAT(map.AddConstraint(1, 3, {}, Covariance(0.1)).message(),
              HasSubstr("node 3 is not in the map"));
  EXPECT_THAT(map.AddConstraint(1, 1, {}, Covariance(0.1)).message(), HasSubstr("1 -> 1"));
  EXPECT_THAT(map.AddConstraint(1, 2, {nan, 0, 0}, Covariance(0.1)).message(), HasSubstr("1 -> 2"));
  EXPECT_THAT(map.AddConstraint(1, 2, {}, Covariance(0.0)).message(), HasSubstr("covariance"));
  ASSERT_TRUE(map.Estimate().ok());
  EXPECT_EQ(map.FindPose(2)->x, 1.0);
}

}  // namespace
}  // namespace plumbline
