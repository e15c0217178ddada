#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_REFINE_POSE_GRAPH_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_REFINE_POSE_GRAPH_H_

#include <cstddef>
#include <optional>
#include <string>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {

/// Where an optimisation of a pose graph starts.
enum class PoseGraphStart {
  kGiven,    ///< the given state
  kChordal,  ///< see chordal_start.h
};
const char* ToString(PoseGraphStart start);

struct PoseGraphSummary {
  std::size_t num_poses = 0;
  std::size_t num_edges = 0;
  /// Sums of the squared, whitened errors of the edges.
  double given_chi2 = 0.0;
  std::optional<double> chordal_chi2;  ///< if there is a chordal start
  double final_chi2 = 0.0;
  PoseGraphStart start = PoseGraphStart::kGiven;
  PoseGraphResult optimization;  ///< from that start
  double time_s = 0.0;

  std::string BriefReport() const;
};

/// Moves the poses of a state to the optimum of the graph's relative poses, all quadratic, and puts
/// every map point where its pose says. Fixed poses stay exactly. Starts at the given poses or at a
/// chordal start, whichever fits the edges better; the result is never worse than the given poses.
/// Expects relative poses to connect every pose with a fixed one; without any, all poses stay.
/// Odometry and laser returns are not looked at. The callback sees each iteration.
PoseGraphSummary RefinePoseGraph(const SlamGraph& graph, MapState* state,
                                 const PoseGraphCallback& callback = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_REFINE_POSE_GRAPH_H_
