#include <cmath>
#include <cstdio>

#include "plumbline/apps/evaluation/truth.h"
#include "plumbline/test/fuzz/input_file.h"

namespace {

// Two scans of a few beams.
plumbline::SlamGraph MakeGraph() {
  plumbline::SlamGraph graph;
  plumbline::LaserModel laser;
  laser.num_beams = 3;
  laser.bearing_step_rad = 0.5;
  const int laser_id = graph.AddLaser(laser);
  for (const double time_s : {0.0, 1.0}) {
    graph.AddScan(graph.AddPose({time_s, 0.0, 0.0}, time_s), laser_id, {1.0, 2.0, 3.0});
  }
  plumbline::Require(graph.status().ok());
  return graph;
}

}  // namespace

// The input is a table of hits.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile hits;
  static const SlamGraph graph = MakeGraph();
  static const MapState state = graph.InitialState();
  const std::string path = hits.Holding(data, size), trajectory = path + ".tum";
  Require(WriteTumTrajectory(trajectory, TrajectoryOf(graph, state)).ok());
  Truth truth;
  const bool read = ReadTruth(trajectory, path, graph, &truth).ok();
  std::remove(trajectory.c_str());
  if (!read) return 0;
  Require(truth.points.size() == state.points.size());
  Require(std::isfinite(CompareWithTruth(graph, state, truth).mean_pose_error_m));
  return 0;
}
