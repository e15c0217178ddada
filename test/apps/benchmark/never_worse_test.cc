// The result of Solve against its start: no worse against the truth than noise explains, no
// blurrier, or the start itself. A short selection of what
// `plumbline_benchmark --experiment=adversarial` runs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/adversarial.h"
#include "plumbline/apps/benchmark/adversarial_problem.h"
#include "plumbline/solvers/refine_state.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

AdversarialOutcome Solved(const AdversarialCase& run) {
  AdversarialOutcome outcome;
  const Status status = RunAdversarialCase(run, SolverOptions(), &outcome);
  EXPECT_TRUE(status.ok()) << status.message();
  return outcome;
}

void ExpectNeverWorse(const AdversarialOutcome& outcome) {
  EXPECT_FALSE(outcome.PosesAreWorse())
      << outcome.before.pose_error_m << " -> " << outcome.after.pose_error_m << " m, floor "
      << outcome.floor_m;
  EXPECT_FALSE(outcome.MapIsBlurrier());
  EXPECT_LT(outcome.floor_m, 0.005);
  EXPECT_GT(outcome.floor_m, 0.0);
}

struct Case {
  Attack attack;
  double level;
  double least_gain;  // of the pose error, as a factor; 0: may come back as it was
};

class NeverWorseTest : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    HostGraphs, NeverWorseTest,
    testing::Values(Case{Attack::kTruth, 0.0, 0.0}, Case{Attack::kDrift, 3.0, 10.0},
                    Case{Attack::kWrongClosures, 0.1, 5.0}, Case{Attack::kGrossClosures, 0.0, 5.0},
                    Case{Attack::kJump, 1.0, 5.0}, Case{Attack::kShuffled, 0.1, 100.0},
                    Case{Attack::kShuffled, 1.0, 100.0}, Case{Attack::kMirrored, 0.1, 2.0},
                    Case{Attack::kPeople, 0.3, 3.0}, Case{Attack::kMissingOdometry, 0.5, 5.0},
                    Case{Attack::kNoise, 0.2, 3.0}, Case{Attack::kNoise, 5.0, 2.0},
                    Case{Attack::kRepeatedScan, 0.1, 0.0}),
    [](const testing::TestParamInfo<Case>& info) { return "Case" + std::to_string(info.index); });

TEST_P(NeverWorseTest, HoldsForAHostsGraph) {
  const Case& param = GetParam();
  const AdversarialOutcome outcome = Solved({param.attack, param.level, 2});
  SCOPED_TRACE(ToString(param.attack));
  ExpectNeverWorse(outcome);
  EXPECT_LE(param.least_gain * outcome.after.pose_error_m, outcome.before.pose_error_m);
}

TEST(NeverWorseEdgesTest, FalseEdgesAreToldFromSoundOnes) {
  for (const Attack attack : {Attack::kGrossClosures, Attack::kBiasedClosures}) {
    SCOPED_TRACE(ToString(attack));
    const AdversarialOutcome outcome = Solved({attack, 0.3, 2});
    EXPECT_GT(outcome.before.pose_error_m, 0.05);
    EXPECT_LT(outcome.after.pose_error_m, 0.003);
    EXPECT_GT(outcome.num_false_edges, 50);
    EXPECT_GT(outcome.num_false_edges_ignored, 0.85 * outcome.num_false_edges);
    EXPECT_LE(outcome.num_sound_edges_ignored, 2);
  }
}

TEST(NeverWorseRefusedTest, MirroredScansLeaveTheStartAsItWas) {
  const AdversarialOutcome outcome = Solved({Attack::kMirrored, 1.0, 2});
  EXPECT_THAT(outcome.summary.message, HasSubstr("the scans look mirrored"));
  EXPECT_EQ(outcome.after.pose_error_m, outcome.before.pose_error_m);
}

TEST(NeverWorseSeededTest, HoldsForALogWithPeople) {
  ExpectNeverWorse(Solved({Attack::kPeople, 0.3, 2, true}));
}

TEST(NeverWorseSolveTest, APerfectStartComesBackBitForBitAndTheMessageSaysWhy) {
  // By odometry and scans alone: closures would move it by what noise there is in them.
  AdversarialProblem problem;
  ASSERT_TRUE(MakeAdversarialProblem({Attack::kTruth, 0.0, 2, true}, &problem).ok());
  const std::vector<double> truth = PoseArray(problem.truth);
  const MapState start{truth, problem.graph.MeasuredMap(truth)};
  MapState state = start;
  const SolverSummary summary = RefineState(SolverOptions(), problem.graph, &state);
  EXPECT_EQ(summary.termination, TerminationType::kNoImprovement);
  EXPECT_EQ(state, start);
  // Noise that poses are fitted to lowers the energy, and tells nothing of other returns.
  EXPECT_TRUE(summary.acceptance.LowersEnergy());
  EXPECT_THAT(summary.message, HasSubstr("the held-out returns fit worse"));
  EXPECT_THAT(summary.message, HasSubstr("the seed is returned as it was"));
  EXPECT_THAT(summary.FullReport(), HasSubstr("held-out error"));
}

class AllSolversTest : public testing::TestWithParam<SolverType> {};
INSTANTIATE_TEST_SUITE_P(JointSolvers, AllSolversTest,
                         testing::Values(SolverType::kReduced, SolverType::kAlternatingCg),
                         [](const testing::TestParamInfo<SolverType>& info) {
                           return std::string(ToString(info.param));
                         });

TEST_P(AllSolversTest, HaveTheirResultJudgedByHeldOutReturns) {
  AdversarialProblem problem;
  ASSERT_TRUE(MakeAdversarialProblem({Attack::kNone, 0.0, 2}, &problem).ok());
  SolverOptions options;
  options.type = GetParam();
  options.rounds.max_coarse_rounds = 1;
  options.rounds.max_fine_rounds = 1;
  MapState state = problem.graph.InitialState();
  const SolverSummary summary = RefineState(options, problem.graph, &state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_GT(summary.acceptance.num_held_out, 1000u);
  EXPECT_LT(summary.acceptance.final_held_out_error,
            summary.acceptance.seed_held_out_error - 10.0 * summary.acceptance.held_out_noise);
  // Every return has its point, those held out included: on average nearer to its surface than
  // the end of its beam.
  EXPECT_GT(summary.displacements.mean_m, 0.001);
}

}  // namespace
}  // namespace plumbline
