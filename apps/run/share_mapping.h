#ifndef PLUMBLINE_APPS_RUN_SHARE_MAPPING_H_
#define PLUMBLINE_APPS_RUN_SHARE_MAPPING_H_

#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/map_sessions.h"

namespace plumbline {

/// Whether there are several processes, process 0 says that they can, and all compute the same bits
/// of common functions. Where processors are of several kinds they may not, and then cannot each
/// take the decisions of the seeding for itself. Collective.
bool CanShareSeeding(const Peers& peers, bool says_it_can);

/// From now on takes less memory and more time, if several processes share many returns.
void SaveMemory(const Peers& peers, std::size_t num_returns_of_all);

/// Divides a log that process 0 has taken over (TakeLog) among all processes by time, for SeedLog;
/// process 0 keeps the rest of its report. Collective. What *mapping was elsewhere does not matter.
Status ShareLog(const Peers* peers, LogMapping* mapping);

/// Divides a log that process 0 has seeded (SeedLog) among all processes by place: each gets what
/// RefineLog needs, with the part of the graph that SlamGraph::ShareWith describes, and process 0
/// keeps the rest of its report. Collective. What *mapping was elsewhere does not matter.
Status ShareMapping(const Peers* peers, const MapLogOptions& options, ThreadPool* pool,
                    LogMapping* mapping);

/// Gives all processes what process 0 has seeded (SeedSessions), as ShareMapping does for each map;
/// process 0 keeps the ties. Collective. What *mapping was elsewhere does not matter.
Status ShareSessions(const Peers* peers, const MapLogOptions& options, ThreadPool* pool,
                     SessionsMapping* mapping);

/// All processes make the same pictures and the same grid as process 0.
void ShareLimits(const Peers* peers, RunOutputOptions* outputs);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_SHARE_MAPPING_H_
