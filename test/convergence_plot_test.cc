#include "plumbline/apps/benchmark/convergence_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "plumbline/test/picture.h"
#include "plumbline/test/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

bool IsBlue(std::uint32_t rgb) { return Channel(rgb, 0) > 100 + Channel(rgb, 16); }
bool IsVermilion(std::uint32_t rgb) { return Channel(rgb, 16) > 100 + Channel(rgb, 0); }

// The frame of the plot within the picture.
constexpr int kLeft = 110, kRight = 1170, kTop = 50, kBottom = 670;

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
  const Box plot{0, picture.width, 0, kBottom + 40};
  const Box line = picture.Around(IsBlue, plot);
  EXPECT_NEAR(line.left + 6, kLeft, 3);
  EXPECT_NEAR(line.top + 6, kTop, 3);
  EXPECT_NEAR(line.right - 6, 0.5 * (kLeft + kRight), 3);
  EXPECT_NEAR(line.bottom - 6, 0.5 * (kTop + kBottom), 3);
  const Box point = picture.Around(IsVermilion, plot);
  EXPECT_NEAR(point.center_x(), kRight, 2);
  EXPECT_NEAR(point.center_y(), kBottom, 2);
  EXPECT_GT(picture.Count(IsBlack), 300);  // the texts
  // Both have their sample in the legend.
  const Box legend{0, picture.width, kBottom + 70, picture.height};
  EXPECT_GT(picture.Around(IsBlue, legend).height(), 8);
  EXPECT_GT(picture.Around(IsVermilion, legend).left, 600);
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

TEST_F(ConvergencePlotTest, NothingToDrawIsAnError) {
  ConvergencePlot plot = TwoLines();
  plot.lines = {{"empty", {{0.0, 1.0}}}};
  const Status status = WriteConvergencePlot(path_, plot);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr(path_));
  EXPECT_EQ(NumFilesIn(folder_), 0);
  EXPECT_EQ(WriteConvergencePlot(folder_ + "none/plot.png", TwoLines()).code(),
            StatusCode::kNotFound);
}

}  // namespace
}  // namespace plumbline
