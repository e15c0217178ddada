#include "plumbline/solvers/full/held_out_ranges.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr double kSigmaM = 0.02;

NoisyRoom RoomWith(double range_sigma_m) {
  NoisyRoomOptions options;
  options.num_beams = 720;
  options.range_sigma_m = range_sigma_m;
  return MakeNoisyRoom(options);
}

double ErrorOf(const NoisyRoom& measured, const MapState& map) {
  ThreadPool pool(1);
  return HeldOutRanges(measured.graph, kSigmaM, &pool).MeanError(map);
}

TEST(HeldOutRangesTest, AreOneInSixteenButThoseBesideSteps) {
  const NoisyRoom room = RoomWith(kSigmaM);
  ThreadPool pool(1);
  const std::size_t count = HeldOutRanges(room.graph, kSigmaM, &pool).size();
  EXPECT_LE(count, room.graph.num_returns() / 16 + room.graph.num_scans());
  EXPECT_GE(count, room.graph.num_returns() / 20);
}

TEST(HeldOutRangesTest, AMapWithoutNoisePredictsRangesWithoutNoise) {
  const NoisyRoom exact = RoomWith(0.0);
  // But for corners, where the line through the neighbours cuts across.
  EXPECT_LT(ErrorOf(exact, exact.state), 0.1);
}

TEST(HeldOutRangesTest, TheTruePointsPredictBetterThanTheMeasuredOnes) {
  const NoisyRoom measured = RoomWith(kSigmaM), exact = RoomWith(0.0);
  ASSERT_EQ(measured.graph.num_returns(), exact.graph.num_returns());
  EXPECT_NEAR(ErrorOf(measured, exact.state), std::sqrt(2.0 / kPi), 0.08);
  EXPECT_NEAR(ErrorOf(measured, measured.state), std::sqrt(3.0 / kPi), 0.08);
}

TEST(HeldOutRangesTest, AWallThatIsBentPredictsBadly) {
  const NoisyRoom measured = RoomWith(kSigmaM);
  NoisyRoom bent = RoomWith(0.0);
  for (std::size_t r = 0; r < bent.graph.num_returns(); ++r) {
    bent.state.points[2 * r] += 0.05 * std::sin(3.0 * bent.state.points[2 * r + 1]);
  }
  EXPECT_GT(ErrorOf(measured, bent.state), 1.1);
}

}  // namespace
}  // namespace plumbline
