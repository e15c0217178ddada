#ifndef PLUMBLINE_APPS_BENCHMARK_RUN_CASES_H_
#define PLUMBLINE_APPS_BENCHMARK_RUN_CASES_H_

#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

/// Spreads whole runs over the threads: Status run(case, outcome*). `outcomes` are in the order of
/// the cases, and untouched if a run fails: the status is that of the first one that does.
template <typename Case, typename Outcome, typename Run>
Status RunCases(const std::vector<Case>& cases, ThreadPool* pool, const Run& run,
                std::vector<Outcome>* outcomes) {
  std::vector<Outcome> results(cases.size());
  std::vector<Status> statuses(cases.size());
  pool->ForEachChunk(cases.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    statuses[i] = run(cases[i], &results[i]);
  });
  for (const Status& status : statuses) PLUMBLINE_RETURN_IF_ERROR(status);
  *outcomes = std::move(results);
  return Status::Ok();
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_RUN_CASES_H_
