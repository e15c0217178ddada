#include "plumbline/solvers/pose_graph/connected_poses.h"

#include "plumbline/solvers/pose_graph/pose_sets.h"

namespace plumbline {

int FindUnconnectedPose(const SlamGraph& graph, const std::vector<int>& anchors) {
  PoseSets sets(graph.num_poses());
  for (const RelativePoseConstraint& edge : graph.relative_poses()) {
    sets.Join(edge.from, edge.to);
  }
  std::vector<char> is_anchored(graph.num_poses(), false);  // per set, by its name
  for (const int anchor : anchors) is_anchored[sets.Find(anchor)] = true;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    if (!is_anchored[sets.Find(pose)]) return pose;
  }
  return -1;
}

}  // namespace plumbline
