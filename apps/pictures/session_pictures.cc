#include "plumbline/apps/pictures/session_pictures.h"

#include <cstddef>
#include <utility>

#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/apps/pictures/palette.h"

namespace plumbline {
namespace {

Rgb ColorOf(const SessionMark& session) { return StyleOfSeries(session.number).color; }

}  // namespace

Status WriteSessionPicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                           const std::vector<SessionMark>& sessions, int max_side_px) {
  MapPictureOptions options;
  options.title = "Sessions";
  options.max_side_px = max_side_px;
  for (const SessionMark& session : sessions) {
    MapOverlay overlay;
    overlay.style = OverlayStyle::kScans;
    overlay.color = ColorOf(session);
    overlay.label = session.name + ": " + WithThousands(session.num_scans) + " scans";
    overlay.first_scan = session.first_scan;
    overlay.num_scans = session.num_scans;
    options.overlays.push_back(std::move(overlay));
  }
  return WriteMapPicture(path, graph, state, options);
}

Status WriteChangesPicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                           const std::vector<SessionMark>& sessions,
                           const std::vector<SessionChange>& changes, int max_side_px) {
  MapPictureOptions options;
  options.title = "What changed between sessions";
  options.max_side_px = max_side_px;
  for (std::size_t index = 0; index < sessions.size(); ++index) {
    MapOverlay surfaces, rings;
    surfaces.style = OverlayStyle::kPoints;
    rings.style = OverlayStyle::kRings;
    surfaces.color = rings.color = ColorOf(sessions[index]);
    for (const SessionChange& change : changes) {
      if (change.shown_by != static_cast<int>(index)) continue;
      surfaces.points.insert(surfaces.points.end(), change.points.begin(), change.points.end());
      rings.points.push_back(change.center);
    }
    rings.label = std::to_string(rings.points.size()) + " surfaces that " + sessions[index].name +
                  " shows and another session looked through";
    options.overlays.push_back(std::move(surfaces));
    options.overlays.push_back(std::move(rings));
  }
  return WriteMapPicture(path, graph, state, options);
}

}  // namespace plumbline
