#ifndef PLUMBLINE_APPS_PICTURES_OVERLAY_PICTURES_H_
#define PLUMBLINE_APPS_PICTURES_OVERLAY_PICTURES_H_

#include <vector>

#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// The map with its loop closures: accepted ones solid, refused ones dashed, and a legend with the
/// number of each outcome. InvalidArgument on records of poses that the state has not; sets
/// *picture on success only.
Status ShowClosures(const MapState& state, const std::vector<LoopClosureRecord>& records,
                    MapPictureOptions* picture);

/// The map with a ring wherever one scan looked through what another one saw, at most one per half
/// metre.
MapPictureOptions ShowConflicts(const MapConsistency& consistency);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_OVERLAY_PICTURES_H_
