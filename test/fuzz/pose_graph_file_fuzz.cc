#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/apps/io/pose_graph_writer.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/fuzz/input_file.h"
#include "plumbline/test/fuzz/map_graph.h"

// g2o and TORO: the first record tells.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile file;
  const std::string path = file.Holding(data, size);
  IsPoseGraphFile(path);
  PoseGraphFile pose_graph;
  if (!ReadPoseGraphFile(path, &pose_graph).ok()) return 0;
  // What was read can be written, and read again as the same graph.
  const std::vector<double>& poses = pose_graph.graph.initial_poses();
  Require(WritePoseGraphFile(path, pose_graph.format, pose_graph, poses).ok());
  PoseGraphFile again;
  Require(ReadPoseGraphFile(path, &again).ok());
  Require(again.graph.initial_poses() == poses);
  Require(again.graph.num_returns() == pose_graph.graph.num_returns());
  SolverOptions descent;
  descent.type = SolverType::kSgd;
  int num_iterations = 0;
  descent.callback = [&](const IterationSummary&) { return ++num_iterations < 3; };
  MapState state = again.graph.InitialState();
  if (pose_graph.graph.num_poses() <= 20) RefineState(descent, again.graph, &state);
  for (const double number : state.poses) Require(std::isfinite(number));
  MapGraph(/*seed=*/false, std::move(pose_graph.graph));
  return 0;
}
