#include "plumbline/solvers/association/held_out_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr std::size_t kOneIn = HeldOutReturns::kOneIn;

TEST(HeldOutReturnsTest, AreEverySixteenthOfEachScan) {
  const NoisyRoom room = MakeNoisyRoom();
  std::vector<int> of_return(room.graph.num_returns());
  std::iota(of_return.begin(), of_return.end(), 0);
  const std::vector<int> without = WithoutHeldOut(room.graph, of_return, -1);
  for (int s = 0; s < room.graph.num_scans(); ++s) {
    const ScanEntry& scan = room.graph.scan(s);
    std::size_t count = 0;
    for (std::size_t k = 0; k < scan.num_returns; ++k) {
      const int value = without[scan.first_return + k];
      const bool held_out = k % kOneIn == HeldOutReturns::FirstOf(s);
      EXPECT_EQ(value, held_out ? -1 : of_return[scan.first_return + k]);
      count += held_out ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(count), static_cast<double>(scan.num_returns) / kOneIn, 1.0);
  }
}

TEST(HeldOutReturnsTest, EveryDirectionHasItsTurnAlsoWhereLasersScanByTurns) {
  for (const int stride : {1, 2, 3, 4, 8, 16}) {
    constexpr int kNumScans = 1600;
    std::vector<int> counts(kOneIn, 0);
    for (int i = 0; i < kNumScans; ++i) {
      const std::size_t first = HeldOutReturns::FirstOf(i * stride);
      ASSERT_LT(first, kOneIn);
      ++counts[first];
    }
    const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
    EXPECT_GT(*least, 85) << stride;
    EXPECT_LT(*most, 115) << stride;
  }
}

TEST(HeldOutReturnsTest, AScanTooShortToHaveOneIsLeftAlone) {
  SlamGraph graph;
  const int laser = graph.AddLaser(PanoramicLaser(1));
  const int pose = graph.AddPose(Pose2(), 0.0);
  int scan = 0;
  while (HeldOutReturns::FirstOf(scan) == 0) {
    graph.AddScan(pose, laser, {1.0});
    ++scan;
  }
  graph.AddScan(pose, laser, {1.0});
  EXPECT_EQ(WithoutHeldOut(graph, std::vector<int>(graph.num_returns(), 5), 7).back(), 5);
}

TEST(HeldOutReturnsTest, AreCountedWithoutListingThem) {
  const SlamGraph graph = MakeNoisyRoom().graph;
  for (int s = 0; s < graph.num_scans(); ++s) {
    std::size_t count = 0;
    HeldOutReturns::ForEachOf(graph, s, [&](std::size_t) { ++count; });
    EXPECT_EQ(HeldOutReturns::CountOf(graph, s), count);
  }
}

}  // namespace
}  // namespace plumbline
