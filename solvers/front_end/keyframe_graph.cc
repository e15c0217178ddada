#include "plumbline/solvers/front_end/keyframe_graph.h"

#include <algorithm>
#include <cstddef>

namespace plumbline {

std::vector<int> ScansOf(const std::vector<Keyframe>& keyframes) {
  std::vector<int> scans;
  scans.reserve(keyframes.size());
  for (const Keyframe& key : keyframes) scans.push_back(key.scan);
  return scans;
}

int KeyframeGraph::BeginOfSession(int key) const {
  while (key > 0 && !sequential[key - 1].between_sessions) --key;
  return key;
}

int KeyframeGraph::EndOfSession(int key) const {
  while (key + 1 < size() && !sequential[key].between_sessions) ++key;
  return key + 1;
}

std::vector<Pose2> PosesFollowingKeyframes(const KeyframeGraph& keyframe_graph,
                                           const std::vector<Pose2>& before) {
  const std::vector<Keyframe>& keys = keyframe_graph.keyframes;
  if (keys.empty()) return before;
  std::vector<Pose2> poses(before.size());
  std::size_t next = 0;
  for (int pose = 0; pose < static_cast<int>(before.size()); ++pose) {
    while (next < keys.size() && keys[next].pose <= pose) ++next;
    const std::size_t a = next > 0 ? next - 1 : 0;
    const std::size_t b = std::min(next, keys.size() - 1);
    const Pose2 from_a =
        keyframe_graph.world_from_key[a] * Between(before[keys[a].pose], before[pose]);
    const Pose2 from_b =
        keyframe_graph.world_from_key[b] * Between(before[keys[b].pose], before[pose]);
    const int span = keys[b].pose - keys[a].pose;
    double share = span > 0 ? static_cast<double>(pose - keys[a].pose) / span : 0.0;
    if (span > 0 && keyframe_graph.sequential[a].broken) {
      share = pose < keyframe_graph.sequential[a].first_pose_after ? 0.0 : 1.0;
    }
    const Pose2 a_from_b = Between(from_a, from_b);
    poses[pose] = from_a * Pose2(share * a_from_b.x, share * a_from_b.y, share * a_from_b.yaw);
  }
  return poses;
}

}  // namespace plumbline
