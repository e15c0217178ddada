#include "plumbline/apps/report/seeding_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/test/core/synthetic_scene.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

SlamGraph MakeScans(int num_scans) {
  SyntheticScene scene;
  scene.faces = {{{-1, -3}, {9, -3}}, {{9, -3}, {9, 3}}, {{9, 3}, {-1, 3}}, {{-1, 3}, {-1, -3}}};
  for (int i = 0; i < num_scans; ++i) scene.poses.emplace_back(i, 0.0, 0.0);
  return MakeGraph(scene);
}

SeedingReport MakeReport() {
  SeedingReport report;
  report.sequential.num_keyframes = 4;
  report.consistency.num_pairs_between = 10;
  report.loops.num_candidates = 9;
  return report;
}

std::string Text(const SeedingReport& report, int num_scans = 5) {
  const SlamGraph graph = MakeScans(num_scans);
  return SeedingText(report, graph, graph.initial_poses());
}

TEST(SeedingTextTest, ADriveWithoutAnythingSpecial) {
  EXPECT_EQ(Text(MakeReport()),
            "  4 keyframes among 5 scans.\n  No loop was closed among 9 places tried.\n");
}

TEST(SeedingTextTest, NothingToMatchOrToClose) {
  SeedingReport report = MakeReport();
  report.sequential.num_keyframes = 1;
  EXPECT_EQ(Text(report, 1), "  A single scan: there is nothing to match or to check.\n");
  EXPECT_THAT(Text(report, 5), AllOf(HasSubstr("  1 keyframe among 5 scans.\n"),
                                     HasSubstr("hardly moved"), Not(HasSubstr("loop was closed"))));
}

TEST(SeedingTextTest, ASingleKeyframeIsNoProofOfARobotAtRest) {
  SeedingReport report = MakeReport();
  report.sequential.num_keyframes = 1;
  // The other scans may be anywhere: they show no surface.
  for (const int num_unmatched : {1, 4}) {
    report.sequential.num_unmatched = num_unmatched;
    EXPECT_THAT(Text(report), AllOf(HasSubstr("  There is a single keyframe: there is no loop to "
                                              "close and no drift to check.\n"),
                                    Not(HasSubstr("hardly moved"))));
  }
  report.sequential.num_keyframes = 0;
  EXPECT_THAT(Text(report), AllOf(HasSubstr("  No scan shows a surface: "),
                                  Not(HasSubstr("hardly moved")), Not(HasSubstr("visited"))));
}

TEST(SeedingTextTest, ScansThatMatchNothing) {
  SeedingReport report = MakeReport();
  report.sequential.num_unmatched = 3;
  EXPECT_THAT(Text(report), HasSubstr("  3 scans matched nothing near by: "));
  report.sequential.num_unmatched = 4;  // the first has none to match
  EXPECT_THAT(Text(report), HasSubstr("No scan matches another: every pose is the odometry's"));
}

TEST(SeedingTextTest, ClosuresByOutcome) {
  SeedingReport report = MakeReport();
  report.loops.num_closures = 1;
  report.loops.matches = {{0, 3, Pose2(), ClosureOutcome::kAccepted},
                          {0, 2, Pose2(), ClosureOutcome::kAmbiguous},
                          {1, 3, Pose2(), ClosureOutcome::kLowOverlap},
                          {1, 2, Pose2(), ClosureOutcome::kLowOverlap}};
  EXPECT_THAT(Text(report), HasSubstr("  1 loop closure among 9 places tried; refused: 2 low "
                                      "overlap, 1 ambiguous.\n"));
  EXPECT_EQ(CountOutcomes(report.loops).at(ClosureOutcome::kLowOverlap), 2);
  EXPECT_EQ(CountOutcomes(report.loops).count(ClosureOutcome::kContradicted), 0u);
}

TEST(SeedingTextTest, NoPlaceVisitedTwice) {
  SeedingReport report = MakeReport();
  report.consistency.num_pairs_between = 0;
  EXPECT_THAT(Text(report),
              HasSubstr("  No place was visited twice: the drift cannot be checked.\n"));
  report.loops.matches = {{0, 3, Pose2(), ClosureOutcome::kAmbiguous}};
  EXPECT_THAT(Text(report), HasSubstr("  No loop was closed among 9 places tried; refused: 1 "
                                      "ambiguous: the drift cannot be checked.\n"));
}

TEST(SeedingTextTest, SuspectSteps) {
  SeedingReport report = MakeReport();
  SuspectStep step;
  step.first_pose_after = 2;
  step.evidence = 0.2;
  report.loops.suspect_steps = {step};
  EXPECT_THAT(Text(report), HasSubstr("  1 suspect step that all else agrees with.\n"));
  report.loops.suspect_steps[0].broken = true;
  EXPECT_THAT(Text(report), HasSubstr("  1 suspect step that nothing settles.\n"));
  report.loops.suspect_steps[0].num_closures_across = 2;
  EXPECT_THAT(Text(report), AllOf(HasSubstr("  The step to scan 2 (t = "),
                                  HasSubstr(", x = 2.00 m, y = 0.00 m) was wrong: 2 loop closures "
                                            "put it right.\n")));
}

TEST(SeedingTextTest, HypothesesThatWereAdopted) {
  SeedingReport report = MakeReport();
  report.hypotheses.resize(3);
  report.hypotheses[0].adopted = true;  // the matching, which needs no word
  EXPECT_THAT(Text(report), Not(HasSubstr("hypotheses")));
  WeighedHypothesis& without = report.hypotheses[1];
  without.kind = HypothesisKind::kWithoutCluster;
  without.num_closures = 12;
  without.first_later_pose = 8928;
  without.last_later_pose = 8992;
  without.first_earlier_pose = without.last_earlier_pose = 54;
  without.adopted = true;
  EXPECT_THAT(Text(report), HasSubstr("  Of 3 hypotheses the scans agree best with this one: "
                                      "without 12 closures of poses 8928-8992 with poses 54.\n"));
}

TEST(SeedingTextTest, ARobotThatWasCarried) {
  WeighedHypothesis joined;
  joined.kind = HypothesisKind::kJoinedParts;
  joined.first_pose_after = 17;
  joined.carried_to = Pose2(1.24, -3.0, 0.5 * kPi);
  EXPECT_EQ(HypothesisText(joined),
            "carried before pose 17: 1.2 m ahead, -3.0 m to the left, turned by 90 deg");
}

TEST(SeedingTextTest, RunnersUpAreOtherMapsTheBestFirst) {
  const auto make = [](double x_m, double score) {
    WeighedHypothesis hypothesis;
    hypothesis.kind = HypothesisKind::kBrokenSteps;
    hypothesis.score = score;
    hypothesis.world_from_robot = {Pose2(), Pose2(x_m, 0.0, 0.0)};
    return hypothesis;
  };
  std::vector<WeighedHypothesis> hypotheses = {make(0.1, -900.0), make(5.0, -200.0),
                                               make(9.0, -300.0), make(9.2, -250.0),
                                               make(0.0, -950.0), make(7.0, -990.0)};
  hypotheses[4].adopted = true;
  hypotheses[5].kind = HypothesisKind::kOdometryAlone;  // is shown anyway
  hypotheses.emplace_back();                            // without a map
  const std::vector<Pose2> seed = hypotheses[4].world_from_robot;
  const std::vector<const WeighedHypothesis*> two = RunnersUp(hypotheses, seed, 2);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0], &hypotheses[2]);
  EXPECT_EQ(two[1], &hypotheses[1]);
  EXPECT_EQ(RunnersUp(hypotheses, seed, 1).size(), 1u);
}

TEST(SeedingTextTest, FaultsOfTheOdometry) {
  SeedingReport report = MakeReport();
  report.sequential.odometry_sign.sign_lost = true;
  report.sequential.num_reversed_steps = 2;
  OdometryNoiseReport& noise = report.odometry_noise;
  noise.translation_scale = {0.021, 0.002};
  noise.rotation_scale = {0.01, 0.009};  // one standard deviation: nothing
  noise.translation = {true, 50, 0.012, 0.001};
  const std::string text = Text(report);
  EXPECT_THAT(text, HasSubstr("lost the sign of its translation: 2 steps went backwards"));
  EXPECT_THAT(text, HasSubstr("reads +2.10 +- 0.20 % in distance; its motions are corrected"));
  EXPECT_THAT(text, Not(HasSubstr("in turns")));
  EXPECT_THAT(text, HasSubstr("  Odometry noise (one sigma): 12.0 mm per root metre and 1.0 mm per "
                              "root radian in distance.\n"));
  noise.num_leaps = 1;
  EXPECT_THAT(Text(report), HasSubstr("In 1 step odometry and scans disagree"));
}

TEST(SeedingTextTest, SaysHowMuchMoves) {
  SeedingReport report = MakeReport();
  EXPECT_THAT(Text(report), Not(HasSubstr("moves")));
  report.moving_share = 0.0912;
  EXPECT_THAT(Text(report),
              HasSubstr("  People and all else that moves: 9.1 % of the returns, left out of"));
}

TEST(RangeNoiseTextTest, SaysWhatIsTakenInsteadOfWhatWasAssumed) {
  MapLogOptions options;
  options.solver.factors.beam.sigma_range_m = 0.012;
  MappingReport report;
  report.range_noise_m = 0.02;
  EXPECT_EQ(RangeNoiseText(options, report), "");
  report.range_noise_m = 0.03;
  EXPECT_EQ(RangeNoiseText(options, report),
            "  Range noise (one sigma): 30 mm by neighbouring beams; 12 mm were assumed.\n");
}

TEST(ConsistencyTextTest, SaysWhetherTheMapContradictsItself) {
  MapConsistency consistency;
  EXPECT_EQ(ConsistencyText("The seed", consistency), "");
  consistency.num_pairs_within = 5;
  // Back to back, they see nothing of each other's surfaces.
  EXPECT_EQ(ConsistencyText("The seed", consistency),
            "  The seed cannot be checked: no scan looks where another one shows something.\n");
  consistency.within_pass = {200, 0};
  EXPECT_THAT(ConsistencyText("The seed", consistency),
              AllOf(HasSubstr("  The seed is consistent: "), HasSubstr(" 1.0 times ")));
  consistency.worst_between = {{600, 400}, 0};
  EXPECT_THAT(ConsistencyText("The seed", consistency),
              AllOf(HasSubstr("  The seed contradicts itself: "), HasSubstr(" 6.1 times ")));
}

}  // namespace
}  // namespace plumbline
