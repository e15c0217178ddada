#include "plumbline/solvers/alarm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/test/core/synthetic_scene.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Scans in a square room, a metre apart; scan i at time i.
SlamGraph MakeScans(int num_scans) {
  SyntheticScene scene;
  scene.faces = {{{-1, -3}, {9, -3}}, {{9, -3}, {9, 3}}, {{9, 3}, {-1, 3}}, {{-1, 3}, {-1, -3}}};
  for (int i = 0; i < num_scans; ++i) scene.poses.emplace_back(i, 0.5, 0.0);
  return MakeGraph(scene);
}

// 600 returns that agree are added to those of a peak, and 6 % of conflicts can be explained:
// 400 conflicts of 600 returns are (400 / 0.06 + 600) / 1200 = 6.06 times that.
MapConsistency Contradiction(ConflictPeak MapConsistency::*peak, int pose) {
  MapConsistency consistency;
  consistency.*peak = {{600, 400}, pose};
  return consistency;
}

SeedingReport ReportWithSuspect(const SuspectStep& suspect) {
  SeedingReport report;
  report.loops.suspect_steps = {suspect};
  return report;
}

TEST(PlaceOfPoseTest, NamesScanTimeAndPlace) {
  const SlamGraph graph = MakeScans(4);
  const ScanPlace place = PlaceOfPose(graph, graph.initial_poses(), 2);
  EXPECT_EQ(place.scan, 2);
  EXPECT_EQ(place.time_s, graph.timestamp_s(2));
  EXPECT_EQ(place.world_position, Eigen::Vector2d(2.0, 0.5));
  EXPECT_EQ((ScanPlace{7, 12.5, {1.0, -2.25}}.Text()),
            "scan 7 (t = 12.50 s, x = 1.00 m, y = -2.25 m)");
}

TEST(PlaceOfPoseTest, PosesWithoutScanAreNotCounted) {
  SlamGraph graph;
  const int laser = graph.AddLaser(PanoramicLaser(4));
  for (int i = 0; i < 3; ++i) graph.AddPose(Pose2(), i);
  graph.AddScan(2, laser, {1.0, 1.0, 1.0, 1.0});
  EXPECT_EQ(PlaceOfPose(graph, graph.initial_poses(), 2).scan, 0);
}

TEST(PlaceOfPoseTest, APoseWithoutScanHasTimeAndPlaceAllTheSame) {
  SlamGraph graph = MakeScans(2);
  const int pose = graph.AddPose(Pose2(5.0, -1.0, 0.0), 9.0);
  const ScanPlace place = PlaceOfPose(graph, graph.initial_poses(), pose);
  EXPECT_FALSE(place.scan.has_value());
  EXPECT_EQ(place.Text(), "a pose without scan (t = 9.00 s, x = 5.00 m, y = -1.00 m)");
}

TEST(MapAlarmsTest, ASoundMapRaisesNone) {
  const SlamGraph graph = MakeScans(2);
  EXPECT_TRUE(MapAlarms(MapConsistency(), graph, graph.initial_poses()).empty());
}

TEST(MapAlarmsTest, EachPeakSpeaksForItself) {
  const SlamGraph graph = MakeScans(4);
  MapConsistency both = Contradiction(&MapConsistency::worst_between, 1);
  const std::vector<Alarm> one = MapAlarms(both, graph, graph.initial_poses());
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].place.scan, 1);
  EXPECT_THAT(one[0].reason, AllOf(HasSubstr("other visits"), HasSubstr("6.1 times")));

  both.worst_within = {{600, 400}, 3};
  const std::vector<Alarm> two = MapAlarms(both, graph, graph.initial_poses());
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].place.scan, 3);
  EXPECT_THAT(two[0].reason, HasSubstr("each other's surfaces"));
  EXPECT_EQ(two[1].reason, one[0].reason);
}

TEST(RunAlarmsTest, AContradictionThatTheRefinementRemovesIsNone) {
  const SlamGraph graph = MakeScans(4);
  SeedingReport seeding;
  seeding.consistency = Contradiction(&MapConsistency::worst_within, 1);
  const auto after = Contradiction(&MapConsistency::worst_within, 2);

  const std::vector<Alarm> of_refined = RunAlarms(seeding, after, graph, graph.initial_poses());
  ASSERT_EQ(of_refined.size(), 1u);
  EXPECT_EQ(of_refined[0].place.scan, 2);
  EXPECT_TRUE(RunAlarms(seeding, MapConsistency(), graph, graph.initial_poses()).empty());
}

TEST(RunAlarmsTest, StepsThatNothingSettles) {
  const SlamGraph graph = MakeScans(4);
  const auto reason = [&](const SuspectStep& suspect) {
    const std::vector<Alarm> alarms =
        RunAlarms(ReportWithSuspect(suspect), MapConsistency(), graph, graph.initial_poses());
    return alarms.empty() ? "" : alarms[0].reason;
  };
  SuspectStep step;
  step.first_pose_after = 3;
  step.evidence = 0.2;
  EXPECT_EQ(reason(step), "");
  step.broken = true;
  EXPECT_THAT(reason(step), HasSubstr("no loop closure ties them together"));
  step.num_closures_across = 1;
  EXPECT_THAT(reason(step), HasSubstr("a single loop closure"));
  step.num_closures_across = 2;
  EXPECT_EQ(reason(step), "");
  step.turned_rad = 1.5;
  EXPECT_THAT(reason(step), HasSubstr("might fit elsewhere as well"));
  EXPECT_EQ(RunAlarms(ReportWithSuspect(step), MapConsistency(), graph, graph.initial_poses())[0]
                .place.scan,
            3);
  step.turned_rad = 0.0;
  step.num_alternatives = 1;
  EXPECT_THAT(reason(step), HasSubstr("fits at 1 other place as well"));
  step.num_alternatives = 2;
  EXPECT_THAT(reason(step), HasSubstr("fits at 2 other places as well"));
}

// Of 20000 returns 1.5 % conflict between passes, and 0.05 % within one.
MapConsistency DisagreeingPasses() {
  MapConsistency consistency;
  consistency.within_pass = {20000, 10};
  consistency.between_passes = {20000, 300};
  consistency.worst_between = {{2000, 100}, 2};
  return consistency;
}

SlamGraph MakeDrive(int num_scans) {
  SlamGraph graph = MakeScans(num_scans);
  for (int i = 1; i < num_scans; ++i) {
    graph.AddOdometry({i - 1, i, {1.0, 0.0, 0.0}});
  }
  return graph;
}

TEST(RunAlarmsTest, PassesOfOneDriveThatDisagree) {
  const SlamGraph graph = MakeDrive(4);
  std::vector<Alarm> alarms =
      RunAlarms(SeedingReport(), DisagreeingPasses(), graph, graph.initial_poses());
  ASSERT_EQ(alarms.size(), 1u);
  EXPECT_EQ(alarms[0].place.scan, 2);
  EXPECT_THAT(alarms[0].reason, AllOf(HasSubstr("(1.50 %"), HasSubstr("(0.05 %)"),
                                      HasSubstr("look alike may lie on each other")));
  SeedingReport seeding;
  seeding.consistency = DisagreeingPasses();
  seeding.alarm = true;
  alarms = RunAlarms(seeding, MapConsistency(), graph, graph.initial_poses());
  ASSERT_EQ(alarms.size(), 1u);
  EXPECT_THAT(alarms[0].reason, HasSubstr("before the refinement"));
  // A contradiction says more.
  MapConsistency both = DisagreeingPasses();
  both.worst_within = {{600, 400}, 1};
  alarms = RunAlarms(SeedingReport(), both, graph, graph.initial_poses());
  ASSERT_EQ(alarms.size(), 1u);
  EXPECT_EQ(alarms[0].place.scan, 1);
}

TEST(RunAlarmsTest, SessionsMayDisagree) {
  const SlamGraph graph = MakeScans(4);  // which no odometry joins
  EXPECT_TRUE(
      RunAlarms(SeedingReport(), DisagreeingPasses(), graph, graph.initial_poses()).empty());
}

TEST(WorseThanStartAlarmsTest, TellIfHeldOutReturnsFitWorseThanChanceAllows) {
  const SlamGraph graph = MakeScans(4);
  const std::vector<double> poses = graph.initial_poses();
  AcceptanceTest acceptance;
  acceptance.num_held_out = 100;
  acceptance.seed_held_out_error = 0.5;
  acceptance.held_out_noise = 0.05;
  acceptance.final_held_out_error = 0.59;
  EXPECT_TRUE(WorseThanStartAlarms(acceptance, graph, poses).empty());
  acceptance.final_held_out_error = 0.8;
  const std::vector<Alarm> alarms = WorseThanStartAlarms(acceptance, graph, poses);
  ASSERT_EQ(alarms.size(), 1u);
  EXPECT_THAT(alarms[0].reason, HasSubstr("from 0.500 to 0.800 sigmas^2"));
  EXPECT_FALSE(alarms[0].IsProbable());
}

TEST(UncheckedMapAlarmsTest, TellIfHardlyAnyScanCouldBeMatched) {
  const SlamGraph graph = MakeScans(4);
  const std::vector<double>& poses = graph.initial_poses();
  EXPECT_TRUE(UncheckedMapAlarms(0.58, 0.02, graph, poses).empty());
  const std::vector<Alarm> bare = UncheckedMapAlarms(0.0125, 0.0, graph, poses);
  ASSERT_EQ(bare.size(), 1u);
  EXPECT_EQ(bare[0].place.scan, 0);
  EXPECT_THAT(bare[0].reason, HasSubstr("only 1.2 % of the returns show a surface"));
  EXPECT_FALSE(bare[0].IsProbable());
  const std::vector<Alarm> lost = UncheckedMapAlarms(0.58, 0.79, graph, poses);
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_THAT(lost[0].reason, HasSubstr("79.0 % of the scans match nothing near by"));
}

TEST(MisplacedScanAlarmsTest, OneSpeaksForAll) {
  const SlamGraph graph = MakeScans(4);
  EXPECT_TRUE(MisplacedScanAlarms({}, graph, graph.initial_poses()).empty());
  const std::vector<Alarm> one = MisplacedScanAlarms({2}, graph, graph.initial_poses());
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].place.scan, 2);
  EXPECT_THAT(one[0].reason, HasSubstr("this scan lies some decimetres beside"));
  EXPECT_FALSE(one[0].IsProbable());
  const std::vector<Alarm> two = MisplacedScanAlarms({1, 3}, graph, graph.initial_poses());
  ASSERT_EQ(two.size(), 1u);
  EXPECT_EQ(two[0].place.scan, 1);
  EXPECT_THAT(two[0].reason, HasSubstr("2 scans, from here on, lie some decimetres beside"));
}

TEST(AlarmTextTest, ShowsTheFirstFew) {
  EXPECT_EQ(AlarmText({}), "");
  std::vector<Alarm> alarms(5, Alarm{{3, 1.0, {2.0, 0.0}}, "reasons", std::nullopt});
  const std::string text = AlarmText(alarms);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
  EXPECT_THAT(text, testing::StartsWith("WARNING: the map may be wrong around scan 3 (t = "
                                        "1.00 s, x = 2.00 m, y = 0.00 m): reasons.\n"));
  alarms.resize(8);
  EXPECT_EQ(AlarmText(alarms), text + "WARNING: and around 3 more places.\n");
}

TEST(AlarmTextTest, SaysHowSureItIs) {
  EXPECT_THAT(AlarmText({{{}, "reasons", 0.07}}),
              AllOf(HasSubstr("the map may be wrong"),
                    HasSubstr("reasons (7 % of the simulated maps with such a warning were")));
  EXPECT_THAT(AlarmText({{{}, "reasons", 0.9}}), HasSubstr("the map is probably wrong"));
  EXPECT_THAT(AlarmText({{{}, "reasons", std::nullopt}}),
              AllOf(HasSubstr("the map may be wrong"), HasSubstr("reasons.\n")));
}

TEST(RunAlarmsTest, AMapThatContradictsItselfIsWorseThanAStepThatNothingSettles) {
  const SlamGraph graph = MakeScans(4);
  SuspectStep step;
  step.first_pose_after = 3;
  step.broken = true;
  const std::vector<Alarm> both =
      RunAlarms(ReportWithSuspect(step), Contradiction(&MapConsistency::worst_within, 1), graph,
                graph.initial_poses());
  ASSERT_EQ(both.size(), 2u);
  EXPECT_TRUE(both[0].IsProbable());
  EXPECT_FALSE(both[1].IsProbable());
  EXPECT_GT(*both[1].wrong_share, 0.0);
}

}  // namespace
}  // namespace plumbline
