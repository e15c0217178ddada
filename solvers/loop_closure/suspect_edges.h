#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_SUSPECT_EDGES_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_SUSPECT_EDGES_H_

#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"

namespace plumbline {

/// Marks the sequential edges whose two sides disagree: returns in the other side's free space, or
/// too little in common for scans so near to each other. There the robot may have been carried, its
/// wheels may have slipped, or a scan was matched to the wrong place.
/// world_from_robot: per pose, as the sequential matching left it.
void MarkSuspectEdges(const ScanSurfaces& surfaces, const std::vector<Pose2>& world_from_robot,
                      ThreadPool* pool, KeyframeGraph* keyframe_graph);

/// Marks the edge from keyframe `first` to keyframe `last` whose two sides agree worst, however
/// little they disagree. Returns it.
int MarkWorstEdge(const ScanSurfaces& surfaces, const std::vector<Pose2>& world_from_robot,
                  int first, int last, KeyframeGraph* keyframe_graph);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_SUSPECT_EDGES_H_
