#ifndef PLUMBLINE_APPS_RUN_WRITE_TASKS_H_
#define PLUMBLINE_APPS_RUN_WRITE_TASKS_H_

#include <functional>
#include <vector>

#include "plumbline/core/peers.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

/// What a process does without asking the others. It changes nothing that other tasks use.
using OwnTask = std::function<Status()>;

/// Writes one of a run's files. Processes that share a graph gather together what goes into it
/// (collective). *rest becomes what is left for process `writer` to do by itself, with what it
/// needs for that; nothing if it is null. What the others get there is not run.
using WriteTask = std::function<Status(int writer, OwnTask* rest)>;

/// A task that one process does by itself.
WriteTask ByOne(OwnTask task);

/// A task that all processes do together (collective).
WriteTask Together(OwnTask task);

/// Runs all tasks side by side; gives the error of the first one that failed. What a task throws
/// is such an error too. With peers, which run the same tasks, the collective parts come one after
/// the other. They take turns as the writer, and what a process has to do by itself goes on
/// meanwhile on a thread of its own, one task at a time. Every process gets the same error, and no
/// more is gathered after one in gathering; what a task throws goes on.
Status RunAll(const std::vector<WriteTask>& tasks, ThreadPool* pool, const Peers* peers = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_WRITE_TASKS_H_
