#include <cmath>

#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/test/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile file;
  std::vector<Relation> relations;
  if (!ReadRelations(file.Holding(data, size), &relations).ok()) return 0;
  std::vector<TimedPose> trajectory;
  for (const Relation& relation : relations) {
    trajectory.push_back({relation.from_s, Pose2()});
    trajectory.push_back({relation.to_s, relation.from_from_to});
  }
  const RelationsMetric metric = MeasureRelations(relations, trajectory, RelationsOptions());
  Require(metric.all.num_matched == relations.size());
  Require(std::isfinite(metric.all.rotation_deg.mean));
  return 0;
}
