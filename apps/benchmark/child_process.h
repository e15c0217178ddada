#ifndef PLUMBLINE_APPS_BENCHMARK_CHILD_PROCESS_H_
#define PLUMBLINE_APPS_BENCHMARK_CHILD_PROCESS_H_

#include <functional>
#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Runs `work` in a process of its own, which starts as a copy of this one, and hands back the
/// text that it returns. What it does to memory, or a crash of it, does not reach the caller. No
/// other thread of the caller may hold a lock meanwhile. On Linux it ends with the caller, whatever
/// ends that.
///
/// Unavailable, with `result` untouched, if the system gives no process or the process comes to an
/// end before the work does; the message names the signal or the exit code.
Status RunInChild(const std::function<std::string()>& work, std::string* result);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_CHILD_PROCESS_H_
