#ifndef PLUMBLINE_APPS_PICTURES_SESSION_PICTURES_H_
#define PLUMBLINE_APPS_PICTURES_SESSION_PICTURES_H_

#include <vector>

#include "plumbline/apps/evaluation/session_changes.h"
#include "plumbline/apps/pictures/map_picture.h"

namespace plumbline {

/// The points of each session in a colour of its own, with a legend.
MapPictureOptions ShowSessions(const std::vector<SessionMark>& sessions);

/// The map with a ring around the middle of every change, which has the colour of the session that
/// shows it.
MapPictureOptions ShowChanges(const std::vector<SessionMark>& sessions,
                              const std::vector<SessionChange>& changes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_SESSION_PICTURES_H_
