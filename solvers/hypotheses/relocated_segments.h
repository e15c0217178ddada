#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_RELOCATED_SEGMENTS_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_RELOCATED_SEGMENTS_H_

#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// Puts what lies beyond an edge to what lies before it in every way in which places of the two
/// match: the robot was carried, and nothing is known of where to. Buildings repeat themselves, so
/// there may be many ways; the map decides between them.
///
/// surfaces: per scan. edge: from keyframe `edge` to the next one. Returns a graph per way, those
/// with the better matches first: the edge is broken, what was across it is taken out, the match is
/// its only closure across the edge, and the keyframes beyond are moved rigidly.
std::vector<KeyframeGraph> RelocateSegment(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                                           int edge, ThreadPool* pool);

/// How the keyframe after an edge lies to the one before it.
Pose2 StepAt(int edge, const KeyframeGraph& keys);

/// Whether what lies beyond an edge lies at the same place in two graphs, but for errors of
/// matching.
bool IsSameRelocation(int edge, const KeyframeGraph& a, const KeyframeGraph& b);

/// Of the parts before and beyond a step, the one that other passes meet less: how many returns are
/// compared between it and them. What speaks for where it lies is among these.
int ComparedOfLesserPart(const MapConsistency& consistency, int first_pose_after);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_RELOCATED_SEGMENTS_H_
