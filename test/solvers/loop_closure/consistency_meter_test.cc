#include "plumbline/solvers/loop_closure/consistency_meter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

/// A corridor along x, walls at y = -1.5 m and y = 1.5 m, so long that no beam reaches its ends.
SyntheticScene Corridor() {
  SyntheticScene scene;
  scene.faces = {{{-30.0, -1.5}, {30.0, -1.5}}, {{-30.0, 1.5}, {30.0, 1.5}}};
  scene.laser = PanoramicLaser(360);
  scene.laser.max_range_m = 8.0;
  return scene;
}

/// Drives the corridor from x = -5 m to x = 5 m and back, num_passes times one way, a scan every
/// half metre.
std::vector<Pose2> BackAndForth(int num_passes) {
  std::vector<Pose2> poses;
  for (int pass = 0; pass < num_passes; ++pass) {
    const double direction = pass % 2 == 0 ? 1.0 : -1.0;
    for (int i = 0; i <= 20; ++i) {
      poses.emplace_back(direction * (0.5 * i - 5.0), 0.0, direction > 0.0 ? 0.0 : kPi);
    }
  }
  return poses;
}

MapConsistency Measure(const SlamGraph& graph, const std::vector<Pose2>& poses,
                       int num_threads = 2) {
  ThreadPool pool(num_threads);
  return MeasureMapConsistency(graph, poses, &pool);
}

TEST(MapConsistency, APeakIsPutToWhatIsUsualOnTheDrive) {
  MapConsistency consistency;
  consistency.worst_between.conflict = {600, 300};
  const double ratio = consistency.Ratio();
  EXPECT_TRUE(consistency.IsContradictory());
  consistency.worst_between.usual_ratio = 0.15;  // as little as in most buildings
  EXPECT_EQ(consistency.Ratio(), ratio);
  consistency.worst_between.usual_ratio = 1.0 / 3.0;  // people and doors everywhere
  EXPECT_NEAR(consistency.Ratio(), ratio / 2.0, 1e-12);
  EXPECT_FALSE(consistency.IsContradictory());
  consistency.worst_between.usual_ratio = 0.9;
  EXPECT_NEAR(consistency.Ratio(), ratio / 3.0, 1e-12);  // and no more
  EXPECT_FALSE(consistency.IsContradictory());
  consistency.contradicted_share = 0.3;
  EXPECT_TRUE(consistency.IsContradictory());
  consistency.contradicted_share = 0.0;
  consistency.worst_between.usual_ratio = 1.1;  // people who go with the robot
  EXPECT_FALSE(consistency.IsContradictory());
  consistency.usual_ratio_at_rest = 1.1;  // half of the map contradicts itself
  EXPECT_TRUE(consistency.IsContradictory());
}

TEST(MapConsistency, PassesDisagreeOutOfProportionToEach) {
  MapConsistency consistency;
  EXPECT_FALSE(consistency.PassesDisagree());
  consistency.within_pass = {100000, 300};
  consistency.between_passes = {100000, 1700};
  EXPECT_FALSE(consistency.PassesDisagree());
  consistency.between_passes = {100000, 1900};
  EXPECT_TRUE(consistency.PassesDisagree());
  consistency.within_pass = {100000, 3000};  // people
  EXPECT_FALSE(consistency.PassesDisagree());
  // Next to nothing is more than nothing, and no reason.
  consistency.within_pass = {100000, 0};
  consistency.between_passes = {100000, 1100};
  EXPECT_FALSE(consistency.PassesDisagree());
}

TEST(MapConsistency, SumsConflictsAndKnowsTheUsualShare) {
  MapConsistency consistency;
  EXPECT_EQ(consistency.UsualShare(), MapConsistency::kLeastShare);
  consistency.within_pass = {1000, 1};
  EXPECT_EQ(consistency.UsualShare(), MapConsistency::kLeastShare);
  consistency.within_pass = {1000, 80};
  EXPECT_EQ(consistency.UsualShare(), 0.08);
  consistency.between_passes = {500, 10};
  EXPECT_EQ(consistency.AllConflicts().num_compared, 1500);
  EXPECT_EQ(consistency.AllConflicts().num_conflicting, 90);
}

TEST(MapConsistency, RatioOfTheWorstPlaceToWhatCanBeExplained) {
  MapConsistency consistency;
  EXPECT_EQ(consistency.Ratio(), 1.0);
  EXPECT_FALSE(consistency.IsContradictory());
  consistency.within_pass = {1000, 1};
  consistency.worst_between.conflict = {600, 60};
  EXPECT_EQ(consistency.ExplicableShare(), 0.06);  // doors
  EXPECT_NEAR(consistency.Ratio(), (1000.0 + 600.0) / 1200.0, 1e-12);
  EXPECT_FALSE(consistency.IsContradictory());
  consistency.worst_within.conflict = {600, 300};
  EXPECT_NEAR(consistency.Ratio(), (5000.0 + 600.0) / 1200.0, 1e-12);
  EXPECT_TRUE(consistency.IsContradictory());
  // Each peak speaks for itself.
  EXPECT_NEAR(consistency.Ratio(consistency.worst_between), (1000.0 + 600.0) / 1200.0, 1e-12);
  EXPECT_TRUE(consistency.IsContradictory(consistency.worst_within));
  EXPECT_FALSE(consistency.IsContradictory(consistency.worst_between));
  consistency.within_pass = {1000, 80};
  EXPECT_EQ(consistency.ExplicableShare(), 0.08);
  consistency.within_pass = {1000, 400};
  EXPECT_EQ(consistency.ExplicableShare(), 0.1);  // a crowd
}

TEST(MapConsistency, TheWorstPeakIsTheOneOfTheHigherRatio) {
  MapConsistency consistency;
  // All of it conflicts, but ten returns are a passer-by.
  consistency.worst_within = {{10, 10}, 3};
  consistency.worst_between = {{600, 140}, 7};
  EXPECT_EQ(consistency.WorstPeak().pose, 7);
  EXPECT_EQ(consistency.Ratio(), consistency.Ratio(consistency.worst_between));
  consistency.worst_within = {{600, 150}, 3};
  EXPECT_EQ(consistency.WorstPeak().pose, 3);
}

TEST(MapConsistency, BetweenOverWithinComparesTheShares) {
  MapConsistency consistency;
  consistency.within_pass = {100, 5};
  consistency.between_passes = {1000, 200};
  EXPECT_NEAR(consistency.BetweenOverWithin(), 4.0, 1e-12);
  consistency.within_pass = {100, 0};
  EXPECT_FALSE(std::isfinite(consistency.BetweenOverWithin()));
}

TEST(MapConsistency, TwoPassesThroughOneCorridorAgree) {
  SyntheticScene scene = Corridor();
  scene.range_sigma_m = 0.02;
  scene.poses = BackAndForth(2);
  const MapConsistency consistency = Measure(MakeGraph(scene), scene.poses);
  // Partners of one pass are 1 m to 5 m of path back: 2 to 10 scans, of which 4 are taken.
  EXPECT_GT(consistency.num_pairs_within, 100);
  EXPECT_LE(consistency.num_pairs_within, 4 * 42);
  // Partners of the other pass are 8 m of path back and within reach: none before x = 3 m on the
  // way back, 17 scans from there on.
  EXPECT_GT(consistency.num_pairs_between, 80);
  EXPECT_LE(consistency.num_pairs_between, 8 * 17);
  EXPECT_GT(consistency.between_passes.num_compared, 5000);
  EXPECT_EQ(consistency.within_pass.num_conflicting, 0);
  EXPECT_EQ(consistency.between_passes.num_conflicting, 0);
  EXPECT_LE(consistency.Ratio(), 1.0);
  EXPECT_TRUE(consistency.places.empty());
}

TEST(MapConsistency, APassBesideTheOtherContradictsIt) {
  SyntheticScene scene = Corridor();
  scene.poses = BackAndForth(2);
  const SlamGraph graph = MakeGraph(scene);
  std::vector<Pose2> poses = scene.poses;
  for (std::size_t k = 21; k < poses.size(); ++k) poses[k].y += 1.0;
  const MapConsistency consistency = Measure(graph, poses);
  // The second pass has walls at y = -0.5 m and 2.5 m. Of each pass's walls one lies in the free
  // space of the other pass at a third, or at 3/5, of the range that it sees there; the other wall
  // is hidden. So all that can be compared conflicts.
  const FreeSpaceConflict& between = consistency.between_passes;
  EXPECT_GT(between.num_compared, 3000);
  EXPECT_EQ(between.num_conflicting, between.num_compared);
  EXPECT_TRUE(consistency.IsContradictory());
  EXPECT_GE(static_cast<int>(consistency.places.size()), 2 * consistency.num_pairs_between);
  for (const SpaceConflict& place : consistency.places) {
    EXPECT_NEAR(place.world_point.y(), place.viewer_scan < place.scan ? -0.5 : 1.5, 1e-6);
    EXPECT_NEAR(place.world_point.x(), poses[graph.scan(place.scan).pose].x, 8.0);
  }
}

TEST(MapConsistency, AWrongPartIsFoundInAMapThatIsRightElsewhere) {
  SyntheticScene scene = Corridor();
  scene.poses = BackAndForth(16);
  const SlamGraph graph = MakeGraph(scene);
  std::vector<Pose2> poses = scene.poses;
  for (std::size_t k = 150; k < 164; ++k) poses[k].y += 1.0;
  const MapConsistency consistency = Measure(graph, poses);
  EXPECT_LT(consistency.between_passes.Share(), 0.06);
  EXPECT_TRUE(consistency.IsContradictory());
  EXPECT_GE(consistency.worst_between.pose, 147);
  EXPECT_LT(consistency.worst_between.pose, 167);
}

TEST(MapConsistency, AJumpIsFoundWithoutASecondPass) {
  SyntheticScene scene = Corridor();
  scene.poses = BackAndForth(1);
  const SlamGraph graph = MakeGraph(scene);
  std::vector<Pose2> poses = scene.poses;
  for (std::size_t k = 8; k < poses.size(); ++k) poses[k].y += 1.0;
  const MapConsistency consistency = Measure(graph, poses);
  EXPECT_EQ(consistency.num_pairs_between, 0);
  // As every pair across the jump conflicts in all that can be compared, so does the whole place.
  const FreeSpaceConflict& across = consistency.worst_within.conflict;
  EXPECT_GT(across.num_compared, 500);
  EXPECT_GT(across.Share(), 0.9);
  EXPECT_NEAR(consistency.worst_within.pose, 7, 1);
  EXPECT_TRUE(consistency.IsContradictory());
}

TEST(MapConsistency, APersonWhoStoodThereOnceIsNoContradiction) {
  SyntheticScene scene = Corridor();
  const std::vector<Pose2> poses = BackAndForth(2);
  scene.poses.assign(poses.begin(), poses.begin() + 21);
  SlamGraph graph = MakeGraph(scene);
  scene.poses.assign(poses.begin() + 21, poses.end());
  scene.discs = {{{-1.0, 0.9}, 0.25}};
  const SlamGraph with_person = MakeGraph(scene);
  for (int s = 0; s < with_person.num_scans(); ++s) {
    const std::vector<double> ranges = with_person.RangesOfScan(s, scene.laser.max_range_m);
    const int pose = graph.AddPose(scene.poses[s], graph.num_poses());
    graph.AddScan(pose, 0, ranges);
  }
  const MapConsistency consistency = Measure(graph, poses);
  EXPECT_GT(consistency.between_passes.num_conflicting, 100);
  EXPECT_FALSE(consistency.IsContradictory()) << consistency.Ratio();
}

TEST(MapConsistency, APersonWhoWalksWithTheRobotCountsOnlyAsUsual) {
  SlamGraph graph;
  SyntheticScene scene = Corridor();
  const std::vector<Pose2> poses = BackAndForth(3);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    scene.poses = {poses[i]};
    // Ahead of it, from side to side.
    const Pose2 person = poses[i] * Pose2(2.0, std::sin(1.5 * static_cast<double>(i)), 0.0);
    scene.discs = {{person.translation(), 0.25}};
    const SlamGraph one = MakeGraph(scene);
    if (i == 0) {
      graph.AddLaser(scene.laser);
    }
    const int pose = graph.AddPose(poses[i], static_cast<double>(i));
    graph.AddScan(pose, 0, one.RangesOfScan(0, scene.laser.max_range_m));
  }
  const MapConsistency consistency = Measure(graph, poses);
  EXPECT_GT(consistency.worst_between.usual_ratio, 0.3);
  EXPECT_LT(consistency.usual_ratio_at_rest, 0.3 * consistency.worst_between.usual_ratio);
  RunOnParts(graph, 3, [&](const SlamGraph& part) {
    const MapConsistency shared = Measure(part, poses);
    EXPECT_EQ(shared.between_passes.num_compared, consistency.between_passes.num_compared);
    EXPECT_EQ(shared.between_passes.num_conflicting, consistency.between_passes.num_conflicting);
    EXPECT_EQ(shared.worst_between.usual_ratio, consistency.worst_between.usual_ratio);
    EXPECT_EQ(shared.usual_ratio_at_rest, consistency.usual_ratio_at_rest);
  });
}

TEST(MapConsistency, OnePassIsEnoughToBeRight) {
  SyntheticScene scene = Corridor();
  scene.poses = BackAndForth(1);
  const SlamGraph graph = MakeGraph(scene);
  const MapConsistency consistency = Measure(graph, scene.poses);
  EXPECT_EQ(consistency.num_pairs_between, 0);
  EXPECT_FALSE(consistency.IsContradictory());
  EXPECT_FALSE(Measure(SlamGraph(), {}).IsContradictory());
}

TEST(MapConsistency, ARobotAtRestDrivesNoPath) {
  SyntheticScene scene = Corridor();
  for (int i = 0; i < 2000; ++i) scene.poses.emplace_back(i % 2 == 0 ? 0.0 : 0.01, 0.0, 0.0);
  scene.laser = PanoramicLaser(8);
  const MapConsistency consistency = Measure(MakeGraph(scene), scene.poses);
  EXPECT_EQ(consistency.num_pairs_within, 0);
  EXPECT_EQ(consistency.num_pairs_between, 0);
}

TEST(MapConsistency, TheNumberOfPairsGrowsWithThePathOnly) {
  SyntheticScene scene = Corridor();
  scene.laser = PanoramicLaser(36);
  scene.poses = BackAndForth(50);
  const MapConsistency consistency = Measure(MakeGraph(scene), scene.poses);
  const int num_scans = static_cast<int>(scene.poses.size());
  EXPECT_GT(consistency.num_pairs_between, 7 * num_scans);
  EXPECT_LE(consistency.num_pairs_between, 8 * num_scans);
  EXPECT_LE(consistency.num_pairs_within, 4 * num_scans);
}

TEST(MapConsistency, TheNumberOfThreadsChangesNothing) {
  SyntheticScene scene = Corridor();
  scene.poses = BackAndForth(6);
  const SlamGraph graph = MakeGraph(scene);
  std::vector<Pose2> poses = scene.poses;
  for (std::size_t k = 60; k < poses.size(); ++k) poses[k].y += 0.6;
  const MapConsistency one = Measure(graph, poses, 1);
  for (const int num_threads : {2, 5}) {
    const MapConsistency many = Measure(graph, poses, num_threads);
    EXPECT_EQ(many.between_passes.num_compared, one.between_passes.num_compared);
    EXPECT_EQ(many.between_passes.num_conflicting, one.between_passes.num_conflicting);
    EXPECT_EQ(many.within_pass.num_compared, one.within_pass.num_compared);
    EXPECT_EQ(many.worst_between.pose, one.worst_between.pose);
    EXPECT_EQ(many.Ratio(), one.Ratio());
    ASSERT_EQ(many.places.size(), one.places.size());
    for (std::size_t i = 0; i < one.places.size(); ++i) {
      EXPECT_EQ(many.places[i].viewer_scan, one.places[i].viewer_scan);
      EXPECT_EQ(many.places[i].scan, one.places[i].scan);
      EXPECT_EQ(many.places[i].world_point, one.places[i].world_point);
    }
  }
}

void ExpectSame(const FreeSpaceConflict& conflict, const FreeSpaceConflict& expected) {
  EXPECT_EQ(conflict.num_compared, expected.num_compared);
  EXPECT_EQ(conflict.num_conflicting, expected.num_conflicting);
}

TEST(ConsistencyMeterTest, ProcessesThatShareAGraphMeasureTheSame) {
  SyntheticScene scene = Corridor();
  scene.faces.push_back({{2.0, 0.3}, {2.0, 1.5}});
  scene.poses = BackAndForth(3);
  const SlamGraph graph = MakeGraph(scene);
  std::vector<Pose2> poses = scene.poses;
  for (std::size_t i = 25; i < poses.size(); ++i) poses[i].y += 1.0;  // contradicts itself
  const MapConsistency expected = Measure(graph, poses);
  ASSERT_FALSE(expected.places.empty());
  RunOnParts(graph, 3, [&](const SlamGraph& part) {
    ASSERT_LT(part.num_scans(), graph.num_scans());
    const MapConsistency shared = Measure(part, poses);
    ExpectSame(shared.within_pass, expected.within_pass);
    ExpectSame(shared.between_passes, expected.between_passes);
    ExpectSame(shared.worst_between.conflict, expected.worst_between.conflict);
    EXPECT_EQ(shared.worst_between.pose, expected.worst_between.pose);
    EXPECT_EQ(shared.worst_between.usual_ratio, expected.worst_between.usual_ratio);
    EXPECT_EQ(shared.usual_ratio_at_rest, expected.usual_ratio_at_rest);
    EXPECT_EQ(shared.viewpoints.size(), expected.viewpoints.size());
    ASSERT_EQ(shared.places.size(), expected.places.size());
    for (std::size_t i = 0; i < shared.places.size(); ++i) {
      EXPECT_EQ(shared.places[i].viewer_scan, expected.places[i].viewer_scan);
      EXPECT_EQ(shared.places[i].scan, expected.places[i].scan);
      EXPECT_EQ(shared.places[i].world_point, expected.places[i].world_point);
    }
  });
}

}  // namespace
}  // namespace plumbline
