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
    overlay.style = OverlayStyle::kPoints;
    overlay.color = ColorOf(session);
    overlay.label = session.name + ": " + WithThousands(session.num_scans) + " scans";
    for (int scan = session.first_scan; scan < session.first_scan + session.num_scans; ++scan) {
      const ScanEntry& entry = graph.scan(scan);
      for (std::size_t i = entry.first_return; i < entry.first_return + entry.num_returns; ++i) {
        overlay.points.emplace_back(state.points[2 * i], state.points[2 * i + 1]);
      }
    }
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
