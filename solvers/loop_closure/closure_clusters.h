#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSURE_CLUSTERS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSURE_CLUSTERS_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"

namespace plumbline {

/// Loop closures that stand or fall together, by index: their later keyframes lie within one short
/// stretch of the path, and their earlier ones at one place of the map. Where two places look
/// alike, all scans of the one match the other: they are one witness, however many they are.
using ClosureCluster = std::vector<int>;

/// Divides closures of the graph into clusters, in order of the path of their later keyframes. Each
/// is in one of them.
std::vector<ClosureCluster> FindClosureClusters(const std::vector<RelativePoseConstraint>& closures,
                                                const KeyframeGraph& keys);

/// Whether a closure puts the same part of the path at the same place as another one does, by the
/// poses of the graph.
bool RepeatsOneOf(const RelativePoseConstraint& closure,
                  const std::vector<RelativePoseConstraint>& others, const KeyframeGraph& keys);

/// At most `most` of the closures, in their order, that repeat none of those before them.
std::vector<RelativePoseConstraint> WithoutRepetitions(
    const std::vector<RelativePoseConstraint>& closures, std::size_t most,
    const KeyframeGraph& keys);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSURE_CLUSTERS_H_
