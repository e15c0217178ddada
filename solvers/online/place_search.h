#ifndef PLUMBLINE_SOLVERS_ONLINE_PLACE_SEARCH_H_
#define PLUMBLINE_SOLVERS_ONLINE_PLACE_SEARCH_H_

#include <memory>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/session_report.h"
#include "plumbline/solvers/online/saved_map.h"
#include "plumbline/solvers/seeding/seed_drive.h"

namespace plumbline {

/// A stretch of a drive whose place in a saved map is sought, nothing being known of it.
struct PlaceSearch {
  std::shared_ptr<const SavedSession> map;
  SlamGraph graph;     ///< poses and scans of the stretch
  SeededDrive drive;   ///< of the graph
  int first_pose = 0;  ///< of the drive: the first one of the stretch
  TieOutcome outcome = TieOutcome::kNoMatch;
  /// If the outcome is kTied: keyframes of the map and then of the stretch, in the frame of the
  /// map, with closures between them.
  KeyframeGraph keys;
};

/// Seeks the place of the stretch by the alignment of sessions (session_alignment.h), and decides
/// as that does whether it is certain. Unavailable if progress stopped it.
Status SeekPlace(const SeedingProgress& progress, ThreadPool* pool, PlaceSearch* search);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ONLINE_PLACE_SEARCH_H_
