#include "plumbline/solvers/online/live_matching.h"

#include <gtest/gtest.h>

#include <cstddef>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/online/growing_map.h"

namespace plumbline {
namespace {

// Short enough for the seeding to match it in one stretch.
SlamGraph ShortDrive() {
  SimulationOptions options;
  options.scan_period_s = 0.5;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
  log.scans.resize(150);
  SlamGraph graph;
  EXPECT_TRUE(MakeGraph(log, &graph).ok());
  return graph;
}

LiveScan ScanOf(const SlamGraph& drive, int scan) {
  LiveScan live;
  const int pose = live.measured.AddPose(drive.InitialPose(scan), drive.timestamp_s(scan));
  live.measured.AddScanOf(drive, scan, pose);
  EXPECT_TRUE(live.measured.status().ok());
  if (scan > 0) live.step = drive.odometry()[scan - 1].from_from_to;
  return live;
}

TEST(LiveMatchingTest, MatchesAsTheSeedingDoes) {
  const SlamGraph drive = ShortDrive();
  const MotionOptions motion;
  const ReturnNormalOptions normals = NormalOptionsFor(RangeBeamOptions());
  ThreadPool pool(1);
  const MeasuredSurface surface = MeasureSurface(drive, normals, &pool);
  ScanSurfaces surfaces(drive, surface);
  SequentialTrajectory batch;
  SequentialSeedingReport report;
  ASSERT_TRUE(
      SeedSequentially(SeedingOptions(), motion, {}, &pool, &surfaces, &batch, &report).ok());

  LiveMatching matching{SeedingOptions(), motion, normals};
  GrowingMap map({drive.laser(0)}, motion);
  std::size_t num_keyframes = 0;
  for (int scan = 0; scan < drive.num_scans(); ++scan) {
    LiveScan live = ScanOf(drive, scan);
    matching.Match(&live);
    if (live.keyframe) {
      ASSERT_LT(num_keyframes, batch.keyframes.size());
      EXPECT_EQ(live.keyframe->pose, batch.keyframes[num_keyframes].pose);
      EXPECT_EQ(live.key_surface->size(), surfaces.Kept(scan).size());
      ++num_keyframes;
    }
    ASSERT_TRUE(map.Add(live).ok());
  }
  ASSERT_EQ(matching.poses().size(), batch.world_from_robot.size());
  for (std::size_t i = 0; i < batch.world_from_robot.size(); ++i) {
    EXPECT_EQ(matching.poses()[i].x, batch.world_from_robot[i].x) << i;
    EXPECT_EQ(matching.poses()[i].yaw, batch.world_from_robot[i].yaw) << i;
  }
  EXPECT_EQ(num_keyframes, batch.keyframes.size());

  EXPECT_EQ(map.num_keyframes(), static_cast<int>(num_keyframes));
  const std::vector<Pose2> poses = map.Poses();
  ASSERT_EQ(poses.size(), batch.world_from_robot.size());
  EXPECT_NEAR(poses.back().x, batch.world_from_robot.back().x, 1e-9);
  SlamGraph log;
  ASSERT_TRUE(map.MakeLog({}, &log).ok());
  ASSERT_EQ(log.odometry().size(), drive.odometry().size());
  EXPECT_EQ(log.odometry().back().from_from_to.x, drive.odometry().back().from_from_to.x);
  EXPECT_EQ(log.returns().range_m, drive.returns().range_m);
}

TEST(LiveMatchingTest, TakesTheScaleOutOfTheOdometry) {
  const SlamGraph drive = ShortDrive();
  const ReturnNormalOptions normals = NormalOptionsFor(RangeBeamOptions());
  LiveMatching right{SeedingOptions(), MotionOptions(), normals};
  LiveMatching scaled{SeedingOptions(), MotionOptions(), normals};
  scaled.SetOdometryFaults({false, 2.0});
  for (int scan = 0; scan < 20; ++scan) {
    LiveScan live = ScanOf(drive, scan);
    right.Match(&live);
    LiveScan twice = ScanOf(drive, scan);
    if (scan > 0) {
      twice.step->x *= 2.0;
      twice.step->y *= 2.0;
    }
    scaled.Match(&twice);
  }
  EXPECT_EQ(right.poses().back().x, scaled.poses().back().x);
}

}  // namespace
}  // namespace plumbline
