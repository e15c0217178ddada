#include "plumbline/apps/pictures/palette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>
#include <utility>

namespace plumbline {
namespace {

TEST(PaletteTest, MarkerAndDashesTellTwentyLinesApartWithoutColour) {
  std::set<std::tuple<Marker, int, double>> styles;
  for (std::size_t i = 0; i < 20; ++i) {
    const SeriesStyle style = StyleOfSeries(i);
    styles.insert({style.marker, style.dash.count, style.dash.lengths[0]});
  }
  EXPECT_EQ(styles.size(), 20u);
}

TEST(PaletteTest, ColoursOfEightLinesDifferAndShowOnWhite) {
  for (std::size_t i = 0; i < 8; ++i) {
    const Rgb a = StyleOfSeries(i).color;
    // Luminance after the sRGB standard's weights.
    EXPECT_LT(0.21 * a.red + 0.72 * a.green + 0.07 * a.blue, 0.7) << i;
    for (std::size_t j = 0; j < i; ++j) {
      const Rgb b = StyleOfSeries(j).color;
      EXPECT_GT(std::hypot(a.red - b.red, a.green - b.green, a.blue - b.blue), 0.2) << i << j;
    }
  }
}

}  // namespace
}  // namespace plumbline
