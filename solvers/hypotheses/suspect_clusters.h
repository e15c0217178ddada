#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_SUSPECT_CLUSTERS_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_SUSPECT_CLUSTERS_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"

namespace plumbline {

/// The clusters of a graph's closures that may be mistakes, each once: those around which passes
/// contradict each other the most, then those that strain the graph the most, a bounded number of
/// either.
///
/// consistency: of the map that the graph makes. explicable_share: of the conflicting returns; see
/// MapConsistency.
std::vector<std::vector<RelativePoseConstraint>> SuspectClusters(const KeyframeGraph& keys,
                                                                 const MapConsistency& consistency,
                                                                 double explicable_share);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_SUSPECT_CLUSTERS_H_
