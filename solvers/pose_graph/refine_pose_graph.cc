#include "plumbline/solvers/pose_graph/refine_pose_graph.h"

#include <chrono>
#include <sstream>
#include <vector>

#include "plumbline/core/float_environment.h"
#include "plumbline/solvers/pose_graph/chordal_start.h"

namespace plumbline {

const char* ToString(PoseGraphStart start) {
  return start == PoseGraphStart::kGiven ? "given" : "chordal";
}

std::string PoseGraphSummary::BriefReport() const {
  std::ostringstream report;
  report << "pose graph: " << num_poses << " poses, " << num_edges << " edges, chi2 " << given_chi2
         << " as given";
  if (chordal_chi2) report << ", " << *chordal_chi2 << " at the chordal start";
  report << ", " << final_chi2 << " after " << optimization.iterations << " iterations from the "
         << ToString(start) << " start in " << time_s << " s; " << optimization.stop_reason;
  return report.str();
}

PoseGraphSummary RefinePoseGraph(const SlamGraph& graph, MapState* state,
                                 const PoseGraphCallback& callback) {
  const DefaultFloatEnvironment float_environment;
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<RelativePoseConstraint>& edges = graph.relative_poses();
  std::vector<int> fixed;
  for (const FixedPose& pose : graph.fixed_poses()) {
    state->SetPose(pose.pose, pose.world_from_robot);
    fixed.push_back(pose.pose);
  }
  std::vector<Pose2> poses = PosesOf(state->poses);

  PoseGraphSummary summary;
  summary.num_poses = poses.size();
  summary.num_edges = edges.size();
  summary.given_chi2 = GraphChi2(edges, poses);
  std::vector<Pose2> chordal = poses;
  if (ChordalStart(edges, fixed, &chordal)) {
    summary.chordal_chi2 = GraphChi2(edges, chordal);
    if (*summary.chordal_chi2 < summary.given_chi2) {
      summary.start = PoseGraphStart::kChordal;
      poses = chordal;
    }
  }
  summary.optimization = OptimizePoseGraph(edges, {}, &poses, fixed, callback);
  summary.final_chi2 = GraphChi2(edges, poses);
  state->poses = PoseArray(poses);
  state->points = graph.MeasuredMap(state->poses);
  summary.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace plumbline
