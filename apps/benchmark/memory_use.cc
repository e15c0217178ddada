#include "plumbline/apps/benchmark/memory_use.h"

#include <unistd.h>

#include <fstream>

#include "plumbline/apps/io/heap.h"

namespace plumbline {

std::size_t ResidentMemoryBytes() {
  std::size_t num_addressed = 0, num_resident = 0;  // pages
  std::ifstream("/proc/self/statm") >> num_addressed >> num_resident;
  return num_resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void RestartPeakMemory() {
  GiveFreedMemoryBack();
  // Linux: sets the peak of the resident set to its present size (man 5 proc).
  std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace plumbline
