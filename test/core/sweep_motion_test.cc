#include "plumbline/core/sweep_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

void ExpectNear(const Pose2& a, const Pose2& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(NormalizeAngle(a.yaw - b.yaw), 0.0, tolerance);
}

TEST(PartOfMotionTest, PartsMakeTheWhole) {
  for (const Pose2& motion : {Pose2(1.0, 0.2, 0.0), Pose2(0.5, -0.3, 1e-8), Pose2(0.4, 0.1, 0.8),
                              Pose2(0.1, 0.3, -2.5)}) {
    ExpectNear(PartOfMotion(motion, 0.0), Pose2(), 1e-15);
    ExpectNear(PartOfMotion(motion, 1.0), motion, 1e-12);
    ExpectNear(PartOfMotion(motion, 0.3) * PartOfMotion(motion, 0.7), motion, 1e-12);
    ExpectNear(PartOfMotion(motion, 2.0), motion * motion, 1e-12);
    ExpectNear(PartOfMotion(motion, -1.0), motion.Inverse(), 1e-12);
  }
}

TEST(PartOfMotionTest, FollowsACircle) {
  // A quarter of a circle of radius 2, driven forwards.
  const Pose2 half = PartOfMotion({2.0, 2.0, 0.5 * kPi}, 0.5);
  ExpectNear(half, {2.0 * std::sin(0.25 * kPi), 2.0 - 2.0 * std::cos(0.25 * kPi), 0.25 * kPi},
             1e-12);
}

constexpr int kNumBeams = 8;
constexpr double kPeriodS = 0.1;

// A robot that drives an arc while its laser sweeps.
struct Arc {
  Pose2 step{0.2, 0.02, 0.3};  // per kPeriodS
  Pose2 robot_from_laser{0.1, 0.05, 0.4};

  LaserModel Laser(double beam_period_s) const {
    LaserModel laser;
    laser.num_beams = kNumBeams;
    laser.first_bearing_rad = -1.0;
    laser.bearing_step_rad = 0.25;
    laser.beam_period_s = beam_period_s;
    laser.robot_from_laser = robot_from_laser;
    return laser;
  }
  Pose2 At(double time_s) const { return PartOfMotion(step, time_s / kPeriodS); }
};

// The beams of a sweep that starts at a time, all 5 m long.
SlamGraph Swept(const Arc& arc, const std::vector<double>& times_s) {
  SlamGraph graph;
  const int laser = graph.AddLaser(arc.Laser(0.01));
  for (const double time_s : times_s) {
    const int pose = graph.AddPose(arc.At(time_s), time_s);
    graph.AddScan(pose, laser, std::vector<double>(kNumBeams, 5.0));
  }
  return graph;
}

// How far the returns of a scan, seen from its pose, are from where their beams really ended.
double WorstError(const Arc& arc, const SlamGraph& measured, const SlamGraph& corrected, int scan) {
  double worst_m = 0.0;
  const double time_s = measured.timestamp_s(scan);
  for (int beam = 0; beam < kNumBeams; ++beam) {
    const std::size_t r = measured.scan(scan).first_return + beam;
    const Eigen::Vector2d truth = arc.At(time_s + 0.01 * beam) * measured.PointInRobot(r);
    worst_m = std::max(worst_m, (arc.At(time_s) * corrected.PointInRobot(r) - truth).norm());
  }
  return worst_m;
}

TEST(SweepMotionTest, EveryReturnIsPlacedByThePoseAtItsTime) {
  const Arc arc;
  const SlamGraph measured = Swept(arc, {0.0, 0.1, 0.25});
  EXPECT_TRUE(HasSweeps(measured));
  const SlamGraph corrected = measured.Corrected(
      TakeOutSweepMotion(measured, SweepOrder::kFirstBeamFirst, measured.initial_poses()));
  // The last pose goes on as before it.
  for (int scan = 0; scan < 3; ++scan) {
    EXPECT_GT(WorstError(arc, measured, measured, scan), 0.1);
    EXPECT_LT(WorstError(arc, measured, corrected, scan), 1e-6);
  }
}

TEST(SweepMotionTest, FollowsThePosesThatAreGiven) {
  const Arc arc;
  const SlamGraph measured = Swept(arc, {0.0, 0.1});
  const std::vector<double> at_rest(measured.initial_poses().size(), 0.0);
  const MeasurementCorrections corrections =
      TakeOutSweepMotion(measured, SweepOrder::kFirstBeamFirst, at_rest);
  for (std::size_t r = 0; r < measured.num_returns(); ++r) {
    EXPECT_NEAR(corrections.range_m[r], measured.returns().range_m[r], 1e-12);
    EXPECT_NEAR(corrections.bearing_rad[r], measured.Bearing(r), 1e-12);
  }
}

TEST(SweepMotionTest, ReturnsStayWhereNobodyKnowsTheMotion) {
  const Arc arc;
  for (const std::vector<double>& times_s :
       {std::vector<double>{0.0, 1.5}, std::vector<double>{3.0, 3.0}, std::vector<double>{7.0}}) {
    const SlamGraph measured = Swept(arc, times_s);
    const MeasurementCorrections corrections =
        TakeOutSweepMotion(measured, SweepOrder::kFirstBeamFirst, measured.initial_poses());
    EXPECT_THAT(corrections.range_m, testing::ElementsAreArray(measured.returns().range_m));
    EXPECT_EQ(corrections.bearing_rad, measured.Bearings());
  }
}

TEST(SweepMotionTest, LasersThatMeasureAtOnceHaveNoSweeps) {
  SlamGraph graph;
  graph.AddLaser(Arc().Laser(0.0));
  EXPECT_FALSE(HasSweeps(graph));
}

// One sweep after the other, as a program on a robot gets them.
TEST(AddSweepTest, ReturnsAreWhereTheirBeamsEnded) {
  const Arc arc;
  const SlamGraph measured = Swept(arc, {0.0});
  for (const SweepOrder order : {SweepOrder::kFirstBeamFirst, SweepOrder::kLastBeamFirst}) {
    SlamGraph graph;
    const int laser = graph.AddLaser(arc.Laser(0.0));
    const int pose = graph.AddPose(Pose2(), 0.0);
    const std::vector<double> ranges(kNumBeams, 5.0);
    graph.AddSweep(pose, laser, ranges, arc.At(0.01 * kNumBeams), order);
    EXPECT_FALSE(HasSweeps(graph));
    ASSERT_EQ(graph.num_returns(), static_cast<std::size_t>(kNumBeams));
    for (int beam = 0; beam < kNumBeams; ++beam) {
      const int before = order == SweepOrder::kFirstBeamFirst ? beam : kNumBeams - 1 - beam;
      const Eigen::Vector2d truth = arc.At(0.01 * before) * measured.PointInRobot(beam);
      EXPECT_LT((graph.PointInRobot(beam) - truth).norm(), 1e-6) << beam;
      EXPECT_EQ(graph.Beam(beam), beam);
    }
  }
}

TEST(AddSweepTest, KeepsReturnsOfTheLaserOnly) {
  LaserModel laser = Arc().Laser(0.0);
  laser.max_range_m = 6.0;
  SlamGraph graph;
  const int id = graph.AddLaser(laser);
  const int pose = graph.AddPose(Pose2(), 0.0);
  std::vector<double> ranges(kNumBeams, 7.0);
  ranges[3] = 5.9;  // beyond 6 m as seen from the beginning
  graph.AddSweep(pose, id, ranges, Pose2(2.0, 0.0, 0.0));
  ASSERT_EQ(graph.num_returns(), 1u);
  EXPECT_EQ(graph.Beam(0), 3);
  EXPECT_TRUE(laser.IsReturn(graph.returns().range_m[0]));
  // At once: as measured.
  graph.AddSweep(pose, id, ranges, Pose2(2.0, 0.0, 0.0), SweepOrder::kAtOnce);
  EXPECT_EQ(graph.returns().range_m[1], 5.9F);
}

TEST(AddSweepTest, RefusesWhatWouldBeTakenOutTwiceAndWhatIsNoMotion) {
  SlamGraph graph;
  const int swept = graph.AddLaser(Arc().Laser(0.01));
  const int at_once = graph.AddLaser(Arc().Laser(0.0));
  const int pose = graph.AddPose(Pose2(), 0.0);
  const std::vector<double> ranges(kNumBeams, 5.0);
  EXPECT_EQ(graph.AddSweep(pose, swept, ranges, Pose2()), -1);
  EXPECT_NE(graph.TakeStatus().message().find("beam_period_s"), std::string::npos);
  EXPECT_EQ(graph.AddSweep(pose, at_once, ranges, Pose2(NAN, 0.0, 0.0)), -1);
  EXPECT_NE(graph.TakeStatus().message().find("scan 0: its motion"), std::string::npos);
  EXPECT_EQ(graph.AddSweep(pose, at_once, {5.0}, Pose2()), -1);
  EXPECT_NE(graph.TakeStatus().message().find("scan 0: 1 ranges"), std::string::npos);
  EXPECT_EQ(graph.AddSweep(1, at_once, ranges, Pose2()), -1);
  EXPECT_NE(graph.TakeStatus().message().find("scan 0: no pose"), std::string::npos);
  EXPECT_EQ(graph.num_scans(), 0);
}

}  // namespace
}  // namespace plumbline
