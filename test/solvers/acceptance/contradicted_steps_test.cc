#include "plumbline/solvers/acceptance/contradicted_steps.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {
namespace {

constexpr int kNumPoses = 60;
constexpr int kCarriedTo = 30;

// Steps of 0.2 m straight on; between two poses the robot was carried by 2 m.
struct Drive {
  SlamGraph graph;
  std::vector<double> seed;
  FactorOptions factors;
};

Drive CarriedDrive(double carried_m) {
  Drive drive;
  for (int i = 0; i < kNumPoses; ++i) {
    const double x = 0.2 * i + (i >= kCarriedTo ? carried_m : 0.0);
    drive.graph.AddPose({x, 0.0, 0.0}, i);
    if (i == 0) continue;
    drive.graph.AddOdometry({i - 1, i, {0.2, 0.0, 0.0}});
  }
  drive.seed = drive.graph.initial_poses();
  drive.factors.motion.translation_per_translation = 0.02;
  drive.factors.motion.translation_floor_m = 0.005;
  return drive;
}

StepsAgainstState Against(const Drive& drive, const std::vector<double>& state,
                          const std::vector<WorseStretch>& worse = {}) {
  return FindStepsAgainst(drive.graph, drive.factors, drive.seed, state, worse);
}
std::vector<DownweightedStep> Downweighted(const Drive& drive, const std::vector<double>& state,
                                           const std::vector<WorseStretch>& worse = {}) {
  return Against(drive, state, worse).steps;
}

// What the step is off at the seed is shared out among the ones beside it.
std::vector<double> TornState(const Drive& drive) {
  std::vector<double> state = drive.seed;
  for (int i = 0; i < 4; ++i) {
    state[3 * (kCarriedTo - 1 - i)] += 0.8 - 0.2 * i;
    state[3 * (kCarriedTo + i)] -= 0.8 - 0.2 * i;
  }
  return state;
}

TEST(ContradictedStepsTest, AStepThatTearsItsNeighboursIsDownweighted) {
  const Drive drive = CarriedDrive(2.0);
  const std::vector<DownweightedStep> downweighted = Downweighted(drive, TornState(drive));
  ASSERT_EQ(downweighted.size(), 1u);
  EXPECT_EQ(downweighted[0].step, kCarriedTo - 1u);
  // sqrt(5^2 + 4^2) mm for 2 m.
  EXPECT_NEAR(downweighted[0].sigma_factor, 2.0 / 0.0064, 1.0);
}

TEST(ContradictedStepsTest, DownweightedItIsOneStandardDeviationOff) {
  Drive drive = CarriedDrive(2.0);
  const double before = PoseTerms(drive.graph, drive.factors).Cost(drive.seed);
  drive.factors.downweighted_steps = Downweighted(drive, TornState(drive));
  EXPECT_GT(before, 1e4);
  EXPECT_NEAR(PoseTerms(drive.graph, drive.factors).Cost(drive.seed), 0.5, 1e-9);
  EXPECT_TRUE(Downweighted(drive, TornState(drive)).empty());
}

// All that comes after the step is as far off the seed as this.
std::vector<double> MovedAfterTheStep(const Drive& drive, double by_m) {
  std::vector<double> state = drive.seed;
  for (int i = kCarriedTo; i < kNumPoses; ++i) state[3 * i] += by_m;
  return state;
}

TEST(ContradictedStepsTest, AStepIsTrustedWhereTheStateObeysItAndIsNoWorse) {
  // The step was right, and what the seed had wrong has been put right, or nearly.
  const Drive drive = CarriedDrive(2.0);
  for (const double by_m : {-1.85, -2.0, -2.15}) {
    EXPECT_TRUE(Downweighted(drive, MovedAfterTheStep(drive, by_m)).empty()) << by_m;
  }
}

TEST(ContradictedStepsTest, AStepThatTheStateContradictsTooIsBroken) {
  const Drive drive = CarriedDrive(2.0);
  for (const double by_m : {0.5, 0.0, -1.0, -1.75}) {
    const StepsAgainstState against = Against(drive, MovedAfterTheStep(drive, by_m));
    ASSERT_EQ(against.steps.size(), 1u) << by_m;
    EXPECT_EQ(against.steps[0].step, kCarriedTo - 1u);
    EXPECT_TRUE(against.refute_state);
  }
}

TEST(ContradictedStepsTest, WorseStretchesSpeakAgainstAStepBesideThemOnly) {
  const Drive drive = CarriedDrive(2.0);
  const std::vector<double> obeys = MovedAfterTheStep(drive, -2.0);
  const StepsAgainstState against = Against(drive, obeys, {{20, 22}});
  EXPECT_EQ(against.steps.size(), 1u);
  EXPECT_FALSE(against.refute_state);
  EXPECT_TRUE(Downweighted(drive, obeys, {{2, 5}}).empty());
}

TEST(ContradictedStepsTest, LessThanALeapIsNoise) {
  const Drive drive = CarriedDrive(0.15);  // 23 standard deviations
  EXPECT_TRUE(Downweighted(drive, TornState(drive), {{28, 32}}).empty());
}

TEST(FindBrokenStepsTest, AStepThatTheSeedContradictsIsFoundBesideWhereOneIsBroken) {
  const Drive drive = CarriedDrive(2.0);
  const auto found = [&](const std::vector<int>& first_poses_after) {
    return FindBrokenSteps(drive.graph, drive.factors, drive.seed, first_poses_after);
  };
  for (const int pose : {kCarriedTo - 10, kCarriedTo, kCarriedTo + 10}) {
    const std::vector<DownweightedStep> steps = found({5, pose});
    ASSERT_EQ(steps.size(), 1u) << pose;
    EXPECT_EQ(steps[0].step, kCarriedTo - 1u);
    EXPECT_NEAR(steps[0].sigma_factor, 2.0 / 0.0064, 1.0);
  }
  EXPECT_TRUE(found({}).empty());
  EXPECT_TRUE(found({5, kCarriedTo + 25}).empty());
}

TEST(FindBrokenStepsTest, NoStepIsBrokenThatTheSeedObeysOrThatItDoesNotKnow) {
  const Drive drive = CarriedDrive(0.1);
  EXPECT_TRUE(FindBrokenSteps(drive.graph, drive.factors, drive.seed, {kCarriedTo}).empty());
  EXPECT_TRUE(FindBrokenSteps(drive.graph, drive.factors, {}, {kCarriedTo}).empty());
}

}  // namespace
}  // namespace plumbline
