#include "plumbline/apps/figures/map_figure.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "plumbline/apps/figures/map_layout.h"
#include "plumbline/apps/figures/plot_axes.h"
#include "plumbline/apps/figures/series_marks.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/map_raster.h"
#include "plumbline/apps/pictures/cairo_canvas.h"
#include "plumbline/apps/pictures/palette.h"
#include "plumbline/apps/pictures/scale_bar.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr double kMaxFigureM = 1e9;
constexpr std::size_t kMaxDetails = 26;  // letters

bool IsPlace(double value) { return std::abs(value) <= kMaxFigureM; }  // false for NaN

bool IsPlace(const Eigen::Vector2d& point) { return IsPlace(point.x()) && IsPlace(point.y()); }

std::string CheckPanel(const MapPanel& panel) {
  if (panel.points.size() % 2 != 0) return "an odd number of coordinates";
  if (panel.points.empty() && panel.trajectory.empty()) return "neither points nor trajectory";
  for (std::size_t i = 0; i < panel.points.size(); ++i) {
    if (!IsPlace(panel.points[i])) return "point " + std::to_string(i / 2) + " is nowhere";
  }
  for (std::size_t i = 0; i < panel.trajectory.size(); ++i) {
    if (!IsPlace(panel.trajectory[i].translation())) {
      return "pose " + std::to_string(i) + " is nowhere";
    }
  }
  for (std::size_t i = 0; i < panel.truth_lines.size(); ++i) {
    if (!IsPlace(panel.truth_lines[i].first) || !IsPlace(panel.truth_lines[i].second)) {
      return "truth line " + std::to_string(i) + " is nowhere";
    }
  }
  return "";
}

std::string CheckWindow(const MapWindow& window) {
  if (!IsPlace(window.center_m)) return "it is nowhere";
  // Less than this in a world of 1e9 m and axis labels would no longer differ.
  const bool has_area = window.width_m >= 1e-3 && window.height_m >= 1e-3;
  if (!has_area || !IsPlace(window.width_m) || !IsPlace(window.height_m)) {
    return "a side that is not from 1 mm to 1e9 m";
  }
  return "";
}

Status CheckFigure(const MapFigure& figure, const MapFigureOptions& options) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("map figure options: " + error);
  if (figure.panels.empty()) return Status::InvalidArgument("map figure: there are no panels");
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    error = CheckPanel(figure.panels[i]);
    if (error.empty()) continue;
    return Status::InvalidArgument("map figure, panel " + std::to_string(i) + ": " + error);
  }
  if (figure.details.size() > kMaxDetails) {
    return Status::InvalidArgument("map figure: more than 26 details");
  }
  for (std::size_t i = 0; i < figure.details.size(); ++i) {
    error = CheckWindow(figure.details[i]);
    if (error.empty()) continue;
    return Status::InvalidArgument("map figure, detail " + std::to_string(i) + ": " + error);
  }
  return Status::Ok();
}

Status CommonExtent(const MapFigure& figure, double crop_share, MapExtent* extent) {
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const MapPanel& panel = figure.panels[i];
    MapExtent own;
    PLUMBLINE_RETURN_IF_ERROR(FindExtent(panel.points, panel.trajectory, crop_share, &own));
    if (i == 0) *extent = own;
    extent->x.low = std::min(extent->x.low, own.x.low);
    extent->x.high = std::max(extent->x.high, own.x.high);
    extent->y.low = std::min(extent->y.low, own.y.low);
    extent->y.high = std::max(extent->y.high, own.y.high);
  }
  return Status::Ok();
}

std::string Letter(std::size_t index, char first) {
  return std::string(1, static_cast<char>(first + index % kMaxDetails));
}

// Counts every hit in all pixels of the square around its own.
std::vector<std::uint32_t> SpreadHits(const std::vector<std::uint32_t>& hits,
                                      const MapRaster& raster, int side_px) {
  const int reach = side_px / 2;
  std::vector<std::uint32_t> spread(hits.size(), 0);
  const auto at = [&raster](int column, int row) {
    return static_cast<std::size_t>(row) * raster.width + column;
  };
  for (int row = 0; row < raster.height; ++row) {
    for (int column = 0; column < raster.width; ++column) {
      const std::uint32_t count = hits[at(column, row)];
      if (count == 0) continue;
      for (int r = std::max(0, row - reach); r <= std::min(raster.height - 1, row + reach); ++r) {
        for (int c = std::max(0, column - reach); c <= std::min(raster.width - 1, column + reach);
             ++c) {
          spread[at(c, r)] += count;
        }
      }
    }
  }
  return spread;
}

class FigurePainter {
 public:
  FigurePainter(const MapFigure& figure, const MapLayout& layout, int point_px, cairo_t* context)
      : figure_(figure), layout_(layout), point_px_(point_px), context_(context) {
    SelectFont(layout.font_px, context);
  }

  void Paint() {
    cairo_set_source_rgb(context_, 1.0, 1.0, 1.0);
    cairo_paint(context_);
    PaintViews(layout_.map);
    for (const MapView& detail : layout_.details) PaintViews(detail);
    for (std::size_t panel = 0; panel < figure_.panels.size(); ++panel) PaintTexts(panel);
  }

 private:
  double Left(const MapView& view, std::size_t panel) const {
    return layout_.PanelLeft(static_cast<int>(panel)) + view.left_px;
  }
  double Top(const MapView& view, std::size_t panel) const {
    return layout_.PanelTop(static_cast<int>(panel)) + view.top_px;
  }

  // One window of the world, in all panels.
  void PaintViews(const MapView& view) {
    std::vector<std::vector<std::uint32_t>> hits;
    std::vector<std::uint32_t> all_hits;
    for (const MapPanel& panel : figure_.panels) {
      hits.push_back(SpreadHits(CountHits(panel.points, view.raster), view.raster, point_px_));
      all_hits.insert(all_hits.end(), hits.back().begin(), hits.back().end());
    }
    const double black_level = BlackLevel(all_hits);
    for (std::size_t panel = 0; panel < figure_.panels.size(); ++panel) {
      cairo_save(context_);
      cairo_translate(context_, Left(view, panel), Top(view, panel));
      cairo_rectangle(context_, 0.0, 0.0, view.raster.width, view.raster.height);
      cairo_clip(context_);
      PaintTruth(figure_.panels[panel], view.raster);
      PaintDensity(DensityImage(hits[panel], black_level), view.raster);
      PaintTrajectory(figure_.panels[panel], view.raster);
      cairo_restore(context_);
    }
  }

  void PaintTruth(const MapPanel& panel, const MapRaster& raster) {
    SetColor(kGreen, 1.0, context_);
    cairo_set_line_width(context_, 0.05 * layout_.font_px);
    for (const auto& [from, to] : panel.truth_lines) {
      cairo_move_to(context_, raster.Column(from.x()), raster.Row(from.y()));
      cairo_line_to(context_, raster.Column(to.x()), raster.Row(to.y()));
    }
    cairo_stroke(context_);
  }

  // Black ink as thick as the gray value says, so that what lies below shines through.
  void PaintDensity(const std::vector<std::uint8_t>& gray, const MapRaster& raster) {
    const CairoSurface ink(
        cairo_image_surface_create(CAIRO_FORMAT_A8, raster.width, raster.height));
    unsigned char* data = cairo_image_surface_get_data(ink.get());
    if (data == nullptr) return;  // The context then has the error, and CommitPng reports it.
    const int stride = cairo_image_surface_get_stride(ink.get());
    cairo_surface_flush(ink.get());
    for (int row = 0; row < raster.height; ++row) {
      const std::uint8_t* from = gray.data() + static_cast<std::size_t>(row) * raster.width;
      std::transform(from, from + raster.width, data + static_cast<std::size_t>(row) * stride,
                     [](std::uint8_t level) { return static_cast<unsigned char>(255 - level); });
    }
    cairo_surface_mark_dirty(ink.get());
    SetColor(kBlack, 1.0, context_);
    cairo_mask_surface(context_, ink.get(), 0.0, 0.0);
  }

  void PaintTrajectory(const MapPanel& panel, const MapRaster& raster) {
    SetColor(kBlue, 0.7, context_);
    cairo_set_line_width(context_, 0.06 * layout_.font_px);
    cairo_set_line_join(context_, CAIRO_LINE_JOIN_ROUND);
    for (const Pose2& pose : panel.trajectory) {
      cairo_line_to(context_, raster.Column(pose.x), raster.Row(pose.y));
    }
    cairo_stroke(context_);
  }

  // What lies on top of a panel's images and around them.
  void PaintTexts(std::size_t panel) {
    for (std::size_t i = 0; i < layout_.details.size(); ++i) PaintDetailFrame(i, panel);
    std::string title = figure_.panels[panel].title;
    if (figure_.panels.size() > 1) title = "(" + Letter(panel, 'a') + ") " + title;
    PaintAround(title, layout_.map, panel);
    for (std::size_t i = 0; i < layout_.details.size(); ++i) {
      PaintAround(Letter(i, 'A'), layout_.details[i], panel);
    }
  }

  void PaintDetailFrame(std::size_t detail, std::size_t panel) {
    const MapRaster& inner = layout_.details[detail].raster;
    const MapRaster& outer = layout_.map.raster;
    const double scale = inner.pixel_m / outer.pixel_m;
    const double left = Left(layout_.map, panel) + outer.Column(inner.left_m);
    const double top = Top(layout_.map, panel) + outer.Row(inner.top_m);
    const double font = layout_.font_px;
    SetColor(kVermilion, 1.0, context_);
    cairo_set_line_width(context_, 0.1 * font);
    cairo_rectangle(context_, left, top, inner.width * scale, inner.height * scale);
    cairo_stroke(context_);
    PaintLetter(Letter(detail, 'A'), left, top - 0.25 * font, panel);
  }

  // With a white rim, to be read on a wall, and inside the map.
  void PaintLetter(const std::string& letter, double left, double bottom, std::size_t panel) {
    const double font = layout_.font_px;
    const double x = std::clamp(left, Left(layout_.map, panel) + 0.3 * font,
                                Left(layout_.map, panel) + layout_.map.raster.width - font);
    const double y = std::max(bottom, Top(layout_.map, panel) + font);
    cairo_move_to(context_, x, y);
    cairo_text_path(context_, letter.c_str());
    SetColor({1.0, 1.0, 1.0}, 1.0, context_);
    cairo_set_line_width(context_, 0.3 * font);
    cairo_set_line_join(context_, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke_preserve(context_);
    SetColor(kVermilion, 1.0, context_);
    cairo_fill(context_);
  }

  // Axes, and above them title and scale bar.
  void PaintAround(const std::string& title, const MapView& view, std::size_t panel) {
    const double font = layout_.font_px, left = Left(view, panel), top = Top(view, panel);
    DrawAxes(view.Frame(layout_.PanelLeft(static_cast<int>(panel)),
                        layout_.PanelTop(static_cast<int>(panel)), font),
             context_);
    const double bar_m = RoundDownToNice(0.2 * view.raster.width * view.raster.pixel_m);
    const ScaleBar bar{bar_m, bar_m / view.raster.pixel_m, font};
    const double bar_left = left + view.raster.width - bar.WidthPx(context_);
    DrawScaleBar(bar, bar_left, top - 0.8 * font, context_);
    DrawFittingText(title, left, top - 0.45 * font, bar_left - left - font, font, context_);
  }

  const MapFigure& figure_;
  const MapLayout& layout_;
  const int point_px_;
  cairo_t* context_;
};

}  // namespace

bool MapFigureOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(width_px, >=, 400);
  PLUMBLINE_CHECK_OPTION(width_px, <=, 20000);
  PLUMBLINE_CHECK_OPTION(max_map_height_px, >=, 100);
  PLUMBLINE_CHECK_OPTION(max_map_height_px, <=, 20000);
  PLUMBLINE_CHECK_OPTION(crop_share, >=, 0.0);
  PLUMBLINE_CHECK_OPTION(crop_share, <, 0.5);
  PLUMBLINE_CHECK_OPTION(point_px, >=, 1);
  PLUMBLINE_CHECK_OPTION(point_px, <=, 99);
  PLUMBLINE_CHECK_OPTION(point_px % 2, ==, 1);
  return true;
}

Status WriteMapFigure(const std::string& path, const MapFigure& figure,
                      const MapFigureOptions& options) {
  PLUMBLINE_RETURN_IF_ERROR(CheckFigure(figure, options));
  MapExtent extent;
  PLUMBLINE_RETURN_IF_ERROR(CommonExtent(figure, options.crop_share, &extent));
  const MapLayout layout = LayOutMaps(figure, extent, options);
  if (layout.height_px > kMaxImageSidePx) {
    return Status::InvalidArgument("map figure: it would be " + std::to_string(layout.height_px) +
                                   " px high");
  }
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  const CairoSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, options.width_px, layout.height_px));
  const CairoContext context(cairo_create(surface.get()));
  FigurePainter(figure, layout, options.point_px, context.get()).Paint();
  return CommitPng(path, surface.get(), context.get(), &file);
}

}  // namespace plumbline
