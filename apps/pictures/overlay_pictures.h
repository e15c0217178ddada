#ifndef PLUMBLINE_APPS_PICTURES_OVERLAY_PICTURES_H_
#define PLUMBLINE_APPS_PICTURES_OVERLAY_PICTURES_H_

#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// Draws the map with its loop closures: accepted ones solid, refused ones dashed, and a legend
/// with the number of each outcome. Fails like WriteMapPicture, and on records of poses that the
/// graph has not.
Status WriteClosurePicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                           const std::vector<LoopClosureRecord>& records, int max_side_px);

/// Draws the map with a ring wherever one scan looked through what another one saw, at most one per
/// half metre. Fails like WriteMapPicture.
Status WriteConflictPicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                            const MapConsistency& consistency, int max_side_px);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_OVERLAY_PICTURES_H_
