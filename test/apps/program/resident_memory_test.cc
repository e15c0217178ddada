#include "plumbline/apps/program/resident_memory.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace plumbline {
namespace {

TEST(ResidentMemoryTest, CountsWhatIsTouched) {
  const ResidentMemory memory;
  const Resident before = memory.Read();
  EXPECT_GT(before.total, before.unshared);
  EXPECT_GT(before.unshared, 0.0);
  constexpr std::size_t kBytes = 32 << 20;
  const std::vector<char> touched(kBytes, 1);
  const Resident after = memory.Read();
  EXPECT_GT(after.total, before.total + 0.9 * kBytes);
  EXPECT_GT(after.unshared, before.unshared + 0.9 * kBytes);
}

}  // namespace
}  // namespace plumbline
