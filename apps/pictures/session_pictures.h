#ifndef PLUMBLINE_APPS_PICTURES_SESSION_PICTURES_H_
#define PLUMBLINE_APPS_PICTURES_SESSION_PICTURES_H_

#include <string>
#include <vector>

#include "plumbline/apps/evaluation/session_changes.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Draws the points of each session in a colour of its own, with a legend. Fails like
/// WriteMapPicture.
Status WriteSessionPicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                           const std::vector<SessionMark>& sessions, int max_side_px);

/// Draws the map with a ring around the middle of every change, which has the colour of the session
/// that shows it. Fails like WriteMapPicture.
Status WriteChangesPicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                           const std::vector<SessionMark>& sessions,
                           const std::vector<SessionChange>& changes, int max_side_px);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_SESSION_PICTURES_H_
