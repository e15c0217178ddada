#include "plumbline/apps/figures/plot_axes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace plumbline {
namespace {

using testing::ElementsAre;

std::vector<std::string> Labels(const AxisRange& range, int max_labels) {
  std::vector<std::string> labels;
  for (const AxisTick& tick : TicksOf(range, max_labels)) {
    if (!tick.label.empty()) labels.push_back(tick.label);
  }
  return labels;
}

TEST(PlotAxesTest, LinearTicksAreRoundAndHaveEqualDecimals) {
  EXPECT_THAT(Labels({0.0, 1.0, false}, 6), ElementsAre("0.0", "0.2", "0.4", "0.6", "0.8", "1.0"));
  EXPECT_THAT(Labels({-1.5, 1.2, false}, 3), ElementsAre("-1", "0", "1"));
  EXPECT_THAT(Labels({-26.0, 16.0, false}, 5), ElementsAre("-20", "-10", "0", "10"));
  EXPECT_THAT(Labels({0.0101, 0.0149, false}, 8), ElementsAre("0.011", "0.012", "0.013", "0.014"));
  EXPECT_THAT(Labels({0.0, 3e7, false}, 4), ElementsAre("0", "10000000", "20000000", "30000000"));
}

TEST(PlotAxesTest, LogarithmicTicksAreDecadesAndFractionsWhereThereIsRoom) {
  EXPECT_THAT(Labels({1e-5, 1e4, true}, 12),
              ElementsAre("1e-5", "1e-4", "0.001", "0.01", "0.1", "1", "10", "100", "1000", "1e4"));
  EXPECT_THAT(Labels({1e-5, 1e4, true}, 5), ElementsAre("1e-5", "0.01", "10", "1e4"));
  EXPECT_THAT(Labels({0.5, 20.0, true}, 8), ElementsAre("0.5", "1", "2", "5", "10", "20"));
  EXPECT_THAT(Labels({0.5, 20.0, true}, 3), ElementsAre("1", "10"));
  // Finer lines without label: 0.2 to 0.9, 2 to 9.
  EXPECT_EQ(TicksOf({0.1, 10.0, true}, 3).size(), 3u + 16u);
}

TEST(PlotAxesTest, TicksNeverOutnumberTheirRoomAndThereIsOne) {
  for (const bool log : {false, true}) {
    for (int max_labels = 2; max_labels < 15; ++max_labels) {
      for (double length = 1e-3; length < 1e6; length *= 3.7) {
        const AxisRange range = RoundedRange(0.37, 0.37 + length, log, max_labels);
        EXPECT_LE(range.low, 0.37 * (1.0 + 1e-9));
        EXPECT_GE(range.high, (0.37 + length) * (1.0 - 1e-9));
        const std::size_t num_labels = Labels(range, max_labels).size();
        EXPECT_LE(num_labels, static_cast<std::size_t>(max_labels)) << length << log;
        EXPECT_GE(num_labels + (log && length < 10.0), 1u) << length << log;
      }
    }
  }
}

TEST(PlotAxesTest, RangesEndAtTicks) {
  const AxisRange linear = RoundedRange(0.012, 0.118, false, 8);
  EXPECT_DOUBLE_EQ(linear.low, 0.0);
  EXPECT_DOUBLE_EQ(linear.high, 0.12);
  const AxisRange log = RoundedRange(0.03, 70.0, true, 8);  // more than three decades
  EXPECT_DOUBLE_EQ(log.low, 0.01);
  EXPECT_DOUBLE_EQ(log.high, 100.0);
  const AxisRange narrow = RoundedRange(0.3, 40.0, true, 8);
  EXPECT_DOUBLE_EQ(narrow.low, 0.2);
  EXPECT_DOUBLE_EQ(narrow.high, 50.0);
  const AxisRange exact = RoundedRange(0.1, 10.0, true, 8);
  EXPECT_DOUBLE_EQ(exact.low, 0.1);
  EXPECT_DOUBLE_EQ(exact.high, 10.0);
}

TEST(PlotAxesTest, ASingleValueGetsARangeAroundIt) {
  for (const double value : {0.0, 5.0, -3e8, 1e-7}) {
    const AxisRange range = RoundedRange(value, value, false, 6);
    EXPECT_LT(range.low, value);
    EXPECT_GT(range.high, value);
    EXPECT_GE(Labels(range, 6).size(), 2u);
  }
  const AxisRange log = RoundedRange(1.0, 1.0, true, 6);
  EXPECT_LT(log.low, 1.0);
  EXPECT_GT(log.high, 1.0);
}

TEST(PlotAxesTest, ValuesLieWhereTheScaleSays) {
  PlotAxis axis{{1.0, 100.0, true}, 200.0, 100.0, ""};
  EXPECT_NEAR(axis.At(10.0), 150.0, 1e-9);
  axis.range = {0.0, 4.0, false};
  EXPECT_NEAR(axis.At(1.0), 175.0, 1e-9);
}

TEST(PlotAxesTest, FontsAreOfEightPointsInPrint) {
  // 16 cm are 453.5 pt.
  EXPECT_NEAR(PrintFontPx(4535) / 4535.0 * 453.5, 8.0, 1e-2);
}

}  // namespace
}  // namespace plumbline
