#include "plumbline/apps/benchmark/memory_use.h"

#include <fstream>

#include "plumbline/apps/program/heap.h"
#include "plumbline/apps/program/resident_memory.h"

namespace plumbline {

std::size_t ResidentMemoryBytes() {
  return static_cast<std::size_t>(ResidentMemory().Read().total);
}

void RestartPeakMemory() {
  GiveFreedMemoryBack();
  // Linux: sets the peak of the resident set to its present size (man 5 proc).
  std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace plumbline
