#include "plumbline/apps/figures/map_layout.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace plumbline {
namespace {

class MapLayoutTest : public testing::Test {
 protected:
  // Of a map of 11 x 5 m.
  MapLayout Layout() const { return LayOutMaps(figure_, {{-5.5, 5.5}, {-2.5, 2.5}}, options_); }

  MapFigure figure_;
  MapFigureOptions options_;
};

TEST_F(MapLayoutTest, NothingOverlapsAndAllIsInside) {
  for (int num_panels = 1; num_panels <= 7; ++num_panels) {
    for (int num_details = 0; num_details <= 5; ++num_details) {
      figure_.panels.assign(num_panels, MapPanel());
      figure_.details.assign(num_details, {{0.0, 0.0}, 3.0, 2.0});
      const MapLayout layout = Layout();
      EXPECT_LE(layout.num_columns, 3);
      std::vector<MapView> views = layout.details;
      views.push_back(layout.map);
      for (std::size_t i = 0; i < views.size(); ++i) {
        const MapView& a = views[i];
        EXPECT_GE(a.left_px, 2.0 * layout.font_px);
        EXPECT_LE(a.left_px + a.raster.width, layout.panel_width_px);
        EXPECT_GE(a.top_px, layout.font_px);
        EXPECT_LE(a.top_px + a.raster.height + 2.0 * layout.font_px, layout.panel_height_px);
        for (std::size_t j = 0; j < i; ++j) {
          const MapView& b = views[j];
          const bool beside =
              a.left_px > b.left_px + b.raster.width || b.left_px > a.left_px + a.raster.width;
          const bool below =
              a.top_px > b.top_px + b.raster.height || b.top_px > a.top_px + a.raster.height;
          EXPECT_TRUE(beside || below) << num_panels << ' ' << num_details;
        }
      }
    }
  }
}

TEST_F(MapLayoutTest, MoreThanThreePanelsGoToRowsOfEqualLength) {
  for (const auto& [num_panels, columns] :
       {std::pair{1, 1}, {2, 2}, {3, 3}, {4, 2}, {5, 3}, {9, 3}}) {
    figure_.panels.assign(num_panels, MapPanel());
    EXPECT_EQ(Layout().num_columns, columns) << num_panels;
    EXPECT_EQ(Layout().height_px % Layout().panel_height_px, 0);
  }
}

TEST_F(MapLayoutTest, ATallMapIsNoTallerThanAllowed) {
  figure_.panels = {MapPanel()};
  options_.max_map_height_px = 300;
  EXPECT_LE(Layout().map.raster.height, 301);
  EXPECT_NEAR(Layout().map.raster.width, 660, 2);
}

}  // namespace
}  // namespace plumbline
