#include "plumbline/solvers/seeding/seed_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/partition.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

enum class Trouble { kNone, kCarried, kSlip, kSignLost, kPeople };

struct Case {
  const char* name;
  std::uint64_t seed;
  Trouble trouble;
  double scan_period_s;
};

void PrintTo(const Case& drive, std::ostream* stream) { *stream << drive.name; }

SlamGraph DriveWith(const Case& drive) {
  SimulationOptions options;
  options.seed = drive.seed;
  options.scan_period_s = drive.scan_period_s;
  if (drive.trouble == Trouble::kCarried) options.carry = {60.0, 4.0};
  if (drive.trouble == Trouble::kSlip) {
    options.odometry_leap = {60.0, 1.5};
    options.odometry_leap_duration_s = 6.0;
  }
  if (drive.trouble == Trouble::kPeople) options.traffic = {4, false};
  SimulatedLog log;
  EXPECT_TRUE(
      Simulate(World(GenerateBuilding(BuildingKind::kRandom, drive.seed)), options, &log).ok());
  SlamGraph graph;
  EXPECT_TRUE(MakeGraph(log, &graph).ok());
  if (drive.trouble != Trouble::kSignLost) return graph;
  MeasurementCorrections lost;
  for (const OdometryConstraint& step : graph.odometry()) {
    lost.odometry.push_back(step.from_from_to);
    lost.odometry.back().x = std::abs(lost.odometry.back().x);
  }
  return graph.Corrected(lost);
}

bool SameNormals(const MeasuredSurface& a, const MeasuredSurface& b) {
  return a.normals.size() == b.normals.size() &&
         std::equal(a.normals.begin(), a.normals.end(), b.normals.begin(),
                    [](const ReturnNormal& normal, const ReturnNormal& other) {
                      return normal.Direction() == other.Direction();
                    });
}

class SeedSharedDriveTest : public testing::TestWithParam<Case> {};

// Steps, closures, hypotheses and poses.
void ExpectSame(const SeedingReport& report, const SeedingReport& expected) {
  EXPECT_EQ(report.sequential.num_keyframes, expected.sequential.num_keyframes);
  EXPECT_EQ(report.sequential.num_recovered, expected.sequential.num_recovered);
  EXPECT_EQ(report.sequential.num_unmatched, expected.sequential.num_unmatched);
  EXPECT_EQ(report.sequential.odometry_sign.num_decided,
            expected.sequential.odometry_sign.num_decided);
  EXPECT_EQ(report.sequential.odometry_sign.sign_lost, expected.sequential.odometry_sign.sign_lost);
  EXPECT_EQ(report.loops.num_candidates, expected.loops.num_candidates);
  EXPECT_EQ(report.loops.num_closures, expected.loops.num_closures);
  ASSERT_EQ(report.loops.suspect_steps.size(), expected.loops.suspect_steps.size());
  for (std::size_t i = 0; i < report.loops.suspect_steps.size(); ++i) {
    EXPECT_EQ(report.loops.suspect_steps[i].first_pose_after,
              expected.loops.suspect_steps[i].first_pose_after);
  }
  ASSERT_EQ(report.hypotheses.size(), expected.hypotheses.size());
  for (std::size_t i = 0; i < report.hypotheses.size(); ++i) {
    EXPECT_EQ(report.hypotheses[i].score, expected.hypotheses[i].score);
  }
  EXPECT_EQ(report.pose_graph.size(), expected.pose_graph.size());
  EXPECT_EQ(report.moving_share, expected.moving_share);
  EXPECT_EQ(report.corrections.moving_returns, expected.corrections.moving_returns);
  EXPECT_EQ(report.corrections.odometry.back().x, expected.corrections.odometry.back().x);
  EXPECT_EQ(report.consistency.between_passes.num_compared,
            expected.consistency.between_passes.num_compared);
  EXPECT_EQ(report.consistency.between_passes.num_conflicting,
            expected.consistency.between_passes.num_conflicting);
}

// What it takes to go on closing loops.
void ExpectSame(const SeededDrive& drive, const SeededDrive& expected) {
  EXPECT_EQ(PoseArray(drive.matched.world_from_robot),
            PoseArray(expected.matched.world_from_robot));
  EXPECT_EQ(PoseArray(drive.matched.odometry), PoseArray(expected.matched.odometry));
  EXPECT_EQ(ScansOf(drive.matched.keyframes), ScansOf(expected.matched.keyframes));
  EXPECT_EQ(ScansOf(drive.keys.keyframes), ScansOf(expected.keys.keyframes));
  EXPECT_EQ(PoseArray(drive.keys.world_from_key), PoseArray(expected.keys.world_from_key));
  EXPECT_EQ(drive.keys.closures.size(), expected.keys.closures.size());
  ASSERT_EQ(drive.surfaces.size(), expected.surfaces.size());
  for (const int scan : ScansOf(drive.keys.keyframes)) {
    EXPECT_EQ(drive.surfaces[scan].Unpacked().size(), expected.surfaces[scan].Unpacked().size());
  }
}

TEST_P(SeedSharedDriveTest, IsTheSeedOfOneProcess) {
  const SlamGraph whole = DriveWith(GetParam());
  const ReturnNormalOptions normals = NormalOptionsFor(RangeBeamOptions());
  ThreadPool pool(1);
  SeededDrive expected;
  SeedingReport expected_report;
  ASSERT_TRUE(SeedDrive(SeedingOptions(), MotionOptions(), MeasureSurface(whole, normals, &pool),
                        nullptr, &pool, whole, &expected, &expected_report)
                  .ok());
  const int size = GetParam().trouble == Trouble::kSlip ? 20 : 3;
  RunOnPeers(size, [&](const Peers& peers) {
    SlamGraph part = whole;
    ASSERT_TRUE(ShareGraph(&peers, PartitionByTime(whole.num_poses(), size), &part).ok());
    ThreadPool one_thread(1);
    SeededDrive drive;
    SeedingReport report;
    MeasuredSurface surface = MeasureSurface(part, normals, &one_thread);
    ASSERT_TRUE(SeedSharedDrive(SeedingOptions(), MotionOptions(), nullptr, &one_thread, &part,
                                &surface, &drive, &report)
                    .ok());
    EXPECT_EQ(report.moving_share > 0.05, GetParam().trouble == Trouble::kPeople);
    ExpectSame(report, expected_report);
    const std::vector<Pose2>& poses = drive.world_from_robot;
    ASSERT_EQ(poses.size(), expected.world_from_robot.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(poses[i].x, expected.world_from_robot[i].x);
      EXPECT_EQ(poses[i].y, expected.world_from_robot[i].y);
      EXPECT_EQ(poses[i].yaw, expected.world_from_robot[i].yaw);
    }
    ExpectSame(drive, expected);
    EXPECT_TRUE(SameNormals(surface, MeasureSurface(part, normals, &one_thread)));
  });
}

INSTANTIATE_TEST_SUITE_P(Drives, SeedSharedDriveTest,
                         testing::Values(Case{"Sound", 3, Trouble::kNone, 0.15},
                                         Case{"Carried", 5, Trouble::kCarried, 0.5},
                                         Case{"Slip", 7, Trouble::kSlip, 0.5},
                                         Case{"SignLost", 4, Trouble::kSignLost, 0.5},
                                         Case{"People", 6, Trouble::kPeople, 0.45}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace plumbline
