#include "plumbline/solvers/online/place_search.h"

#include <utility>
#include <vector>

#include "plumbline/solvers/sessions/session_alignment.h"
#include "plumbline/solvers/sessions/session_places.h"
#include "plumbline/solvers/sessions/session_set.h"

namespace plumbline {

Status SeekPlace(const SeedingProgress& progress, ThreadPool* pool, PlaceSearch* search) {
  SessionSet set;
  PLUMBLINE_RETURN_IF_ERROR(AddSession(search->map->graph, search->map->drive, &set));
  PLUMBLINE_RETURN_IF_ERROR(AddSession(search->graph, std::move(search->drive), &set));
  SessionPlaces places(set, pool);
  std::vector<SessionAlignment> alignments;
  PLUMBLINE_RETURN_IF_ERROR(FindAlignments(set, SessionViews(set), &places, GroupOfOne(set, 0),
                                           GroupOfOne(set, 1), progress, pool, &alignments));
  search->outcome = Judge(alignments);
  if (search->outcome == TieOutcome::kTied) {
    search->keys = std::move(alignments.front().group.keys);
  }
  return Status::Ok();
}

}  // namespace plumbline
