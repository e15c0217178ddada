#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CLOSURE_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CLOSURE_H_

#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/loop_closure/loop_candidates.h"

namespace plumbline {

/// A candidate's outcome and, if something matched, the edge between keyframes that it would be
/// (from the earlier to the later one).
struct TestedCandidate {
  ClosureOutcome outcome = ClosureOutcome::kNoMatch;
  RelativePoseConstraint edge;
  double inlier_ratio = 0.0;  ///< share of the scan on surfaces of the other visit
  /// Share of returns that one visit looked through; 0 if too little of the scan matched to ask.
  double conflict = 0.0;
};

/// Tests candidates of the keyframe graph; loop_acceptance.h says what makes one a closure. One
/// result per candidate, in their order. Processes that share the drive share the work
/// (collective); surfaces: all know those of the keyframes.
std::vector<TestedCandidate> TestLoopCandidates(const ScanSurfaces& surfaces,
                                                const KeyframeGraph& keyframe_graph,
                                                const std::vector<LoopCandidate>& candidates,
                                                ThreadPool* pool);

/// All places where a wide candidate fits well enough to be worth a hypothesis, at most max_places
/// per candidate, in order of the candidates and from the best fit. Candidates with the same search
/// should follow each other. Collective, as TestLoopCandidates.
std::vector<TestedCandidate> FindPlaces(const ScanSurfaces& surfaces,
                                        const KeyframeGraph& keyframe_graph,
                                        const std::vector<LoopCandidate>& candidates,
                                        int max_places, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CLOSURE_H_
