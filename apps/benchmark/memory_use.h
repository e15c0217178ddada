#ifndef PLUMBLINE_APPS_BENCHMARK_MEMORY_USE_H_
#define PLUMBLINE_APPS_BENCHMARK_MEMORY_USE_H_

#include <cstddef>

namespace plumbline {

/// Resident memory of this process now [bytes]; 0 where the system does not tell.
std::size_t ResidentMemoryBytes();

/// Gives free memory back to the system and lets PeakMemoryBytes() count from now on. A system that
/// cannot forget a peak goes on from the start of the process.
void RestartPeakMemory();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_MEMORY_USE_H_
