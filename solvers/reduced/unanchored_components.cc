#include "plumbline/solvers/reduced/unanchored_components.h"

#include <cstddef>

#include "plumbline/solvers/pose_graph/pose_sets.h"

namespace plumbline {
std::vector<int> FindUnanchoredComponents(const LineObservations& observations,
                                          const PoseTerms& terms) {
  const std::size_t num_poses = observations.num_poses();
  PoseSets sets(num_poses);
  std::vector<char> tied = terms.is_constant;
  for (const auto& term : terms.terms) term->TiePoses(&sets, &tied);
  for (std::size_t i = 1; i < observations.observations.size(); ++i) {
    const LineObservation& before = observations.observations[i - 1];
    const LineObservation& here = observations.observations[i];
    if (before.landmark == here.landmark) sets.Join(before.pose, here.pose);
  }
  std::vector<bool> held(num_poses, false);
  for (std::size_t pose = 0; pose < num_poses; ++pose) {
    if (tied[pose]) held[sets.Find(static_cast<int>(pose))] = true;
  }
  std::vector<int> components;
  for (int pose = 0; pose < static_cast<int>(num_poses); ++pose) {
    if (sets.Find(pose) == pose && !held[pose]) components.push_back(pose);
  }
  return components;
}

}  // namespace plumbline
