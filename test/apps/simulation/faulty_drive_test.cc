#include "plumbline/apps/simulation/faulty_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace plumbline {
namespace {

using testing::HasSubstr;

// 20 m straight ahead in 40 s, with a scan each second, through a hall with a sloping end.
World Hall() {
  Building building;
  building.faces = {{{0, 0}, {30, 0}}, {{30, 0}, {28, 6}}, {{28, 6}, {0, 6}}, {{0, 6}, {0, 0}}};
  building.path = {{{2, 3}, 1}, {{22, 3}, 2}};
  return World(building);
}

SimulationOptions Exact() {
  SimulationOptions options;
  options.laser.num_beams = 19;
  options.laser.bearing_step_rad = DegToRad(10.0);
  options.laser_noise = {0.0, 0.0, 0.0, 0.0};
  options.odometry_noise = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  options.drive.speed_m_s = 0.5;
  options.scan_period_s = 1.0;
  return options;
}

struct Result {
  SimulatedLog log;
  std::size_t first_scan = 0;

  double TrueX(std::size_t scan) const { return log.scans[scan].world_from_robot.x; }
  double OdomX(std::size_t scan) const { return log.scans[scan].odom_from_robot.x; }
  double TimeS(std::size_t scan) const { return log.scans[scan].scan.timestamp_s; }
};

// At 40.5 % of the path, where it has one: 16.2 s after the start.
Result WithFault(FaultKind kind) {
  Fault fault = Fault::Default(kind);
  if (fault.at_share != 0.0) fault.at_share = 0.405;
  Result result;
  const World world = Hall();
  const Status status =
      SimulateWithFault(world, &world, Exact(), fault, &result.log, &result.first_scan);
  EXPECT_TRUE(status.ok()) << status.message();
  return result;
}

TEST(FaultyDriveTest, NamesAreReadAsWritten) {
  for (const FaultKind kind : kFaultKinds) {
    FaultKind read = FaultKind::kNone;
    EXPECT_TRUE(FromString(ToString(kind), &read));
    EXPECT_EQ(read, kind);
  }
  FaultKind kind;
  EXPECT_FALSE(FromString("Carried", &kind));
}

TEST(FaultyDriveTest, WithoutAFaultItIsTheDriveAsItIs) {
  for (const FaultKind kind : {FaultKind::kNone, FaultKind::kInjected}) {
    const Result result = WithFault(kind);
    ASSERT_EQ(result.log.scans.size(), 41u);
    EXPECT_EQ(result.first_scan, 41u);
    EXPECT_NEAR(result.TrueX(40), 22.0, 1e-9);
    EXPECT_NEAR(result.OdomX(40), 22.0, 1e-9);
  }
}

TEST(FaultyDriveTest, CarriedAtOnceOrWhileNothingIsRecorded) {
  const Result at_once = WithFault(FaultKind::kCarried),
               in_gap = WithFault(FaultKind::kCarriedInGap);
  for (const Result* result : {&at_once, &in_gap}) {
    ASSERT_EQ(result->first_scan, 17u);
    const double driven_m = result->TrueX(17) - result->TrueX(16);
    EXPECT_NEAR(driven_m - (result->OdomX(17) - result->OdomX(16)), 2.0, 1e-9);
  }
  EXPECT_EQ(at_once.TimeS(17), 17.0);
  EXPECT_EQ(in_gap.TimeS(17), 22.0);  // carried from 16.2 to 21.2 s
}

TEST(FaultyDriveTest, SlipsEitherWay) {
  const Result result = WithFault(FaultKind::kSlip);
  ASSERT_EQ(result.first_scan, 17u);
  EXPECT_NEAR(result.OdomX(16) - result.TrueX(16), 0.0, 1e-9);
  EXPECT_NEAR(result.OdomX(17) - result.TrueX(17), 1.5 * 0.8 / 6.0, 1e-9);
  EXPECT_NEAR(result.OdomX(40) - result.TrueX(40), 1.5, 1e-9);
  Fault fault = Fault::Default(FaultKind::kSlip);
  fault.distance_m = -1.0;
  Result back;
  ASSERT_TRUE(SimulateWithFault(Hall(), nullptr, Exact(), fault, &back.log, &back.first_scan).ok());
  EXPECT_NEAR(back.OdomX(40) - back.TrueX(40), -1.0, 1e-9);
}

TEST(FaultyDriveTest, RecordingFaultsBeginWhereTheyAreSaidTo) {
  const Result dropped = WithFault(FaultKind::kDroppedScans);
  EXPECT_EQ(dropped.first_scan, 17u);
  EXPECT_EQ(dropped.TimeS(16), 16.0);
  EXPECT_EQ(dropped.TimeS(17), 20.0);  // none from 16.2 to 19.2 s
  EXPECT_NEAR(dropped.OdomX(17), dropped.TrueX(17), 1e-9);

  const Result repeated = WithFault(FaultKind::kRepeated);
  EXPECT_EQ(repeated.log.scans.size(), 51u);
  EXPECT_EQ(repeated.first_scan, 27u);
  EXPECT_EQ(repeated.OdomX(27), repeated.OdomX(17));
  EXPECT_EQ(repeated.TimeS(27), 27.0);

  const Result frozen = WithFault(FaultKind::kFrozen), to_end = WithFault(FaultKind::kFrozenToEnd);
  const auto ranges = [](const Result& result, int scan) {
    return result.log.scans[scan].scan.ranges;
  };
  EXPECT_EQ(frozen.first_scan, 17u);
  EXPECT_EQ(ranges(frozen, 28), ranges(frozen, 16));
  EXPECT_NE(ranges(frozen, 29), ranges(frozen, 16));
  EXPECT_EQ(to_end.first_scan, 17u);
  EXPECT_EQ(ranges(to_end, 40), ranges(to_end, 16));
}

TEST(FaultyDriveTest, SomeFaultsAreThereFromTheStart) {
  const Result offset = WithFault(FaultKind::kClockOffset),
               turned = WithFault(FaultKind::kMounting);
  EXPECT_EQ(offset.first_scan, 0u);
  EXPECT_NEAR(offset.TrueX(20) - offset.OdomX(20), 0.1, 1e-9);
  EXPECT_EQ(turned.first_scan, 0u);
  // The middle beam looks ahead by the log.
  EXPECT_NEAR(turned.log.laser.Bearing(9), 0.0, 1e-12);
  const Eigen::Vector2d hit = turned.log.scans[40].hits[9] - Eigen::Vector2d(22.0, 3.0);
  EXPECT_NEAR(std::atan2(hit.y(), hit.x()), DegToRad(5.0), 1e-9);
}

TEST(FaultyDriveTest, TheSecondBuildingFollowsTheFirst) {
  const Result result = WithFault(FaultKind::kTwoBuildings);
  ASSERT_EQ(result.log.scans.size(), 82u);
  EXPECT_EQ(result.first_scan, 41u);
  EXPECT_EQ(result.OdomX(41), result.OdomX(40));
  EXPECT_EQ(result.log.scans[41].scan.ranges, result.log.scans[0].scan.ranges);
  EXPECT_NEAR(result.OdomX(81) - result.OdomX(41), 20.0, 1e-9);
  EXPECT_NEAR(result.log.path_length_m, 40.0, 1e-9);
}

TEST(FaultyDriveTest, RefusesBadFaultsByName) {
  const World world = Hall();
  Result result;
  const auto message = [&](const SimulationOptions& options, const Fault& fault) {
    const Status status =
        SimulateWithFault(world, nullptr, options, fault, &result.log, &result.first_scan);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    return status.message();
  };
  EXPECT_THAT(message(Exact(), {FaultKind::kFrozen, 1.0, 0.0, 12.0, 0.0}),
              HasSubstr("fault frozen: at_share = 1"));
  EXPECT_THAT(message(Exact(), {FaultKind::kFrozen, 0.5, 2.0, 12.0, 0.0}),
              HasSubstr("distance_m = 2, but it must be 0"));
  EXPECT_THAT(message(Exact(), {FaultKind::kCarried, 0.5, -1.0, 0.0, 0.0}),
              HasSubstr("distance_m = -1"));
  EXPECT_THAT(message(Exact(), {FaultKind::kSlip, 0.5, 1.0, std::nan(""), 0.0}),
              HasSubstr("time_s = nan"));
  EXPECT_THAT(message(Exact(), {FaultKind::kMounting, 0.0, 0.0, 0.0, 0.0}),
              HasSubstr("angle_rad = 0"));
  EXPECT_THAT(message(Exact(), Fault::Default(FaultKind::kTwoBuildings)),
              HasSubstr("needs the second one"));
  SimulationOptions carried = Exact();
  carried.carry.distance_m = 1.0;
  EXPECT_THAT(message(carried, Fault::Default(FaultKind::kFrozen)),
              HasSubstr("carry_distance_m = 1"));
  EXPECT_TRUE(result.log.scans.empty());
}

}  // namespace
}  // namespace plumbline
