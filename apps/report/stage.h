#ifndef PLUMBLINE_APPS_REPORT_STAGE_H_
#define PLUMBLINE_APPS_REPORT_STAGE_H_

#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/evaluation/truth.h"
#include "plumbline/core/map_quality.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

/// How good the map is at one stage of a run.
struct Stage {
  std::string name;
  MapQuality quality;
  std::optional<TruthError> error;  ///< where the truth is known
};

/// Measures the map of a graph as it stands, together with the points of its peers (collective). A
/// state without points has them where the measurements put them. truth: of the graph; may be null,
/// and has no points if there are peers.
Stage MeasureStage(const std::string& name, const SlamGraph& graph, const MapState& state,
                   const Truth* truth, ThreadPool* pool);

/// A table for people, one row per stage.
std::string StageTable(const std::vector<Stage>& stages);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_STAGE_H_
