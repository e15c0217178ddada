#ifndef PLUMBLINE_TEST_APPS_BENCHMARK_KNOWN_DRIVE_H_
#define PLUMBLINE_TEST_APPS_BENCHMARK_KNOWN_DRIVE_H_

#include <gtest/gtest.h>

#include <cstddef>

#include "plumbline/apps/benchmark/log_variations.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"

namespace plumbline {

/// The first scans of a drive through a simulated building, a scan every 0.6 s, with a relation of
/// each scan to the one 10 scans later. The laser is mounted off the robot's centre.
inline KnownLog MakeKnownDrive(int num_scans, int num_beams) {
  SimulationOptions options;
  options.scan_period_s = 0.6;
  options.laser.num_beams = num_beams;
  options.laser.bearing_step_rad = DegToRad(180.0) / num_beams;
  options.laser.robot_from_laser = Pose2(0.1, -0.05, 0.2);
  SimulatedLog simulated;
  const World world(GenerateBuilding(BuildingKind::kRandom, 1));
  EXPECT_TRUE(Simulate(world, options, &simulated).ok());
  simulated.scans.resize(num_scans);
  KnownLog known;
  known.name = "drive";
  for (const SimulatedScan& from : simulated.scans) {
    CarmenScan scan;
    scan.timestamp_s = 100.0 + from.scan.timestamp_s;
    scan.odom_from_robot = from.odom_from_robot;
    scan.odom_from_laser = from.odom_from_robot * options.laser.robot_from_laser;
    scan.ranges = from.scan.ranges;
    scan.first_bearing_rad = options.laser.first_bearing_rad;
    scan.bearing_step_rad = options.laser.bearing_step_rad;
    scan.max_range_m = options.laser.max_range_m;
    known.log.scans.push_back(scan);
  }
  constexpr std::size_t kSpan = 10;
  for (std::size_t i = 0; i + kSpan < simulated.scans.size(); ++i) {
    known.relations.push_back({known.log.scans[i].timestamp_s,
                               known.log.scans[i + kSpan].timestamp_s,
                               Between(simulated.scans[i].world_from_robot,
                                       simulated.scans[i + kSpan].world_from_robot)});
  }
  return known;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_BENCHMARK_KNOWN_DRIVE_H_
