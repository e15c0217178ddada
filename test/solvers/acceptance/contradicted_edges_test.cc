#include "plumbline/solvers/acceptance/contradicted_edges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kNumPoses = 24;

// A lap around a room; edges are added by the tests.
class ContradictedEdgesTest : public testing::Test {
 protected:
  ContradictedEdgesTest() {
    NoisyRoomOptions options;
    options.num_poses = kNumPoses;
    const NoisyRoom room = MakeNoisyRoom(options);
    truth_ = room.truth;
    for (int i = 0; i < kNumPoses; ++i) {
      graph_.AddPose(truth_[i], i);
      if (i == kBlind) continue;
      graph_.AddScanOf(room.graph, i, i);
    }
  }

  // True but for an error in the frame of `to`.
  void AddEdge(int from, int to, const Pose2& error = Pose2(), double sigma = 0.02) {
    const Eigen::Matrix3d covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    const Pose2 motion = Between(truth_[from], truth_[to]) * error;
    graph_.AddRelativePose({from, to, motion, covariance});
  }
  void AddSteps() {
    for (int i = 1; i < kNumPoses; ++i) AddEdge(i - 1, i, {0.01, -0.01, 0.01});
  }

  std::vector<ContradictedEdge> Find(int num_threads = 1) const {
    ThreadPool pool(num_threads);
    return FindContradictedEdges(graph_, SurfaceOf(graph_), RangeBeamOptions(), &pool);
  }
  std::vector<std::size_t> Found() const {
    std::vector<std::size_t> edges;
    for (const ContradictedEdge& contradicted : Find()) edges.push_back(contradicted.edge);
    return edges;
  }

  static constexpr int kBlind = 20;  // a pose without a scan
  std::vector<Pose2> truth_;
  SlamGraph graph_;
};

TEST_F(ContradictedEdgesTest, SoundEdgesAreNot) {
  AddSteps();
  for (int i = 0; i + 8 < kNumPoses; ++i) AddEdge(i, i + 8, {0.02, 0.02, -0.02});
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(ContradictedEdgesTest, AnEdgeThatIsOffItsScansIsAndTheScansSayByHowMuch) {
  AddEdge(2, 6, {0.3, 0.0, 0.0});
  AddEdge(3, 11, {0.0, 0.0, 0.2});
  AddEdge(4, 12);
  const std::vector<ContradictedEdge> found = Find();
  ASSERT_EQ(found.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found[i].edge, i);
    ASSERT_TRUE(found[i].match);
    const Pose2 error = Between(Between(truth_[found[i].match->from], truth_[found[i].match->to]),
                                found[i].match->from_from_to);
    EXPECT_LT(error.translation().norm(), 0.02);
    EXPECT_LT(std::abs(error.yaw), 0.01);
  }
}

TEST_F(ContradictedEdgesTest, WhatAnEdgeIsNotSureOfIsNoContradiction) {
  AddEdge(2, 6, {0.3, 0.0, 0.0}, 0.3);
  EXPECT_THAT(Find(), IsEmpty());
}

// Nothing matches there, but the scans look through each other's walls.
TEST_F(ContradictedEdgesTest, AnEdgeThatIsOffByMetresIs) {
  AddSteps();
  AddEdge(2, 14, {3.0, 2.0, 1.0});
  EXPECT_THAT(Found(), ElementsAre(kNumPoses - 1));
  EXPECT_FALSE(Find()[0].match);
}

TEST_F(ContradictedEdgesTest, AStepIsOnlyIfTheScansHaveAnotherOne) {
  AddEdge(4, 5, {0.1, 0.0, 0.2});
  EXPECT_THAT(Found(), ElementsAre(0));
  AddEdge(6, 7, {3.0, 2.0, 1.5});
  AddEdge(7, 6, {3.0, 2.0, 1.5});
  EXPECT_THAT(Found(), ElementsAre(0));
}

TEST_F(ContradictedEdgesTest, APoseWithoutAScanHasNoSay) {
  AddEdge(kBlind - 1, kBlind, {1.0, 0.0, 0.5});
  AddEdge(2, kBlind, {3.0, 2.0, 1.0});
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(ContradictedEdgesTest, EdgesThatComeOneByOneAreTestedOnce) {
  ThreadPool pool(1);
  EdgeTests tests((RangeBeamOptions()));
  const auto found = [&] {
    tests.Extend(graph_, SurfaceOf(graph_), &pool);
    std::vector<std::size_t> edges;
    for (const ContradictedEdge& c : tests.Contradicted(graph_)) edges.push_back(c.edge);
    return edges;
  };
  EXPECT_THAT(found(), IsEmpty());
  AddSteps();
  EXPECT_THAT(found(), IsEmpty());
  AddEdge(2, 6, {0.3, 0.0, 0.0});
  EXPECT_THAT(found(), ElementsAre(kNumPoses - 1));
  AddEdge(4, 12);
  AddEdge(2, 14, {3.0, 2.0, 1.0});
  EXPECT_THAT(found(), ElementsAre(kNumPoses - 1, kNumPoses + 1));
  EXPECT_THAT(found(), Found());
}

// A crowd: in every scan a fifth of the beams end at people, who are gone in the next one.
TEST_F(ContradictedEdgesTest, WhatIsUsualBetweenConsecutiveScansIsNoContradiction) {
  RandomStates random(3);
  SlamGraph crowded;
  const int laser = crowded.AddLaser(graph_.laser(0));
  for (int s = 0; s < graph_.num_scans(); ++s) {
    const ScanEntry& scan = graph_.scan(s);
    std::vector<double> ranges = graph_.RangesOfScan(s, 0.0);
    for (int first = 0; first < 180; first += 10) {
      if (random.Uniform(0.0, 1.0) > 0.2) continue;
      std::fill_n(ranges.begin() + first, 10, 0.4);
    }
    const int id = crowded.AddPose(truth_[scan.pose], s);
    crowded.AddScan(id, laser, ranges);
  }
  truth_.erase(truth_.begin() + kBlind);
  graph_ = crowded;
  AddEdge(0, 8);
  EXPECT_THAT(Found(), ElementsAre(0));  // nothing tells what is usual
  for (int i = 1; i < graph_.num_poses(); ++i) AddEdge(i - 1, i);
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(ContradictedEdgesTest, TheNumberOfThreadsDoesNotCount) {
  AddSteps();
  for (int i = 0; i + 8 < kNumPoses; ++i) AddEdge(i, i + 8, {0.04 * i, 0.0, 0.0});
  const std::vector<ContradictedEdge> one = Find(1), three = Find(3);
  ASSERT_EQ(one.size(), three.size());
  EXPECT_GT(one.size(), 5u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].edge, three[i].edge);
    ASSERT_EQ(one[i].match.has_value(), three[i].match.has_value());
    if (!one[i].match) continue;
    EXPECT_EQ(one[i].match->from_from_to.x, three[i].match->from_from_to.x);
    EXPECT_EQ(one[i].match->covariance, three[i].match->covariance);
  }
}

TEST_F(ContradictedEdgesTest, ProcessesFindTogetherWhatOneFinds) {
  AddSteps();
  AddEdge(0, 12, {2.0, -1.0, 0.4});
  AddEdge(3, 21, {0.3, 0.0, 0.0});
  AddEdge(5, 17);
  const std::vector<ContradictedEdge> expected = Find();
  ASSERT_EQ(expected.size(), 2u);
  for (const int num_processes : {2, 3}) {
    RunOnParts(graph_, num_processes, [&](const SlamGraph& part) {
      ThreadPool pool(1);
      const std::vector<ContradictedEdge> found =
          FindContradictedEdges(part, SurfaceOf(part), RangeBeamOptions(), &pool);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].edge, expected[i].edge);
        ASSERT_EQ(found[i].match.has_value(), expected[i].match.has_value());
        if (!found[i].match) continue;
        EXPECT_EQ(ToBlock(found[i].match->from_from_to), ToBlock(expected[i].match->from_from_to));
        EXPECT_EQ(found[i].match->covariance, expected[i].match->covariance);
      }
    });
  }
}

TEST_F(ContradictedEdgesTest, AreDescribedByHowFarThePosesAreOffThem) {
  SlamGraph graph;
  for (const Pose2& pose : {Pose2(), Pose2(1.0, 0.0, 0.0), Pose2(1.0, 2.0, 0.5)}) {
    graph.AddPose(pose, 0.0);
  }
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.04, 0.01).asDiagonal();
  graph.AddRelativePose({0, 1, {1.0, 0.0, 0.0}, covariance});
  graph.AddRelativePose({0, 2, {0.7, 1.6, 0.4}, covariance});
  const std::vector<IgnoredEdge> ignored =
      DescribeIgnored({{1, std::nullopt}}, graph, graph.initial_poses());
  ASSERT_EQ(ignored.size(), 1u);
  EXPECT_EQ(ignored[0].edge, 1u);
  EXPECT_EQ(ignored[0].from, 0);
  EXPECT_EQ(ignored[0].to, 2);
  EXPECT_NEAR(ignored[0].off_m, 0.5, 1e-12);
  EXPECT_NEAR(ignored[0].off_rad, 0.1, 1e-12);
  EXPECT_NEAR(ignored[0].sigmas, std::sqrt(3.0 * 3.0 + 2.0 * 2.0 + 1.0), 1e-9);
}

}  // namespace
}  // namespace plumbline
