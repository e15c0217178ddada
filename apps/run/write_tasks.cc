#include "plumbline/apps/run/write_tasks.h"

#include <cstddef>
#include <future>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

Status RunAlone(const WriteTask& task) {
  OwnTask rest;
  PLUMBLINE_RETURN_IF_ERROR(task(0, &rest));
  return rest ? rest() : Status::Ok();
}

// What a process does by itself goes on while it gathers what goes into the next files.
Status RunWithPeers(const std::vector<WriteTask>& tasks, const Peers& peers) {
  std::future<Status> own;
  Status failure;
  const auto end_own = [&] {
    const Status status = own.valid() ? own.get() : Status::Ok();
    if (failure.ok()) failure = status;
  };
  int writer = 0;
  for (const WriteTask& task : tasks) {
    OwnTask rest;
    Status gathered = FirstFailure(&peers, task(writer, &rest));
    if (!gathered.ok()) {
      end_own();
      return gathered;
    }
    if (!rest) continue;
    if (writer == peers.rank()) {
      end_own();  // as much at a time as one of several threads holds
      own = std::async(std::launch::async, std::move(rest));
    }
    writer = (writer + 1) % peers.size();
  }
  end_own();
  return FirstFailure(&peers, failure);
}

}  // namespace

WriteTask ByOne(OwnTask task) {
  return [task = std::move(task)](int, OwnTask* rest) {
    *rest = task;
    return Status::Ok();
  };
}

WriteTask Together(OwnTask task) {
  return [task = std::move(task)](int, OwnTask*) { return task(); };
}

Status RunAll(const std::vector<WriteTask>& tasks, ThreadPool* pool, const Peers* peers) {
  if (peers != nullptr) return RunWithPeers(tasks, *peers);
  std::vector<Status> results(tasks.size());
  pool->ForEachChunk(tasks.size(), 1, [&](std::size_t, std::size_t begin, std::size_t) {
    results[begin] = CatchExceptions([&] { return RunAlone(tasks[begin]); });
  });
  for (const Status& result : results) PLUMBLINE_RETURN_IF_ERROR(result);
  return Status::Ok();
}

}  // namespace plumbline
