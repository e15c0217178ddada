#include "plumbline/solvers/front_end/frozen_laser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr double kInf = std::numeric_limits<double>::infinity();

// Range from a pose to walls at these x and y, all axis-parallel; infinite if none is met.
using Walls = std::vector<double>;
double RangeTo(const Walls& x, const Walls& y, const Pose2& from, double bearing_rad) {
  const double c = std::cos(from.yaw + bearing_rad), s = std::sin(from.yaw + bearing_rad);
  double range_m = kInf;
  const auto meet = [&range_m](double distance_m, double rate) {
    if (distance_m * rate > 1e-9) range_m = std::min(range_m, distance_m / rate);
  };
  for (const double wall : x) meet(wall - from.x, c);
  for (const double wall : y) meet(wall - from.y, s);
  return range_m;
}

class FrozenLaserTest : public testing::Test {
 protected:
  FrozenLaserTest() {
    LaserModel laser;
    laser.num_beams = 181;
    laser.first_bearing_rad = DegToRad(-90.0);
    laser.bearing_step_rad = DegToRad(1.0);
    laser.max_range_m = 30.0;
    lasers_.resize(2);
    lasers_[0] = graph_.AddLaser(laser);
    laser.robot_from_laser = {-0.2, 0.0, kPi};
    lasers_[1] = graph_.AddLaser(laser);
  }

  // A pose after a step, with a scan of a laser of the walls from there.
  void Add(const Pose2& step, int laser = 0) { AddScan(Move(step), laser, RangesAt(laser)); }
  // A pose after a step, where the laser hands out what it saw last.
  void AddFrozen(const Pose2& step, int laser = 0) { AddScan(Move(step), laser, last_[laser]); }

  int Move(const Pose2& step) {
    here_ = here_ * step;
    const int pose = graph_.AddPose(here_, graph_.num_poses());
    if (pose > 0) {
      graph_.AddOdometry({pose - 1, pose, step});
    }
    return pose;
  }
  void AddScan(int pose, int laser, const std::vector<double>& ranges) {
    graph_.AddScan(pose, lasers_[laser], ranges);
    last_[laser] = ranges;
  }
  std::vector<double> RangesAt(int laser) const {
    const LaserModel& model = graph_.laser(lasers_[laser]);
    std::vector<double> ranges;
    for (int beam = 0; beam < model.num_beams; ++beam) {
      const double range_m =
          RangeTo(walls_x_, walls_y_, here_ * model.robot_from_laser, model.Bearing(beam));
      ranges.push_back(rounding_m_ > 0.0 ? rounding_m_ * std::round(range_m / rounding_m_)
                                         : range_m);
    }
    return ranges;
  }
  std::vector<FrozenStretch> Find() const { return FindFrozenStretches(graph_); }

  SlamGraph graph_;
  Walls walls_x_{-3.0, 5.0}, walls_y_{-2.0, 4.0};
  double rounding_m_ = 0.01;
  Pose2 here_;

 private:
  std::vector<int> lasers_;
  std::vector<double> last_[2];
};

const Pose2 kAhead(0.05, 0.0, 0.0), kTurn(0.0, 0.0, 0.05), kRest;

TEST_F(FrozenLaserTest, FindsAStretchAsLongAsItIs) {
  for (int i = 0; i < 3; ++i) Add(kAhead);
  for (int i = 0; i < 4; ++i) AddFrozen(kAhead);
  AddFrozen(kTurn);
  for (int i = 0; i < 3; ++i) Add(kAhead);
  const std::vector<FrozenStretch> found = Find();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].laser, 0);
  EXPECT_EQ(found[0].first_scan, 2);
  EXPECT_EQ(found[0].last_scan, 7);
  EXPECT_EQ(found[0].num_repeated, 5);
  EXPECT_NEAR(found[0].moved_m, 0.2, 1e-12);
  EXPECT_NEAR(found[0].turned_rad, 0.05, 1e-12);
}

TEST_F(FrozenLaserTest, FindsEveryStretchInOrder) {
  for (int round = 0; round < 2; ++round) {
    Add(kAhead);
    for (int i = 0; i < 3; ++i) AddFrozen(kAhead);
    Add(kAhead);
    for (int i = 0; i < 4; ++i) AddFrozen(kTurn);
  }
  const std::vector<FrozenStretch> found = Find();
  ASSERT_THAT(found, SizeIs(4));
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(found[k].first_scan, 9 * (k / 2) + 4 * (k % 2)) << k;
    EXPECT_EQ(found[k].num_repeated, 3 + k % 2) << k;
  }
  EXPECT_EQ(found[3].last_scan, graph_.num_scans() - 1);
}

TEST_F(FrozenLaserTest, ADriveWithAnHonestLaserHasNone) {
  for (const double rounding_m : {0.0, 0.01, 0.05}) {
    rounding_m_ = rounding_m;
    for (int i = 0; i < 20; ++i) Add(i % 5 == 0 ? kTurn : kAhead);
  }
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(FrozenLaserTest, ARobotAtRestMayShowTheSameAgainAndAgain) {
  for (int i = 0; i < 3000; ++i) Add(kRest);
  EXPECT_THAT(Find(), IsEmpty());
  // So does one whose odometry trembles, or drifts: 0.3 m and 0.3 rad over this rest.
  for (int i = 0; i < 3000; ++i) AddFrozen({i % 2 == 0 ? 2e-3 : -2e-3, 0.0, 0.0});
  for (int i = 0; i < 3000; ++i) AddFrozen({1e-4, 0.0, 1e-4});
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(FrozenLaserTest, ShortStepsOfAFastLaserAddUp) {
  Add(kAhead);
  for (int i = 0; i < 10; ++i) AddFrozen({0.005, 0.0, 0.0});
  EXPECT_THAT(Find(), IsEmpty());  // 5 cm, which the coarsest laser could round away
  for (int i = 0; i < 5; ++i) AddFrozen({0.005, 0.0, 0.0});
  ASSERT_THAT(Find(), SizeIs(1));
  EXPECT_EQ(Find()[0].num_repeated, 15);
}

TEST_F(FrozenLaserTest, AlongABareCorridorEqualScansAreRight) {
  walls_x_.clear();
  for (const double rounding_m : {0.0, 0.01, 0.05}) {
    rounding_m_ = rounding_m;
    Add(kAhead);
    for (int i = 0; i < 40; ++i) Add({0.1, 0.0, 0.0});
    EXPECT_THAT(Find(), IsEmpty()) << rounding_m;
  }
  for (int i = 0; i < 4; ++i) AddFrozen({0.0, 0.05, 0.0});
  EXPECT_THAT(Find(), SizeIs(1));  // across, the walls come nearer
}

TEST_F(FrozenLaserTest, TheEndOfACorridorIsEnough) {
  walls_x_ = {10.0};
  walls_y_ = {-1.0, 1.0};
  Add(kAhead);
  AddFrozen({0.3, 0.0, 0.0});
  EXPECT_THAT(Find(), SizeIs(1));
}

TEST_F(FrozenLaserTest, AFewReturnsProveNothing) {
  std::vector<double> ranges(181, kInf);
  for (int beam = 80; beam < 99; ++beam) ranges[beam] = 3.0;
  const auto drive = [&] {
    for (int i = 0; i < 5; ++i) AddScan(Move({0.1, 0.0, 0.0}), 0, ranges);
  };
  drive();
  EXPECT_THAT(Find(), IsEmpty());
  ranges[99] = 3.0;
  drive();
  ASSERT_THAT(Find(), SizeIs(1));
  EXPECT_EQ(Find()[0].first_scan, 5);
}

TEST_F(FrozenLaserTest, OneOtherReadingIsProofOfLife) {
  Add(kAhead);
  std::vector<double> ranges = RangesAt(0);
  for (int i = 0; i < 5; ++i) {
    ranges[17] = std::nextafter(static_cast<float>(ranges[17]), 0.0F);
    AddScan(Move({0.1, 0.0, 0.0}), 0, ranges);
  }
  EXPECT_THAT(Find(), IsEmpty());
  // So is a beam more without a return, or another beam.
  ranges[20] = kInf;
  AddScan(Move({0.1, 0.0, 0.0}), 0, ranges);
  std::swap(ranges[20], ranges[21]);
  AddScan(Move({0.1, 0.0, 0.0}), 0, ranges);
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(FrozenLaserTest, LasersFreezeEachByItself) {
  Add(kAhead, 0);
  Add(kAhead, 1);
  for (int i = 0; i < 3; ++i) {
    Add(kAhead, 0);
    AddFrozen(kAhead, 1);
  }
  const std::vector<FrozenStretch> found = Find();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].laser, 1);
  EXPECT_EQ(found[0].first_scan, 1);
  EXPECT_EQ(found[0].num_repeated, 3);
  EXPECT_NEAR(found[0].moved_m, 0.3, 1e-12);
}

TEST_F(FrozenLaserTest, WithoutOdometryNobodyKnows) {
  const std::vector<double> ranges = RangesAt(0);
  for (int i = 0; i < 5; ++i) {
    const int pose = graph_.AddPose(Pose2(0.5 * i, 0.0, 0.0), i);
    AddScan(pose, 0, ranges);
  }
  EXPECT_THAT(Find(), IsEmpty());
  EXPECT_THAT(FindFrozenStretches(SlamGraph()), IsEmpty());
}

TEST_F(FrozenLaserTest, RepetitionsLoseTheirReturnsAndNothingElse) {
  Add(kAhead);
  AddFrozen(kAhead);
  AddFrozen(kAhead);
  Add(kAhead);
  graph_.AddRelativePose({0, 3, Pose2(0.3, 0.0, 0.0)});
  SlamGraph graph = graph_;
  std::vector<FrozenStretch> frozen;
  DropRepeatedScans(&graph, &frozen);
  ASSERT_THAT(frozen, SizeIs(1));
  ASSERT_EQ(graph.num_scans(), graph_.num_scans());
  ASSERT_EQ(graph.num_poses(), graph_.num_poses());
  EXPECT_EQ(graph.initial_poses(), graph_.initial_poses());
  EXPECT_EQ(graph.odometry().size(), graph_.odometry().size());
  EXPECT_EQ(graph.relative_poses().size(), 1u);
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    const bool is_repeated = scan == 1 || scan == 2;
    EXPECT_EQ(graph.scan(scan).num_returns, is_repeated ? 0u : graph_.scan(scan).num_returns);
    EXPECT_EQ(graph.scan(scan).pose, graph_.scan(scan).pose);
    EXPECT_EQ(graph.timestamp_s(graph.scan(scan).pose), graph_.timestamp_s(graph_.scan(scan).pose));
  }
  // A sound graph is left alone.
  SlamGraph again = graph;
  DropRepeatedScans(&again, &frozen);
  EXPECT_THAT(frozen, IsEmpty());
  EXPECT_EQ(again.InitialState().points, graph.InitialState().points);
}

}  // namespace
}  // namespace plumbline
