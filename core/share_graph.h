#ifndef PLUMBLINE_CORE_SHARE_GRAPH_H_
#define PLUMBLINE_CORE_SHARE_GRAPH_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Divides the graph of process 0 among all: *graph becomes the part of this process, which
/// SlamGraph::ShareWith describes; what it was elsewhere does not matter. rank_of_pose: who gets
/// the scans of each pose, as PartitionByPlace or PartitionByTime has it; needed in process 0.
/// Collective. Fails on a graph that refused a measurement or has corrected lasers that are equal.
Status ShareGraph(const Peers* peers, std::vector<int> rank_of_pose, SlamGraph* graph);

/// The same by place (PartitionByPlace). poses: where to divide, as MapState::poses; needed in
/// process 0.
Status ShareGraphByPlace(const Peers* peers, const std::vector<double>& poses, SlamGraph* graph);

/// Divides a graph that is shared in another way: *part and what its scans saw become those of the
/// new part of this process. rank_of_pose: the same in all processes. Collective.
void ShareAnew(std::vector<int> rank_of_pose, SlamGraph* part, MeasuredSurface* surface);

/// The same by place. poses: where to divide, the same in all processes.
void ShareAnewByPlace(const std::vector<double>& poses, SlamGraph* part, MeasuredSurface* surface);

/// The first sweep of a part that is this one of all or comes after it; their number if there is
/// none. Those of a part are in the order of all.
int FirstOwnScanFrom(const SlamGraph& part, int id_among_all);

/// Which sweep of a part one of all is; -1 if others have it.
int OwnScan(const SlamGraph& part, int id_among_all);

/// Sweeps that other processes have: a graph of no poses, with all lasers of the part `graph`, and
/// of the sweeps those with these ids among all, in this order. Collective: every process asks for
/// what it wants, also if that is nothing.
SlamGraph FetchScans(const SlamGraph& graph, const std::vector<int>& ids_among_all);

/// The same with what they saw. surface: of the part.
SlamGraph FetchScans(const SlamGraph& graph, const MeasuredSurface& surface,
                     const std::vector<int>& ids_among_all, MeasuredSurface* fetched_surface);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_SHARE_GRAPH_H_
