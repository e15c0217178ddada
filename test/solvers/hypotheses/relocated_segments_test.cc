#include "plumbline/solvers/hypotheses/relocated_segments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

// Two rooms of the same shape, 12 m apart, from each of which two keyframes were taken; then two
// more from the second one, which are believed to be somewhere else.
struct CarriedRobot {
  SlamGraph graph;  // initial guesses at the true poses
  std::vector<SurfacePoints> surfaces;
  KeyframeGraph keys;

  static constexpr int kEdge = 3;
  std::vector<KeyframeGraph> Join(int num_threads = 2) const {
    ThreadPool pool(num_threads);
    return RelocateSegment(ScanSurfaces(graph, Packed(surfaces)), keys, kEdge, &pool);
  }
  Pose2 TrueStep() const { return Between(graph.InitialPose(kEdge), graph.InitialPose(kEdge + 1)); }
};

CarriedRobot MakeCarriedRobot() {
  SyntheticScene scene = Room();
  const std::size_t num_faces = scene.faces.size();
  for (std::size_t i = 0; i < num_faces; ++i) {
    Face face = scene.faces[i];
    face.a.x() += 12.0;
    face.b.x() += 12.0;
    scene.faces.push_back(face);
  }
  scene.discs.push_back({{12.0 - 2.2, -1.6}, 0.3});
  scene.range_sigma_m = 0.01;
  scene.poses = {Pose2(0.0, 0.0, 0.0),  Pose2(0.5, 0.2, 0.2),  Pose2(12.0, 0.0, 0.0),
                 Pose2(12.5, 0.2, 0.2), Pose2(12.3, 0.1, 2.0), Pose2(12.2, 0.4, 2.2)};
  CarriedRobot robot;
  robot.graph = MakeGraph(scene);
  robot.surfaces = SurfacesOf(robot.graph);
  robot.keys.keyframes.resize(scene.poses.size());
  robot.keys.sequential.resize(scene.poses.size() - 1);
  robot.keys.world_from_key = scene.poses;
  const double path_m[] = {0.0, 0.5, 12.0, 12.5, 13.0, 13.5};
  for (int k = 0; k < robot.keys.size(); ++k) {
    robot.keys.keyframes[k].pose = robot.keys.keyframes[k].scan = k;
    robot.keys.keyframes[k].path_m = path_m[k];
    if (k > CarriedRobot::kEdge) {
      robot.keys.world_from_key[k] = Pose2(3.0, -4.0, 1.0) * scene.poses[k];
    }
  }
  for (int k = 0; k + 1 < robot.keys.size(); ++k) {
    robot.keys.sequential[k].constraint.from = k;
    robot.keys.sequential[k].constraint.to = k + 1;
  }
  return robot;
}

TEST(PartJoins, FindTheTruePlaceAndItsDouble) {
  const CarriedRobot robot = MakeCarriedRobot();
  const std::vector<KeyframeGraph> joins = robot.Join();
  ASSERT_GE(joins.size(), 2u);  // walls alone fit elsewhere as well, but less
  bool found_true = false, found_double = false;
  for (int i = 0; i < 2; ++i) {
    const Pose2 off = Between(robot.TrueStep(), StepAt(CarriedRobot::kEdge, joins[i]));
    const double off_m = std::hypot(off.x, off.y);
    EXPECT_NEAR(off.yaw, 0.0, 0.01);
    found_true = found_true || off_m < 0.03;
    found_double = found_double || std::abs(off_m - 12.0) < 0.03;
  }
  EXPECT_TRUE(found_true);
  EXPECT_TRUE(found_double);
  EXPECT_FALSE(IsSameRelocation(CarriedRobot::kEdge, joins[0], joins[1]));
}

TEST(PartJoins, ReplaceWhatWasAcrossTheEdge) {
  CarriedRobot robot = MakeCarriedRobot();
  const Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  robot.keys.closures = {{0, 2, Pose2(), covariance}, {1, 5, Pose2(), covariance}};
  robot.keys.contradicted = {{0, 4, Pose2(), covariance}};
  robot.keys.refused = {{4, 5, Pose2(), covariance}};
  const std::vector<KeyframeGraph> joins = robot.Join();
  ASSERT_FALSE(joins.empty());
  for (const KeyframeGraph& join : joins) {
    EXPECT_TRUE(join.sequential[CarriedRobot::kEdge].broken);
    ASSERT_EQ(join.closures.size(), 2u);
    EXPECT_EQ(join.closures[0].to, 2);
    EXPECT_GT(join.closures[1].to, CarriedRobot::kEdge);
    EXPECT_LE(join.closures[1].from, CarriedRobot::kEdge);
    EXPECT_TRUE(join.contradicted.empty());
    EXPECT_EQ(join.refused.size(), 1u);
    // What lies beyond the edge is moved in one piece.
    EXPECT_LT(DistanceM(Between(join.world_from_key[4], join.world_from_key[5]),
                        Between(robot.keys.world_from_key[4], robot.keys.world_from_key[5])),
              1e-9);
  }
}

TEST(PartJoins, AreTheSameForAnyNumberOfThreads) {
  const CarriedRobot robot = MakeCarriedRobot();
  const std::vector<KeyframeGraph> one = robot.Join(1), three = robot.Join(3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].world_from_key[5].x, three[i].world_from_key[5].x);
  }
}

TEST(PartJoins, NothingFitsNowhere) {
  CarriedRobot robot = MakeCarriedRobot();
  robot.surfaces[4].clear();
  robot.surfaces[5].clear();
  EXPECT_TRUE(robot.Join().empty());
}

TEST(PartJoins, OtherSessionsStayWhereTheyAre) {
  CarriedRobot robot = MakeCarriedRobot();
  robot.keys.sequential[4].between_sessions = robot.keys.sequential[4].broken = true;
  robot.keys.closures = {{1, 5, Pose2(), Eigen::Matrix3d::Identity()}};
  const std::vector<KeyframeGraph> joins = robot.Join();
  ASSERT_FALSE(joins.empty());
  for (const KeyframeGraph& join : joins) {
    EXPECT_EQ(DistanceM(join.world_from_key[5], robot.keys.world_from_key[5]), 0.0);
    EXPECT_GT(DistanceM(join.world_from_key[4], robot.keys.world_from_key[4]), 1.0);
    ASSERT_EQ(join.closures.size(), 2u);
    EXPECT_EQ(join.closures[0].to, 5);
    EXPECT_EQ(join.closures[1].to, 4);
  }
}

TEST(ComparedOfLesserPart, IsWhatOtherPassesMeetOfIt) {
  MapConsistency consistency;
  for (int i = 0; i < 4; ++i) {
    ViewpointConflict viewpoint;
    viewpoint.pose = 10 * i;
    viewpoint.within_pass = {1000, 0};
    viewpoint.between_passes = {10 + i, 0};
    consistency.viewpoints.push_back(viewpoint);
  }
  EXPECT_EQ(ComparedOfLesserPart(consistency, 30), 13);
  EXPECT_EQ(ComparedOfLesserPart(consistency, 15), 10 + 11);
  EXPECT_EQ(ComparedOfLesserPart(consistency, 0), 0);
  EXPECT_EQ(ComparedOfLesserPart(MapConsistency(), 5), 0);
}

}  // namespace
}  // namespace plumbline
