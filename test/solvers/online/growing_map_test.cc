#include "plumbline/solvers/online/growing_map.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/solvers/association/noise_scales.h"

namespace plumbline {
namespace {

// A whole drive, which comes back to where it was.
SlamGraph LoopDrive() {
  SimulationOptions options;
  options.scan_period_s = 1.0;
  options.laser.num_beams = 180;
  options.laser.bearing_step_rad = DegToRad(1.0);
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
  SlamGraph graph;
  EXPECT_TRUE(MakeGraph(log, &graph).ok());
  return graph;
}

TEST(GrowingMapTest, ClosesLoopsAndTakesOverASeeding) {
  const SlamGraph drive = LoopDrive();
  const MotionOptions motion;
  const ReturnNormalOptions normals = NormalOptionsFor(RangeBeamOptions());
  ThreadPool pool(1);
  LiveMatching matching{SeedingOptions(), motion, normals};
  GrowingMap map({drive.laser(0)}, motion);
  const int half = drive.num_scans() / 2;
  SeededDrive seeded;
  for (int scan = 0; scan < drive.num_scans(); ++scan) {
    LiveScan live;
    const int pose = live.measured.AddPose(drive.InitialPose(scan), drive.timestamp_s(scan));
    live.measured.AddScanOf(drive, scan, pose);
    ASSERT_TRUE(live.measured.status().ok());
    if (scan > 0) live.step = drive.odometry()[scan - 1].from_from_to;
    matching.Match(&live);
    ASSERT_TRUE(map.Add(live).ok());
    if (scan + 1 == half) {
      SlamGraph log;
      ASSERT_TRUE(map.MakeLog({}, &log).ok());
      SeedingReport report;
      ASSERT_TRUE(SeedDrive(SeedingOptions(), motion, MeasureSurface(log, normals, &pool), {},
                            &pool, log, &seeded, &report)
                      .ok());
    }
    ASSERT_TRUE(map.CloseLoops({}, &pool).ok());
  }
  EXPECT_GT(map.num_closures(), 10);
  EXPECT_GT(map.largest_correction_m(), 0.0);

  const int num_keyframes = map.num_keyframes();
  const std::vector<Pose2> seeded_poses = seeded.world_from_robot;
  map.Adopt(std::move(seeded), motion);
  EXPECT_EQ(map.num_poses(), drive.num_poses());
  EXPECT_NEAR(map.num_keyframes(), num_keyframes, 0.1 * num_keyframes);
  EXPECT_EQ(map.largest_correction_m(), 0.0);
  std::vector<Pose2> poses = map.Poses();
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(drive.num_poses()));
  for (int pose = 0; pose < half; ++pose) {
    EXPECT_NEAR(poses[pose].x, seeded_poses[pose].x, 1e-9) << pose;
    EXPECT_NEAR(poses[pose].y, seeded_poses[pose].y, 1e-9) << pose;
  }
  const int num_closures = map.num_closures();
  ASSERT_TRUE(map.CloseLoops({}, &pool).ok());
  EXPECT_GT(map.num_closures(), num_closures);
}

TEST(GrowingMapTest, StopsWhenAsked) {
  const SlamGraph drive = LoopDrive();
  ThreadPool pool(1);
  LiveMatching matching{SeedingOptions(), MotionOptions(), NormalOptionsFor(RangeBeamOptions())};
  GrowingMap map({drive.laser(0)}, MotionOptions());
  for (int scan = 0; scan < drive.num_scans(); ++scan) {
    LiveScan live;
    const int pose = live.measured.AddPose(drive.InitialPose(scan), drive.timestamp_s(scan));
    live.measured.AddScanOf(drive, scan, pose);
    ASSERT_TRUE(live.measured.status().ok());
    if (scan > 0) live.step = drive.odometry()[scan - 1].from_from_to;
    matching.Match(&live);
    ASSERT_TRUE(map.Add(live).ok());
  }
  const Status status = map.CloseLoops([](SeedingPhase, int, int) { return false; }, &pool);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_EQ(map.num_closures(), 0);
  EXPECT_TRUE(map.CloseLoops({}, &pool).ok());
  EXPECT_GT(map.num_closures(), 0);
}

}  // namespace
}  // namespace plumbline
