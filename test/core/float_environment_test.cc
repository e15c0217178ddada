#include "plumbline/core/float_environment.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cfenv>
#include <limits>

#include "plumbline/core/thread_pool.h"
#include "plumbline/test/core/host_float_environment.h"

namespace plumbline {
namespace {

// Not constant, so that these happen at run time, under the environment in force.
volatile double one = 1.0, tiny = std::numeric_limits<double>::min();

bool RoundsToNearest() { return one + 1e-20 == 1.0 && -one - 1e-20 == -1.0; }
bool KeepsSubnormals() { return tiny * 0.5 > 0.0; }

TEST(FloatEnvironment, IsTheDefaultInside) {
  for (const HostFloatMode mode : kHostFloatModes) {
    const HostFloatEnvironment host(mode);
    const DefaultFloatEnvironment guard;
    EXPECT_EQ(std::fegetround(), FE_TONEAREST);
    EXPECT_TRUE(RoundsToNearest());
    EXPECT_TRUE(KeepsSubnormals());
  }
}

TEST(FloatEnvironment, IsTheHostsAgainOutside) {
  {
    const HostFloatEnvironment host(HostFloatMode::kRoundUp);
    ASSERT_FALSE(RoundsToNearest());
    { const DefaultFloatEnvironment guard; }
    EXPECT_EQ(std::fegetround(), FE_UPWARD);
    EXPECT_FALSE(RoundsToNearest());
  }
  if (!HostFloatEnvironment::kCanFlush) GTEST_SKIP() << "no switch to flush subnormals known";
  const HostFloatEnvironment host(HostFloatMode::kFlushSubnormals);
  ASSERT_FALSE(KeepsSubnormals());
  { const DefaultFloatEnvironment guard; }
  EXPECT_FALSE(KeepsSubnormals());
}

TEST(FloatEnvironment, LeavesNoExceptionFlagsBehind) {
  std::feclearexcept(FE_ALL_EXCEPT);
  {
    const DefaultFloatEnvironment guard;
    const volatile double quotient = one / (one - one);
    EXPECT_GT(quotient, 1.0);
    EXPECT_NE(std::fetestexcept(FE_DIVBYZERO), 0);
  }
  EXPECT_EQ(std::fetestexcept(FE_DIVBYZERO), 0);
}

// Threads inherit the environment of the one that makes them, and a pool may be older or younger
// than the host's choice.
TEST(FloatEnvironment, IsTheDefaultOnEveryThreadOfAPool) {
  ThreadPool older(3);
  for (const HostFloatMode mode : kHostFloatModes) {
    const HostFloatEnvironment host(mode);
    ThreadPool younger(3);
    for (ThreadPool* pool : {&older, &younger}) {
      std::atomic<int> wrong{0};
      pool->ForEachChunk(1000, 1, [&](std::size_t, std::size_t, std::size_t) {
        if (!RoundsToNearest() || !KeepsSubnormals()) ++wrong;
      });
      EXPECT_EQ(wrong, 0);
    }
  }
}

}  // namespace
}  // namespace plumbline
