#include "plumbline/apps/benchmark/memory_use.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstring>
#include <fstream>

#include "plumbline/apps/report/run_summary.h"

namespace plumbline {
namespace {

constexpr std::size_t kBlock = 64 << 20;

// Takes a block from the system, fills it, and gives it back.
void UseBlock() {
  void* block = mmap(nullptr, kBlock, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(block, MAP_FAILED);
  const std::size_t before = ResidentMemoryBytes();
  std::memset(block, 1, kBlock);
  EXPECT_GT(ResidentMemoryBytes(), before + kBlock / 2);
  munmap(block, kBlock);
}

TEST(MemoryUseTest, APeakCanBeForgotten) {
  if (!std::ofstream("/proc/self/clear_refs").is_open()) GTEST_SKIP() << "not on this system";
  RestartPeakMemory();  // of the tests before
  UseBlock();
  const std::size_t peak = PeakMemoryBytes();
  EXPECT_GE(peak, kBlock);
  RestartPeakMemory();
  EXPECT_LT(PeakMemoryBytes(), peak - kBlock / 2);
  UseBlock();
  EXPECT_GT(PeakMemoryBytes(), peak - kBlock / 2);
}

}  // namespace
}  // namespace plumbline
