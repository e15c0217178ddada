#include "plumbline/solvers/reduced/free_islands.h"

#include <cstddef>

#include "plumbline/solvers/pose_sets.h"

namespace plumbline {
std::vector<int> FindFreeIslands(const PatchSightings& sightings, const PoseTerms& terms) {
  const std::size_t num_poses = sightings.num_poses();
  PoseSets sets(num_poses);
  for (const std::vector<PoseEdge>* edges : {&terms.motions, &terms.relative_poses}) {
    for (const PoseEdge& edge : *edges) sets.Join(edge.from, edge.to);
  }
  for (std::size_t i = 1; i < sightings.sightings.size(); ++i) {
    const PatchSighting& before = sightings.sightings[i - 1];
    const PatchSighting& here = sightings.sightings[i];
    if (before.patch == here.patch) sets.Join(before.pose, here.pose);
  }
  std::vector<bool> held(num_poses, false);
  for (std::size_t pose = 0; pose < num_poses; ++pose) {
    if (terms.is_constant[pose]) held[sets.Find(static_cast<int>(pose))] = true;
  }
  std::vector<int> islands;
  for (int pose = 0; pose < static_cast<int>(num_poses); ++pose) {
    if (sets.Find(pose) == pose && !held[pose]) islands.push_back(pose);
  }
  return islands;
}

}  // namespace plumbline
