#ifndef PLUMBLINE_TEST_FUZZ_MAP_GRAPH_H_
#define PLUMBLINE_TEST_FUZZ_MAP_GRAPH_H_

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"
#include "plumbline/solvers/pose_graph/refine_pose_graph.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/seed.h"
#include "plumbline/test/fuzz/input_file.h"

namespace plumbline {

/// Does to a graph that a reader accepted what plumbline_slam does, in short, so that garbage which
/// looks like a graph shows what it breaks further on. Graphs that take long are left alone.
inline void MapGraph(bool seed, SlamGraph graph) {
  constexpr int kMaxPoses = 20;
  constexpr std::size_t kMaxReturns = 2000;
  if (graph.num_poses() > kMaxPoses || graph.num_returns() > kMaxReturns) return;
  ThreadPool pool(1);
  SolverOptions options;
  options.num_threads = 1;
  options.reduced.max_rounds = 2;
  const MeasuredSurface surface =
      MeasureSurface(graph, NormalOptionsFor(options.factors.beam), &pool);
  MapState state = graph.InitialState();
  if (seed) {
    SeedingReport report;
    Require(SeedGraph(SeedingOptions(), options.factors.motion,
                      MeasureSurface(graph, NormalOptionsFor(options.factors.beam), &pool), {},
                      &pool, graph, &state, &report)
                .ok());
    graph = std::move(graph).Corrected(report.corrections);
  } else {
    RefinePoseGraph(graph, &state);
  }
  for (const double number : state.poses) Require(std::isfinite(number));
  for (const double number : state.points) Require(std::isfinite(number));
  if (graph.num_returns() == 0) return;
  const SolverSummary summary = RefineState(options, surface, graph, &state);
  for (const double number : state.poses) Require(std::isfinite(number));
  for (const double number : state.points) Require(std::isfinite(number));
  MeasureMapConsistency(graph, PosesOf(state.poses), &pool);
  OccupancyGridOptions grid_options;
  grid_options.max_cells = 1e6;
  OccupancyGrid grid;
  // A map that needs more cells is refused.
  if (!BuildOccupancyGrid(graph, state, grid_options, &grid).ok()) return;
  Require(!grid.cells.empty());
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_FUZZ_MAP_GRAPH_H_
