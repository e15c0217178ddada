#include "plumbline/apps/figures/map_layout.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>

#include "plumbline/apps/pictures/cairo_canvas.h"

namespace plumbline {
namespace {

constexpr int kMaxColumns = 3;
// In font sizes. The margin at the right holds half of the last label.
constexpr double kTitle = 1.9, kRightMargin = 1.4, kGapBelow = 0.5, kMinDetail = 11.0;

// The fewest columns with which `count` things come in as many rows as with max_columns.
int Columns(int count, int max_columns) {
  const int rows = (count + max_columns - 1) / max_columns;
  return (count + rows - 1) / rows;
}

MapExtent ExtentOf(const MapWindow& window) {
  const double x = 0.5 * window.width_m, y = 0.5 * window.height_m;
  return {{window.center_m.x() - x, window.center_m.x() + x},
          {window.center_m.y() - y, window.center_m.y() + y}};
}

MapView ViewOf(const MapExtent& extent, double pixel_m) {
  MapView view;
  view.raster.pixel_m = pixel_m;
  view.raster.left_m = extent.x.low;
  view.raster.top_m = extent.y.high;
  view.raster.width = std::max(1, static_cast<int>(std::lround(extent.x.length() / pixel_m)));
  view.raster.height = std::max(1, static_cast<int>(std::lround(extent.y.length() / pixel_m)));
  return view;
}

// Measures texts; nothing is drawn.
class Layouter {
 public:
  explicit Layouter(double font_px)
      : font_px_(font_px),
        surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1)),
        context_(cairo_create(surface_.get())) {
    SelectFont(font_px, context_.get());
  }

  // Puts the view's axes at (left, top); gives the height that it takes.
  int Place(int left, int top, MapView* view) const {
    view->left_px = left + LeftMargin(*view);
    view->top_px = top + TitlePx();
    return TitlePx() + view->raster.height +
           static_cast<int>(BottomMarginPx(font_px_) + kGapBelow * font_px_);
  }

  int LeftMargin(const MapView& view) const {
    return static_cast<int>(0.3 * font_px_ +
                            LeftMarginPx(view.Frame(0.0, 0.0, font_px_), context_.get()));
  }

  // Size of a pixel that brings an extent into a width, axes included, and a height [m].
  double PixelFor(const MapExtent& extent, double width_px, double height_px) const {
    double pixel_m = 0.0, margin_px = 3.0 * font_px_;
    // Labels depend on the scale, and the scale on the room that they leave.
    for (int i = 0; i < 2; ++i) {
      const double room_px = std::max(1.0, width_px - margin_px - kRightMargin * font_px_);
      pixel_m = std::max(extent.x.length() / room_px, extent.y.length() / height_px);
      margin_px = LeftMargin(ViewOf(extent, pixel_m));
    }
    return std::max(pixel_m, extent.x.length() / (width_px - margin_px - kRightMargin * font_px_));
  }

  int TitlePx() const { return static_cast<int>(kTitle * font_px_); }

 private:
  const double font_px_;
  const CairoSurface surface_;
  const CairoContext context_;
};

// Details in rows below `top`; gives the bottom of the last.
int PlaceDetails(const std::vector<MapWindow>& windows, int top, double max_height_px,
                 const Layouter& layouter, MapLayout* layout) {
  const int count = static_cast<int>(windows.size());
  const int room = static_cast<int>(layout->panel_width_px / (kMinDetail * layout->font_px));
  const int columns = Columns(count, std::clamp(room, 1, kMaxColumns));
  const int width_px = layout->panel_width_px / columns;
  double pixel_m = 0.0;
  for (const MapWindow& window : windows) {
    pixel_m = std::max(pixel_m, layouter.PixelFor(ExtentOf(window), width_px, max_height_px));
  }
  int bottom = top;
  for (int i = 0; i < count; ++i) {
    if (i % columns == 0) top = bottom;
    layout->details.push_back(ViewOf(ExtentOf(windows[i]), pixel_m));
    MapView* view = &layout->details.back();
    bottom = std::max(bottom, top + layouter.Place(i % columns * width_px, top, view));
  }
  return bottom;
}

}  // namespace

PlotFrame MapView::Frame(double left, double top, double font_px) const {
  PlotFrame frame;
  frame.font_px = font_px;
  frame.x = {{raster.left_m, raster.left_m + raster.width * raster.pixel_m},
             left + left_px,
             left + left_px + raster.width,
             "x [m]"};
  frame.y = {{raster.top_m - raster.height * raster.pixel_m, raster.top_m},
             top + top_px + raster.height,
             top + top_px,
             "y [m]"};
  return frame;
}

MapLayout LayOutMaps(const MapFigure& figure, const MapExtent& extent,
                     const MapFigureOptions& options) {
  const int num_panels = static_cast<int>(figure.panels.size());
  MapLayout layout;
  layout.font_px = PrintFontPx(options.width_px);
  const Layouter layouter(layout.font_px);
  layout.title_px = layouter.TitlePx();
  layout.num_columns = Columns(num_panels, kMaxColumns);
  layout.panel_width_px = options.width_px / layout.num_columns;
  layout.map =
      ViewOf(extent, layouter.PixelFor(extent, layout.panel_width_px, options.max_map_height_px));
  layout.panel_height_px = layouter.Place(0, 0, &layout.map);
  if (!figure.details.empty()) {
    layout.panel_height_px = PlaceDetails(figure.details, layout.panel_height_px,
                                          options.max_map_height_px, layouter, &layout);
  }
  const int num_rows = (num_panels + layout.num_columns - 1) / layout.num_columns;
  layout.height_px = num_rows * layout.panel_height_px;
  return layout;
}

}  // namespace plumbline
