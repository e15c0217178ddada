#include "plumbline/solvers/loop_closure/suspect_edges.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

constexpr int kPosesPerKey = 3;

// A lap of radius 1 m round the room, 10 cm a step.
SyntheticScene LapOfTheRoom() {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  for (int i = 0; i <= 60; ++i) {
    const double angle = 0.1 * i;
    scene.poses.emplace_back(std::cos(angle), std::sin(angle), angle + 0.5 * kPi);
  }
  return scene;
}

// The lap as matched, if all poses from first_moved on are believed to be `error` off.
struct MatchedLap {
  MatchedLap(int first_moved, const Pose2& error)
      : graph(MakeGraph(LapOfTheRoom())), surfaces(SurfacesOf(graph)), poses(LapOfTheRoom().poses) {
    for (std::size_t p = first_moved; p < poses.size(); ++p) poses[p] = error * poses[p];
    for (int pose = 0; pose < graph.num_poses(); pose += kPosesPerKey) {
      Keyframe key;
      key.pose = key.scan = pose;
      keys.keyframes.push_back(key);
      keys.world_from_key.push_back(poses[pose]);
    }
    keys.sequential.resize(keys.size() - 1);
  }

  SlamGraph graph;
  std::vector<SurfacePoints> surfaces;
  std::vector<Pose2> poses;
  KeyframeGraph keys;
};

std::vector<SequentialEdge> EdgesOfLap(int first_moved, const Pose2& error) {
  MatchedLap lap(first_moved, error);
  ThreadPool pool(2);
  MarkSuspectEdges(ScanSurfaces(lap.graph, Packed(lap.surfaces)), lap.poses, &pool, &lap.keys);
  return lap.keys.sequential;
}

int NumSuspect(const std::vector<SequentialEdge>& edges) {
  return static_cast<int>(std::count_if(
      edges.begin(), edges.end(), [](const SequentialEdge& edge) { return edge.evidence > 0.0; }));
}

TEST(SuspectEdges, ASoundDriveHasNone) { EXPECT_EQ(NumSuspect(EdgesOfLap(0, Pose2())), 0); }

TEST(SuspectEdges, WhatTheMatchingLeavesIsNotSuspect) {
  EXPECT_EQ(NumSuspect(EdgesOfLap(31, Pose2(0.04, -0.03, 0.01))), 0);
}

TEST(SuspectEdges, TheRestOfThePathMovedMakesOne) {
  // Keyframes every third pose: poses 30 and 33 are the ends of edge 10.
  for (const int first_moved : {31, 32, 33}) {
    const std::vector<SequentialEdge> edges = EdgesOfLap(first_moved, Pose2(0.8, 0.5, 0.2));
    EXPECT_EQ(NumSuspect(edges), 1);
    EXPECT_GE(edges[10].evidence, SuspectStep::kUntrustedEvidence);
    EXPECT_FALSE(edges[10].in_question);
    EXPECT_LE(edges[10].evidence, 1.6);
    EXPECT_FALSE(edges[10].broken);
    EXPECT_EQ(edges[10].first_pose_after, first_moved);
  }
}

TEST(SuspectEdges, TheFirstAndTheLastEdgeAreCheckedToo) {
  const std::vector<SequentialEdge> first = EdgesOfLap(1, Pose2(0.8, 0.5, 0.2));
  EXPECT_EQ(NumSuspect(first), 1);
  EXPECT_EQ(first.front().first_pose_after, 1);
  const std::vector<SequentialEdge> last = EdgesOfLap(60, Pose2(0.8, 0.5, 0.2));
  EXPECT_EQ(NumSuspect(last), 1);
  EXPECT_EQ(last.back().first_pose_after, 60);
}

TEST(SuspectEdges, TheWorstOfAStretchIsMarkedHoweverLittleItDisagrees) {
  MatchedLap lap(32, Pose2(0.1, -0.06, 0.02));
  ThreadPool pool(1);
  MarkSuspectEdges(ScanSurfaces(lap.graph, Packed(lap.surfaces)), lap.poses, &pool, &lap.keys);
  ASSERT_EQ(NumSuspect(lap.keys.sequential), 0);
  EXPECT_EQ(
      MarkWorstEdge(ScanSurfaces(lap.graph, Packed(lap.surfaces)), lap.poses, 4, 18, &lap.keys),
      10);
  EXPECT_GT(lap.keys.sequential[10].evidence, 0.0);
  EXPECT_EQ(lap.keys.sequential[10].first_pose_after, 32);
  EXPECT_EQ(NumSuspect(lap.keys.sequential), 1);
  // Edges beyond the stretch do not count.
  EXPECT_GE(
      MarkWorstEdge(ScanSurfaces(lap.graph, Packed(lap.surfaces)), lap.poses, 12, 20, &lap.keys),
      12);
  EXPECT_LT(
      MarkWorstEdge(ScanSurfaces(lap.graph, Packed(lap.surfaces)), lap.poses, 0, 8, &lap.keys), 8);
}

TEST(SuspectEdges, WhatLiesBetweenSessionsIsNotSuspect) {
  constexpr int kMoved = 31, kEdge = 9;  // the edge from pose 27 to pose 30, and the next one
  MatchedLap lap(kMoved, Pose2(0.8, 0.5, 0.3));
  for (int edge : {kEdge, kEdge + 1}) lap.keys.sequential[edge].between_sessions = true;
  ThreadPool pool(2);
  MarkSuspectEdges(ScanSurfaces(lap.graph, Packed(lap.surfaces)), lap.poses, &pool, &lap.keys);
  EXPECT_EQ(NumSuspect(lap.keys.sequential), 0);
}

}  // namespace
}  // namespace plumbline
