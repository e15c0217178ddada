#ifndef PLUMBLINE_SOLVERS_ONLINE_SAVED_MAP_H_
#define PLUMBLINE_SOLVERS_ONLINE_SAVED_MAP_H_

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/seeding/seed_drive.h"

namespace plumbline {

/// A finished map as a session that a drive is placed in.
struct SavedSession {
  SlamGraph graph;          ///< poses with their times, and scans; no edges
  MeasuredSurface surface;  ///< of the graph
  /// It has the poses of the map. All of its keyframes are fixed (KeyframeGraph::num_fixed).
  SeededDrive drive;
};

/// Makes keyframes of a map, as far apart as in a drive. map: its poses are the fixed ones,
/// or else the initial guesses. InvalidArgument if some poses are fixed and others are not, or if
/// no scan shows a surface.
Status MakeSavedSession(const SlamGraph& map, const SeedingOptions& options,
                        const ReturnNormalOptions& normals, ThreadPool* pool,
                        SavedSession* session);

/// Whether all poses of a map are fixed: drives are localised in it, and do not change it.
bool IsFixedMap(const SlamGraph& map);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ONLINE_SAVED_MAP_H_
