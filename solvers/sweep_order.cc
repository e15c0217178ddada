#include "plumbline/solvers/sweep_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plumbline/core/map_quality.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/seed.h"

namespace plumbline {
namespace {

constexpr int kNumScans = 200;
constexpr double kClearlyThinner = 0.95;

// The stretch of the log in which the robot turns most.
SlamGraph MostTurned(const SlamGraph& log) {
  std::vector<double> turned(log.num_poses(), 0.0);
  for (const OdometryConstraint& step : log.odometry()) {
    turned[step.to] = std::abs(step.from_from_to.yaw);
  }
  int best = 0;
  double sum = 0.0, most = -1.0;
  for (int pose = 0; pose < log.num_poses(); ++pose) {
    sum += turned[pose];
    if (pose >= kNumScans) sum -= turned[pose - kNumScans];
    if (sum <= most) continue;
    most = sum;
    best = std::max(0, pose + 1 - kNumScans);
  }
  SlamGraph stretch;
  const int end = std::min(best + kNumScans, log.num_poses());
  for (int pose = best; pose < end; ++pose) {
    stretch.AddPose(Pose2(&log.initial_poses()[3 * pose]), log.timestamp_s(pose));
  }
  for (int scan = 0; scan < log.num_scans(); ++scan) {
    const int pose = log.scan(scan).pose;
    if (pose < best || pose >= end) continue;
    stretch.AddScanOf(log, scan, pose - best);
  }
  for (OdometryConstraint step : log.odometry()) {
    step.from -= best;
    step.to -= best;
    if (step.from < 0 || step.to >= end - best) continue;
    stretch.AddOdometry(step);
  }
  return stretch;
}

// Of the map of the scans; infinite where there is nothing to measure.
double Thickness(const SeedingOptions& seeding, const SolverOptions& solver,
                 const SlamGraph& measured, SweepOrder order, ThreadPool* pool) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  SlamGraph graph =
      measured.Corrected(TakeOutSweepMotion(measured, order, measured.initial_poses()));
  const ReturnNormalOptions normals = NormalOptionsFor(solver.factors.beam);
  const MeasuredSurface before = MeasureSurface(graph, normals, pool);
  MapState state;
  SeedingReport report;
  if (!SeedGraph(seeding, solver.factors.motion, before, {}, pool, graph, &state, &report).ok()) {
    return kNone;
  }
  if (LacksOdometry(graph) && !AddPredictedSteps(report.sequential_poses, &graph).ok()) {
    return kNone;
  }
  graph = graph.Corrected(TakeOutSweepMotion(measured, order, state.poses));
  const MeasuredSurface surface = MeasureSurface(graph, normals, pool);
  if (!RefineState(solver, surface, graph, &state).IsSolutionUsable()) return kNone;
  const MapQuality quality =
      MeasureMapQuality(graph.MeasuredMap(state.poses), MapQualityOptions(), pool);
  if (quality.num_samples == 0) return kNone;
  return quality.wall_thickness_m;
}

}  // namespace

SweepOrder FindSweepOrder(const SeedingOptions& seeding, const SolverOptions& solver,
                          const SlamGraph& measured, ThreadPool* pool) {
  SweepOrder best = SweepOrder::kFirstBeamFirst;
  const SlamGraph stretch = MostTurned(measured);
  // Whatever solver the log gets.
  SolverOptions quick;
  quick.factors = solver.factors;
  quick.num_threads = solver.num_threads;
  double least_m = kClearlyThinner * Thickness(seeding, quick, stretch, best, pool);
  for (const SweepOrder order : {SweepOrder::kLastBeamFirst, SweepOrder::kAtOnce}) {
    const double thickness_m = Thickness(seeding, quick, stretch, order, pool);
    if (!(thickness_m < least_m)) continue;
    least_m = thickness_m;
    best = order;
  }
  return best;
}

}  // namespace plumbline
