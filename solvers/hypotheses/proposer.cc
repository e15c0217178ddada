#include "plumbline/solvers/hypotheses/proposer.h"

namespace plumbline {

std::vector<MapConsistency> SearchContext::Measure(const std::vector<KeyframeGraph>& graphs,
                                                   const SequentialTrajectory& start) const {
  std::vector<std::vector<Pose2>> maps;
  maps.reserve(graphs.size());
  for (const KeyframeGraph& keys : graphs) {
    maps.push_back(PosesFollowingKeyframes(keys, start.world_from_robot));
  }
  return meter.MeasureEach(maps, pool);
}

std::string IdOf(const std::vector<RelativePoseConstraint>& closures) {
  std::string id;
  for (const RelativePoseConstraint& closure : closures) {
    id += ' ' + std::to_string(closure.from) + '-' + std::to_string(closure.to);
  }
  return id;
}

}  // namespace plumbline
