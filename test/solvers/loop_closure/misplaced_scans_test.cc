#include "plumbline/solvers/loop_closure/misplaced_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/doorway_drive.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

double ErrorM(const MisplacedScan& scan, const DoorwayDrive& drive) {
  return DistanceM(scan.world_from_robot, drive.graph.InitialPose(scan.pose));
}

std::vector<MisplacedScan> Find(const SlamGraph& graph, const DoorwayDrive& drive,
                                int num_threads = 2) {
  const MeasuredSurface surface = SurfaceOf(graph);
  ThreadPool pool(num_threads);
  return FindMisplacedScans(ScanSurfaces(graph, surface), drive.odometry, MotionOptions(),
                            drive.poses, &pool);
}

std::vector<MisplacedScan> Find(const DoorwayDrive& drive) { return Find(drive.graph, drive); }

TEST(MisplacedScansTest, ASingleScanIsFoundEitherWay) {
  for (const double along_m : {-0.25, 0.25, 0.6}) {
    DoorwayDrive drive = DriveAlongDoors();
    drive.Misplace(30, 30, along_m);
    const std::vector<MisplacedScan> found = Find(drive);
    ASSERT_THAT(found, SizeIs(1)) << along_m;
    EXPECT_EQ(found[0].pose, 30);
    EXPECT_LT(ErrorM(found[0], drive), 0.02);
  }
}

TEST(MisplacedScansTest, ScansThatAgreeWithEachOtherAreFoundByThoseOfAnotherPass) {
  DoorwayDrive drive = DriveAlongDoors();
  drive.Misplace(25, 34, -0.3);
  const std::vector<MisplacedScan> found = Find(drive);
  ASSERT_THAT(found, SizeIs(10));
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(found[i].pose, 25 + i);
    EXPECT_LT(ErrorM(found[i], drive), 0.02) << found[i].pose;
  }
}

TEST(MisplacedScansTest, ARightMapHasNone) {
  EXPECT_THAT(Find(DriveAlongDoors()), IsEmpty());
  // Not even where the odometry says otherwise.
  DoorwayDrive slipped = DriveAlongDoors();
  for (int p = 25; p < 35; ++p) slipped.odometry[p] = Pose2(0.02, 0.0, 0.0);
  EXPECT_THAT(Find(slipped), IsEmpty());
}

TEST(MisplacedScansTest, WhereNothingTellsNothingIsFound) {
  DoorwayDrive bare = DriveAlongDoors({});
  bare.Misplace(30, 30, 0.3);
  EXPECT_THAT(Find(bare), IsEmpty());
  // Nor where nobody else has been.
  DoorwayDrive lonely = DriveAlongDoors();
  for (int p = 0; p < DoorwayDrive::kNumPoses; ++p) lonely.odometry[p] = Pose2();
  lonely.Misplace(30, 30, 0.3);
  EXPECT_THAT(Find(lonely), IsEmpty());
}

TEST(MisplacedScansTest, AScanThatIsTurnedOrAsideIsNotMovedAlongABareCorridor) {
  DoorwayDrive bare = DriveAlongDoors({});
  bare.odometry[30] = Pose2(0.45, 0.0, 0.0);
  for (const Pose2& off : {Pose2(0.0, 0.0, 0.05), Pose2(0.0, 0.15, 0.0), Pose2(0.0, -0.2, 0.03)}) {
    const Pose2 right = bare.poses[30];
    bare.poses[30] = right * off;
    for (const MisplacedScan& scan : Find(bare)) EXPECT_LT(ErrorM(scan, bare), 0.05);
    bare.poses[30] = right;
  }
}

TEST(MisplacedScansTest, AScanThatFitsElsewhereDoesNotLeapThereAndBack) {
  // The frames that a scan of a corridor saw were seen again 0.4 m farther: somebody moved them, or
  // it is another door. The steps around it are longer than by the odometry, but even.
  DoorwayDrive drive = DriveAlongDoors();
  for (int p = 20; p < 40; ++p) drive.odometry[p].x -= 0.03;
  const DoorwayDrive elsewhere = DriveAlongDoors({-7.7, -4.8, -3.0, 0.1, 2.3, 3.5, 6.6, 8.7});
  std::vector<SurfacePoints> surfaces = SurfacesOf(drive.graph);
  const std::vector<SurfacePoints> others = SurfacesOf(elsewhere.graph);
  const auto find = [&] {
    ThreadPool pool(2);
    return FindMisplacedScans(ScanSurfaces(drive.graph, Packed(surfaces)), drive.odometry,
                              MotionOptions(), drive.poses, &pool);
  };
  surfaces[30] = others[30];
  EXPECT_THAT(find(), IsEmpty());
  // Where many say so, and the robot has only once moved otherwise than it knows, it is believed.
  drive.Misplace(25, 34, -0.4);
  surfaces[30] = SurfacesOf(drive.graph)[30];
  EXPECT_THAT(find(), SizeIs(10));
}

TEST(MisplacedScansTest, AFixedPoseStays) {
  DoorwayDrive drive = DriveAlongDoors();
  drive.Misplace(30, 31, 0.3);
  drive.graph.FixPose(30, drive.poses[30]);
  const std::vector<MisplacedScan> found = Find(drive);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].pose, 31);
}

TEST(MisplacedScansTest, ThreadsAndProcessesFindTheSame) {
  DoorwayDrive drive = DriveAlongDoors();
  drive.Misplace(30, 33, 0.3);
  drive.Misplace(90, 90, -0.3);
  const std::vector<MisplacedScan> expected = Find(drive);
  ASSERT_THAT(expected, SizeIs(5));
  const auto expect_same = [&](const std::vector<MisplacedScan>& found) {
    ASSERT_THAT(found, SizeIs(expected.size()));
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].pose, expected[i].pose);
      EXPECT_EQ(found[i].world_from_robot.x, expected[i].world_from_robot.x);
      EXPECT_EQ(found[i].world_from_robot.y, expected[i].world_from_robot.y);
      EXPECT_EQ(found[i].world_from_robot.yaw, expected[i].world_from_robot.yaw);
    }
  };
  expect_same(Find(drive.graph, drive, 1));
  RunOnParts(drive.graph, 3, [&](const SlamGraph& part) { expect_same(Find(part, drive, 1)); });
}

}  // namespace
}  // namespace plumbline
