#include "plumbline/apps/benchmark/convergence_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

bool IsBlue(std::uint32_t rgb) { return Channel(rgb, 0) > 100 + Channel(rgb, 16); }
bool IsVermilion(std::uint32_t rgb) { return Channel(rgb, 16) > 100 + Channel(rgb, 0); }

ConvergencePlot TwoLines() {
  ConvergencePlot plot;
  plot.title = "title";
  plot.x_label = "time [s]";
  plot.y_label = "gap [fraction]";
  // From a corner of the frame to its middle; and a single point.
  plot.lines = {{"first", {{0.1, 1.0}, {1.0, 0.1}}}, {"second", {{10.0, 0.01}}}};
  return plot;
}

class ConvergencePlotTest : public testing::Test {
 protected:
  Picture Draw(const ConvergencePlot& plot) {
    const Status status = WriteConvergencePlot(path_, plot);
    EXPECT_TRUE(status.ok()) << status.message();
    return Picture(path_);
  }
  const std::string folder_ = TempFolder();
  const std::string path_ = folder_ + "plot.png";
};

TEST_F(ConvergencePlotTest, PointsLieWhereTheDecadesSay) {
  const Picture picture = Draw(TwoLines());
  EXPECT_EQ(picture.width, 1200);
  constexpr int kLegendTop = 790;
  const Box plot{0, picture.width, 0, kLegendTop};
  const Box line = picture.Around(IsBlue, plot);
  const Box point = picture.Around(IsVermilion, plot);
  // The point is in the corner opposite to the line's start, which a disc of 7 px surrounds.
  EXPECT_NEAR(line.right - 7, 0.5 * (line.left + 7 + point.center_x()), 3);
  EXPECT_NEAR(line.bottom - 7, 0.5 * (line.top + 7 + point.center_y()), 3);
  EXPECT_GT(point.center_x() - line.left, 1000);
  EXPECT_GT(point.center_y() - line.top, 600);
  EXPECT_GT(picture.Count(IsBlack), 300);  // the texts
  // Both have their sample in the legend.
  const Box legend{0, picture.width, kLegendTop, picture.height};
  EXPECT_GT(picture.Around(IsBlue, legend).height(), 8);
  EXPECT_GT(picture.Around(IsVermilion, legend).left, 100);
}

TEST_F(ConvergencePlotTest, WhatHasNoPlaceOnALogarithmicAxisIsLeftOut) {
  ConvergencePlot plot = TwoLines();
  Draw(plot);
  const std::string without = ReadFile(path_);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  plot.lines[0].points.insert(
      plot.lines[0].points.begin(),
      {{0.0, 1.0}, {1.0, -1.0}, {kNaN, 1.0}, {1.0, std::numeric_limits<double>::infinity()}});
  Draw(plot);
  EXPECT_TRUE(ReadFile(path_) == without);
}

TEST_F(ConvergencePlotTest, ALongLegendLeavesThePlotItsSize) {
  const Picture short_legend = Draw(TwoLines());
  ConvergencePlot plot = TwoLines();
  for (int i = 2; i < 20; ++i) {
    plot.lines.push_back({"ceres reduced line_search nonlinear_conjugate_gradient polak_ribiere " +
                              std::to_string(i),
                          {{1.0, 0.1}}});
  }
  const Picture picture = Draw(plot);
  EXPECT_EQ(picture.width, 1200);
  // Two lines fit in one row of the legend; the others have one each.
  const int rows_px = picture.height - short_legend.height;
  EXPECT_NEAR(rows_px, 19 * 32, 20);
  constexpr int kLegendTop = 790;
  EXPECT_NEAR(picture.Around(IsBlue, {0, picture.width, 0, kLegendTop}).height(),
              short_legend.Around(IsBlue, {0, picture.width, 0, kLegendTop}).height(), 5);
}

TEST_F(ConvergencePlotTest, NothingToDrawIsAnError) {
  ConvergencePlot plot = TwoLines();
  plot.lines = {{"empty", {{0.0, 1.0}}}};
  const Status status = WriteConvergencePlot(path_, plot);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr(path_));
  EXPECT_EQ(NumFilesIn(folder_), 0);
  EXPECT_EQ(WriteConvergencePlot(folder_ + "none/plot.png", TwoLines()).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
