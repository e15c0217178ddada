#include "plumbline/solvers/reduced/unanchored_components.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Observations as pairs of pose and landmark, in order of landmarks.
LineObservations ObservationsOf(int num_poses, const std::vector<std::pair<int, int>>& pairs) {
  LineObservations observations;
  for (const auto& [pose, landmark] : pairs) {
    observations.observations.emplace_back();
    observations.observations.back().pose = pose;
    observations.observations.back().landmark = landmark;
  }
  observations.first_of_pose.resize(num_poses + 1);
  return observations;
}

// A graph of poses with its first one fixed, and odometry between some.
PoseTerms TermsOf(int num_poses, const std::vector<std::pair<int, int>>& edges) {
  SlamGraph graph;
  for (int i = 0; i < num_poses; ++i) graph.AddPose(Pose2(i, 0, 0), i);
  for (const auto& [from, to] : edges) {
    graph.AddOdometry({from, to, Pose2(to - from, 0, 0)});
  }
  return PoseTerms(graph, FactorOptions());
}

TEST(UnanchoredComponentsTest, EveryPoseAloneButTheFixedOneIsFree) {
  EXPECT_THAT(FindUnanchoredComponents(ObservationsOf(3, {}), TermsOf(3, {})), ElementsAre(1, 2));
}

TEST(UnanchoredComponentsTest, TermsAndSharedLandmarksHoldPosesTogether) {
  // 0-1 by odometry, 1-4 by a landmark, 2-3 by another landmark, 5 alone although it sees a
  // landmark.
  const LineObservations observations = ObservationsOf(6, {{1, 0}, {4, 0}, {2, 1}, {3, 1}, {5, 2}});
  EXPECT_THAT(FindUnanchoredComponents(observations, TermsOf(6, {{0, 1}})), ElementsAre(2, 5));
  EXPECT_THAT(FindUnanchoredComponents(observations, TermsOf(6, {{0, 1}, {3, 5}, {4, 2}})),
              IsEmpty());
}

}  // namespace
}  // namespace plumbline
