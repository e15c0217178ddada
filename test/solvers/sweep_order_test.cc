#include "plumbline/solvers/sweep_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

#include "plumbline/apps/evaluation/truth.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {
namespace {

constexpr double kSweepS = 0.15;

// A fast drive; the laser sweeps in half of its turns, or measures all beams at once.
SimulatedLog FastDrive(bool sweeps) {
  SimulationOptions options;
  options.scan_period_s = 2.0 * kSweepS;
  options.drive.speed_m_s = 0.7;
  options.drive.turn_rate_rad_s = DegToRad(60.0);
  if (sweeps) options.laser.beam_period_s = kSweepS / options.laser.num_beams;
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 43)), options, &log).ok());
  return log;
}

const SimulatedLog& Sweeping() {
  static const SimulatedLog log = FastDrive(true);
  return log;
}
const SimulatedLog& AtOnce() {
  static const SimulatedLog log = FastDrive(false);
  return log;
}

SlamGraph GraphOf(const SimulatedLog& log) {
  SlamGraph graph;
  EXPECT_TRUE(MakeGraph(log, &graph).ok());
  return graph;
}

// The same scans with the array of readings turned, as drivers do for a laser that runs clockwise.
SimulatedLog Turned(SimulatedLog log) {
  log.laser.first_bearing_rad = log.laser.Bearing(log.laser.num_beams - 1);
  log.laser.bearing_step_rad = -log.laser.bearing_step_rad;
  for (SimulatedScan& scan : log.scans) {
    std::reverse(scan.scan.ranges.begin(), scan.scan.ranges.end());
    std::reverse(scan.hits.begin(), scan.hits.end());
  }
  return log;
}

SweepOrder OrderOf(const SlamGraph& graph) {
  ThreadPool pool(2);
  return FindSweepOrder(SeedingOptions(), SolverOptions(), graph, &pool);
}

TEST(SweepOrderTest, IsFoundInTheScans) {
  EXPECT_EQ(OrderOf(GraphOf(Sweeping())), SweepOrder::kFirstBeamFirst);
  EXPECT_EQ(OrderOf(GraphOf(Turned(Sweeping()))), SweepOrder::kLastBeamFirst);
  SimulatedLog wrongly_told = AtOnce();
  wrongly_told.laser.beam_period_s = kSweepS / wrongly_told.laser.num_beams;
  EXPECT_EQ(OrderOf(GraphOf(wrongly_told)), SweepOrder::kAtOnce);
}

TEST(SweepOrderTest, WhatTheModelSaysStandsWhereTheScansDoNotTell) {
  SlamGraph graph;
  const int laser = graph.AddLaser(Sweeping().laser);
  for (int i = 0; i < 5; ++i) {
    const int pose = graph.AddPose({}, i * kSweepS);
    graph.AddScan(pose, laser, Sweeping().scans[0].scan.ranges);
    if (i > 0) {
      graph.AddOdometry({pose - 1, pose, {}});
    }
  }
  EXPECT_EQ(OrderOf(graph), SweepOrder::kFirstBeamFirst);
  EXPECT_EQ(OrderOf(SlamGraph()), SweepOrder::kFirstBeamFirst);
}

// After the rigid fit of the trajectories.
double MapErrorM(const SimulatedLog& log) {
  LogMapping mapping;
  EXPECT_TRUE(MapLog(MapLogOptions(), GraphOf(log), {}, &mapping).ok());
  const MapEstimate exact = TruthOf(log, mapping.graph);
  Truth truth;
  for (std::size_t i = 0; i < exact.poses.size(); ++i) {
    truth.trajectory.push_back({log.scans[i].scan.timestamp_s, exact.poses[i]});
  }
  truth.points = exact.points;
  return CompareWithTruth(mapping.graph, mapping.state, truth).mean_point_error_m;
}

TEST(SweepOrderTest, MapsOfSweepsAreNearlyAsGoodAsThoseOfInstants) {
  const double at_once_m = MapErrorM(AtOnce());
  EXPECT_LT(MapErrorM(Sweeping()), 1.2 * at_once_m);
  SimulatedLog not_told = Sweeping();
  not_told.laser.beam_period_s = 0.0;
  EXPECT_GT(MapErrorM(not_told), 3.0 * at_once_m);
}

}  // namespace
}  // namespace plumbline
