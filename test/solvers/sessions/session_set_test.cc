#include "plumbline/solvers/sessions/session_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

void ExpectNear(const Pose2& actual, const Pose2& expected) {
  const Pose2 apart = Between(expected, actual);
  EXPECT_LT(apart.translation().norm(), 1e-9);
  EXPECT_LT(std::abs(apart.yaw), 1e-9);
}

// Three poses in a room, each of them a keyframe, with a closure from the first to the last.
struct Session {
  SlamGraph graph;
  SeededDrive drive;
};

Session MakeSession(const Pose2& moved) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(0.0, 0.0, 0.0), Pose2(0.5, 0.2, 0.2), Pose2(0.2, 0.5, 1.0)};
  Session session;
  const SlamGraph true_graph = MakeGraph(scene);
  for (int pose = 0; pose < 3; ++pose) {
    session.graph.AddPose(moved * scene.poses[pose], true_graph.timestamp_s(pose));
    session.graph.AddScanOf(true_graph, pose, pose);
  }
  AddOdometry([](const Pose2& step) { return step; }, &session.graph);
  session.drive.surfaces = Packed(SurfacesOf(session.graph));
  for (int pose = 0; pose < 3; ++pose) {
    const Pose2 at = moved * scene.poses[pose];
    session.drive.world_from_robot.push_back(at);
    session.drive.matched.world_from_robot.push_back(at);
    session.drive.matched.odometry.push_back(
        pose == 0 ? Pose2() : session.graph.odometry()[pose - 1].from_from_to);
    Keyframe key;
    key.pose = key.scan = pose;
    key.path_m = 0.5 * pose;
    key.information = 1e4 * Eigen::Matrix3d::Identity();
    session.drive.matched.keyframes.push_back(key);
    session.drive.keys.keyframes.push_back(key);
    session.drive.keys.world_from_key.push_back(at);
  }
  session.drive.keys.sequential.resize(2);
  for (int k = 0; k < 2; ++k) {
    session.drive.keys.sequential[k].constraint.from = k;
    session.drive.keys.sequential[k].constraint.to = k + 1;
  }
  RelativePoseConstraint closure;
  closure.from = 0;
  closure.to = 2;
  session.drive.keys.closures.push_back(closure);
  return session;
}

void AddTwoSessions(SessionSet* set) {
  for (const Pose2& moved : {Pose2(), Pose2(3.0, -2.0, 1.0)}) {
    Session session = MakeSession(moved);
    EXPECT_TRUE(AddSession(session.graph, std::move(session.drive), set).ok());
  }
}

TEST(SessionSetTest, SessionsLieSideBySide) {
  SessionSet set;
  AddTwoSessions(&set);
  EXPECT_EQ(set.size(), 2);
  EXPECT_THAT(set.first_pose, ElementsAre(0, 3, 6));
  EXPECT_THAT(set.first_scan, ElementsAre(0, 3, 6));
  EXPECT_EQ(set.graph.num_poses(), 6);
  EXPECT_THAT(set.graph.odometry(), SizeIs(4));
  EXPECT_EQ(set.graph.odometry()[2].from, 3);
  EXPECT_THAT(set.surfaces.kept(), SizeIs(6));
  EXPECT_EQ(set.keys[1].keyframes[0].pose, 3);
  EXPECT_EQ(set.keys[1].keyframes[0].scan, 3);
}

TEST(SessionSetTest, ConcatenationMovesAndRenumbersTheSecondGroup) {
  SessionSet set;
  AddTwoSessions(&set);
  const Pose2 a_from_b(1.0, 2.0, 0.5);
  const SessionGroup group = Concatenated(GroupOfOne(set, 0), GroupOfOne(set, 1), a_from_b);
  EXPECT_THAT(group.sessions, ElementsAre(0, 1));
  EXPECT_THAT(group.first_key, ElementsAre(0, 3, 6));
  ExpectNear(group.keys.world_from_key[4], a_from_b * set.keys[1].world_from_key[1]);
  ASSERT_THAT(group.keys.closures, SizeIs(2));
  EXPECT_EQ(group.keys.closures[1].from, 3);
  EXPECT_EQ(group.keys.closures[1].to, 5);
  EXPECT_TRUE(group.keys.sequential[2].between_sessions);
  EXPECT_TRUE(group.keys.sequential[2].broken);
  EXPECT_EQ(group.keys.sequential[3].constraint.from, 3);
  EXPECT_FALSE(group.keys.sequential[3].between_sessions);
  EXPECT_GT(group.keys.keyframes[3].path_m, group.keys.keyframes[2].path_m + 10.0);
  EXPECT_EQ(group.keys.BeginOfSession(4), 3);
  EXPECT_EQ(group.keys.EndOfSession(1), 3);
  EXPECT_EQ(group.keys.EndOfSession(4), 6);
}

TEST(SessionSetTest, AJoinedDriveHasTheGroupsClosuresBetweenSessionsAlone) {
  SessionSet set;
  AddTwoSessions(&set);
  const Pose2 a_from_b(1.0, 2.0, 0.5);
  SessionGroup group = Concatenated(GroupOfOne(set, 0), GroupOfOne(set, 1), a_from_b);
  RelativePoseConstraint across;
  across.from = 1;
  across.to = 4;
  group.keys.closures.push_back(across);
  JoinedDrive joined;
  ASSERT_TRUE(JoinDrives(set, group, MotionOptions(), &joined).ok());
  ASSERT_THAT(joined.ties.closures, SizeIs(1));
  EXPECT_EQ(joined.ties.closures[0].to, 4);
  EXPECT_THAT(joined.first_pose, ElementsAre(0, 3, 6));
  EXPECT_THAT(joined.graph.odometry(), SizeIs(4));
  EXPECT_THAT(joined.surfaces, SizeIs(6));
  EXPECT_TRUE(joined.ties.sequential[2].between_sessions);
  EXPECT_EQ(joined.ties.sequential[2].first_pose_after, 3);
  for (int pose = 0; pose < 3; ++pose) {
    ExpectNear(joined.matched.world_from_robot[3 + pose],
               a_from_b * set.matched[1].world_from_robot[pose]);
  }
}

}  // namespace
}  // namespace plumbline
