#include "plumbline/solvers/hypotheses/tied_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/loop_closure/close_loops.h"

namespace plumbline {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr int kNumKeys = 150;  // of each session
constexpr double kStepM = 0.4;
constexpr double kNegligible = 1.0;  // squared error

RelativePoseConstraint Edge(int from, int to, const Pose2& from_from_to) {
  return {from, to, from_from_to, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()};
}

// Two sessions along one line. What is measured from step to step in the second one is too long by
// so much.
KeyframeGraph TwoSessions(double error_per_step_m = 0.0) {
  KeyframeGraph keys;
  for (int k = 0; k < 2 * kNumKeys; ++k) {
    Keyframe key;
    key.pose = key.scan = k;
    key.path_m = kStepM * k;
    keys.keyframes.push_back(key);
    keys.world_from_key.emplace_back(kStepM * (k % kNumKeys), 0.0, 0.0);
    if (k == 0) continue;
    SequentialEdge edge;
    const double error_m = k > kNumKeys ? error_per_step_m : 0.0;
    edge.constraint = Edge(k - 1, k, Pose2(kStepM + error_m, 0.0, 0.0));
    edge.broken = edge.between_sessions = k == kNumKeys;
    keys.sequential.push_back(edge);
  }
  return keys;
}

// Closures at every second keyframe from `first` to before `end`, which err along the line, where
// they are known to sigma_m.
void Tie(int first, int end, double error_m, KeyframeGraph* keys, double sigma_m = 0.01) {
  for (int k = first; k < end; k += 2) {
    keys->closures.push_back(Edge(k, kNumKeys + k, Pose2(error_m, 0.0, 0.0)));
    keys->closures.back().covariance(0, 0) = sigma_m * sigma_m;
  }
}

std::vector<TiedPlace> TestedSecond(KeyframeGraph keys) {
  OptimizeKeyframes(&keys);
  ThreadPool pool(2);
  return TestTiedPlaces(keys, kNumKeys, 2 * kNumKeys, kNegligible, &pool);
}

TEST(TiedPlacesTest, ClosuresThatAreRightBendNothing) {
  KeyframeGraph keys = TwoSessions();
  Tie(0, kNumKeys, 0.0, &keys);
  const std::vector<TiedPlace> places = TestedSecond(keys);
  EXPECT_THAT(places, SizeIs(10));  // 60 m
  std::size_t num_closures = 0;
  for (const TiedPlace& place : places) {
    EXPECT_FALSE(place.is_bent());
    num_closures += place.closures.size();
  }
  EXPECT_EQ(num_closures, keys.closures.size());
}

// They outnumber the steps that they bend.
TEST(TiedPlacesTest, FindsThoseThatAgreeOnWhatWasMoved) {
  KeyframeGraph keys = TwoSessions();
  Tie(0, 60, 0.0, &keys);
  Tie(60, 75, 0.25, &keys);  // from 24 to 30 m
  Tie(75, kNumKeys, 0.0, &keys);
  KeyframeGraph optimum = keys;
  OptimizeKeyframes(&optimum);
  EXPECT_GT(optimum.world_from_key[kNumKeys + 67].x - optimum.world_from_key[67].x, 0.2);
  const std::vector<TiedPlace> places = TestedSecond(keys);
  const auto worst =
      std::max_element(places.begin(), places.end(),
                       [](const TiedPlace& a, const TiedPlace& b) { return a.relief < b.relief; });
  ASSERT_NE(worst, places.end());
  EXPECT_TRUE(worst->is_bent());
  EXPECT_GE(worst->closures.front().from, 60);
  EXPECT_LT(worst->closures.front().from, 75);
}

// Its own loop was open by a metre.
TEST(TiedPlacesTest, DriftThatTiesTakeOutIsNoBend) {
  KeyframeGraph keys = TwoSessions(1.0 / kNumKeys);
  Tie(0, 3, 0.0, &keys);
  Tie(kNumKeys - 2, kNumKeys, 0.0, &keys);
  const std::vector<TiedPlace> places = TestedSecond(keys);
  EXPECT_THAT(places, SizeIs(2));
  for (const TiedPlace& place : places) EXPECT_FALSE(place.is_bent()) << place.relief;
}

int NumBent(const std::vector<TiedPlace>& places) {
  int num_bent = 0;
  for (const TiedPlace& place : places) num_bent += place.is_bent() ? 1 : 0;
  return num_bent;
}

// All of its rooms are like these, but 0.4 m farther apart.
TEST(TiedPlacesTest, ABuildingOfOtherDimensionsIsBentAtMostPlaces) {
  KeyframeGraph keys = TwoSessions();
  for (int room = 0; room < 10; ++room)
    Tie(15 * room + room % 2, 15 * room + 15, 0.4 * room, &keys);
  const std::vector<TiedPlace> places = TestedSecond(keys);
  EXPECT_GT(2 * NumBent(places), static_cast<int>(places.size()));
}

// Closures that give way relieve less: eight of these ten places by 8 to 14.
TEST(TiedPlacesTest, ClosuresThatAreKnownLessWellShowLessOfIt) {
  KeyframeGraph keys = TwoSessions();
  for (int room = 0; room < 10; ++room) {
    Tie(15 * room + room % 2, 15 * room + 15, 0.4 * room, &keys, 0.03);
  }
  const std::vector<TiedPlace> places = TestedSecond(keys);
  ASSERT_THAT(places, SizeIs(10));
  EXPECT_LT(NumBent(places), 3);
  const auto is_relieved = [](const TiedPlace& place) { return place.relief > 7.8; };
  EXPECT_GT(std::count_if(places.begin(), places.end(), is_relieved), 5);
}

TEST(TiedPlacesTest, DoesNotTestWhatCannotBeRelievedByAsMuch) {
  KeyframeGraph keys = TwoSessions();
  Tie(0, 60, 0.0, &keys);
  Tie(60, 75, 0.25, &keys);
  Tie(75, kNumKeys, 0.0, &keys);
  OptimizeKeyframes(&keys);
  ThreadPool pool(2);
  for (const TiedPlace& place : TestTiedPlaces(keys, kNumKeys, 2 * kNumKeys, 1e6, &pool)) {
    EXPECT_EQ(place.relief, 0.0);
    EXPECT_FALSE(place.closures.empty());
  }
}

// As by another laser, which measures two per cent more.
TEST(TiedPlacesTest, AnotherScaleIsNoBend) {
  KeyframeGraph keys = TwoSessions();
  for (int k = 0; k < kNumKeys; k += 2) Tie(k, k + 1, 0.02 * kStepM * k, &keys);
  EXPECT_EQ(NumBent(TestedSecond(keys)), 0);
}

TEST(TiedPlacesTest, ClosuresWithinAPartDoNotTieIt) {
  KeyframeGraph keys = TwoSessions();
  keys.closures.push_back(Edge(3, 70, Pose2()));
  keys.closures.push_back(Edge(kNumKeys + 3, kNumKeys + 70, Pose2()));
  EXPECT_THAT(TestedSecond(keys), IsEmpty());
}

}  // namespace
}  // namespace plumbline
