#include "plumbline/apps/pictures/session_pictures.h"

#include <cstddef>
#include <utility>

#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/pictures/palette.h"

namespace plumbline {
namespace {

Rgb ColorOf(const SessionMark& session) { return StyleOfSeries(session.number).color; }

}  // namespace

MapPictureOptions ShowSessions(const std::vector<SessionMark>& sessions) {
  MapPictureOptions picture;
  picture.title = "Sessions";
  for (const SessionMark& session : sessions) {
    MapOverlay overlay;
    overlay.style = OverlayStyle::kScans;
    overlay.color = ColorOf(session);
    overlay.label = session.name + ": " + WithThousands(session.num_scans) + " scans";
    overlay.first_scan = session.first_scan;
    overlay.num_scans = session.num_scans;
    picture.overlays.push_back(std::move(overlay));
  }
  return picture;
}

MapPictureOptions ShowChanges(const std::vector<SessionMark>& sessions,
                              const std::vector<SessionChange>& changes) {
  MapPictureOptions picture;
  picture.title = "What changed between sessions";
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
    picture.overlays.push_back(std::move(surfaces));
    picture.overlays.push_back(std::move(rings));
  }
  return picture;
}

}  // namespace plumbline
