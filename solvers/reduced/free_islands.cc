#include "plumbline/solvers/reduced/free_islands.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace plumbline {
namespace {

// Disjoint sets of poses, each named by its smallest.
class PoseSets {
 public:
  explicit PoseSets(std::size_t num_poses) : parent_(num_poses) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int Find(int pose) {
    while (parent_[pose] != pose) pose = parent_[pose] = parent_[parent_[pose]];
    return pose;
  }
  void Join(int a, int b) {
    a = Find(a);
    b = Find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace

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
  for (const PosePrior& prior : terms.priors) held[sets.Find(prior.pose)] = true;
  std::vector<int> islands;
  for (int pose = 0; pose < static_cast<int>(num_poses); ++pose) {
    if (sets.Find(pose) == pose && !held[pose]) islands.push_back(pose);
  }
  return islands;
}

}  // namespace plumbline
