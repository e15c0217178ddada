#include "plumbline/solvers/reduced/unanchored_components.h"

#include <cstddef>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/pose_graph/pose_sets.h"

namespace plumbline {
namespace {

struct PosePair {
  int a = 0, b = 0;
};

// Joins all that any process has joined, and those poses of different ones that saw a landmark.
void JoinAcrossPeers(const LineObservations& observations, PoseSets* sets) {
  constexpr int kNone = -1;
  const SharedLandmarks& shared = observations.shared;
  const Peers& peers = *shared.peers();
  std::vector<PosePair> pairs;
  const auto pose_of = [&](int landmark) {
    const std::size_t first = observations.first_of_landmark[landmark];
    const bool is_seen = first < observations.first_of_landmark[landmark + 1];
    return is_seen ? observations.observations[first].pose : kNone;
  };
  std::vector<std::vector<int>> to_rank(peers.size());
  for (int rank = 0; rank < peers.size(); ++rank) {
    for (const int landmark : shared.SharedWith(rank)) to_rank[rank].push_back(pose_of(landmark));
  }
  const std::vector<std::vector<int>> from_rank = ExchangeValues(peers, to_rank);
  for (int rank = 0; rank < peers.size(); ++rank) {
    for (std::size_t i = 0; i < from_rank[rank].size(); ++i) {
      const int here = to_rank[rank][i], there = from_rank[rank][i];
      if (rank != peers.rank() && here != kNone && there != kNone) pairs.push_back({here, there});
    }
  }
  for (int pose = 0; pose < static_cast<int>(observations.num_poses()); ++pose) {
    const bool is_here = observations.first_of_pose[pose] < observations.first_of_pose[pose + 1];
    if (is_here && sets->Find(pose) != pose) pairs.push_back({sets->Find(pose), pose});
  }
  const std::vector<std::vector<PosePair>> to_all(peers.size(), pairs);
  for (const std::vector<PosePair>& from : ExchangeValues(peers, to_all)) {
    for (const PosePair& pair : from) sets->Join(pair.a, pair.b);
  }
}

}  // namespace

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
  if (observations.shared.peers() != nullptr) JoinAcrossPeers(observations, &sets);
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
