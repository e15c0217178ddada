#include "plumbline/apps/figures/line_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool IsBlue(std::uint32_t rgb) { return Channel(rgb, 0) > 150 + Channel(rgb, 16); }
bool IsVermilion(std::uint32_t rgb) { return Channel(rgb, 16) > 150 + Channel(rgb, 0); }
// The faint blue of a band, over white or over a line of the grid.
bool IsBand(std::uint32_t rgb) {
  const int over = Channel(rgb, 0) - Channel(rgb, 16);
  return over > 30 && over < 60;
}

class LineChartTest : public testing::Test {
 protected:
  LineChartTest() {
    chart_.title = "title";
    chart_.x_label = "x [m]";
    chart_.y_label = "y [m]";
    chart_.series = {{"first", {0.0, 5.0}, {0.0, 5.0}, {}, {}}, {"second", {10.0}, {10.0}, {}, {}}};
  }
  Picture Draw() {
    const Status status = WriteLineChart(path_, chart_, 1200, 800);
    EXPECT_TRUE(status.ok()) << status.message();
    return Picture(path_);
  }
  void ExpectRefused(const std::string& message) const {
    const Status status = WriteLineChart(path_, chart_, 1200, 800);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), AllOf(HasSubstr(path_), HasSubstr(message)));
    EXPECT_EQ(NumFilesIn(folder_), 0);
  }

  const std::string folder_ = TempFolder();
  const std::string path_ = folder_ + "chart.png";
  LineChart chart_;
};

TEST_F(LineChartTest, PointsLieWhereTheAxesSay) {
  const Picture picture = Draw();
  EXPECT_EQ(picture.width, 1200);
  EXPECT_EQ(picture.height, 800);
  const Box frame = picture.Around(IsBlack, Box{100, 1190, 40, 600});
  // From the lower left corner to the middle, a marker's radius beyond either.
  const Box plot{0, picture.width, 0, 740};
  const Box line = picture.Around(IsBlue, plot);
  const Box point = picture.Around(IsVermilion, plot);
  const int radius = point.height() / 2;
  const double left = line.left + radius, bottom = line.bottom - radius;
  EXPECT_NEAR(line.right - radius, 0.5 * (left + point.center_x()), 3);
  EXPECT_NEAR(line.top + radius, 0.5 * (bottom + point.center_y()), 3);
  EXPECT_NEAR(point.center_y(), frame.top, 3);
  EXPECT_GT(point.center_x() - left, 1000);
  // Both have their sample in the legend.
  const Box legend{0, picture.width, 755, picture.height};
  EXPECT_GT(picture.Around(IsBlue, legend).height(), 8);
  EXPECT_GT(picture.Around(IsVermilion, legend).left, 100);
}

TEST_F(LineChartTest, BandsAreFilledBetweenTheirEnds) {
  const int without = Draw().Count(IsBand);
  chart_.series[0].low = {0.0, 2.0};
  chart_.series[0].high = {4.0, 8.0};
  const Picture picture = Draw();
  // Half of 10 m wide, on average 5 of 10 m high.
  EXPECT_GT(picture.Count(IsBand) - without, 0.2 * 1000 * 600);
  EXPECT_LT(picture.Count(IsBand) - without, 0.3 * 1100 * 700);
}

TEST_F(LineChartTest, ABandBeyondTheLinesWidensTheAxis) {
  chart_.series = {{"a", {0.0, 1.0}, {1.0, 1.0}, {-99.0, -99.0}, {99.0, 99.0}}};
  const Picture picture = Draw();
  const Box line = picture.Around(IsBlue, Box{200, 1000, 40, 640});
  EXPECT_NEAR(line.center_y(), 350.0, 30.0);
}

TEST_F(LineChartTest, TheSameChartGivesTheSameBytes) {
  Draw();
  const std::string first = ReadFile(path_);
  Draw();
  EXPECT_EQ(ReadFile(path_), first);
}

TEST_F(LineChartTest, ExtremeValuesStillMakeAPicture) {
  chart_.series[0] = {"huge", {-1e100, 1e100}, {0.0, 0.0}, {}, {}};
  Draw();
  chart_.log_x = chart_.log_y = true;
  chart_.series = {{"wide", {1e-100, 1e100}, {1.0, 1.0}, {}, {}}};
  Draw();
}

TEST_F(LineChartTest, ValuesWithoutAPlaceAreRefused) {
  chart_.series[0].y[1] = kNaN;
  ExpectRefused("series 'first', point 1: y = nan");
  chart_.series[0].y[1] = 1e200;
  ExpectRefused("series 'first', point 1");
  chart_.series[0].y[1] = 1.0;
  chart_.log_x = true;
  ExpectRefused("series 'first', point 0: x = 0.000000 has no place on a logarithmic axis");
}

TEST_F(LineChartTest, LengthsThatDifferAreRefused) {
  chart_.series[1].x.clear();
  ExpectRefused("'second'");
  chart_.series[1].x = {1.0};
  chart_.series[1].low = {1.0};
  ExpectRefused("'second'");
}

TEST_F(LineChartTest, NothingToDrawAndBadSizesAreRefused) {
  for (const int side : {199, 10001, -5}) {
    EXPECT_THAT(WriteLineChart(path_, chart_, side, 500).message(),
                HasSubstr(std::to_string(side)));
    EXPECT_FALSE(WriteLineChart(path_, chart_, 500, side).ok());
  }
  for (int i = 0; i < 200; ++i) chart_.series.push_back({std::string(50, 'a'), {}, {}, {}, {}});
  ExpectRefused("too small");
  chart_.series = {{"empty", {}, {}, {}, {}}};
  ExpectRefused("no point");
  chart_.series.clear();
  ExpectRefused("no point");
}

TEST_F(LineChartTest, AMissingFolderIsUnavailable) {
  EXPECT_EQ(WriteLineChart(folder_ + "none/a.png", chart_, 500, 500).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
