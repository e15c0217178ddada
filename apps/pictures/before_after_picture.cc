#include "plumbline/apps/pictures/before_after_picture.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/map_raster.h"
#include "plumbline/apps/pictures/cairo_canvas.h"
#include "plumbline/apps/pictures/picture_layout.h"
#include "plumbline/apps/pictures/scale_bar.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr double kPixelM = 0.02;
constexpr double kCropShare = 1e-3;
constexpr int kMinPanelPx = 300;  // room for a title and the scale bar

Status CheckInput(const MapState& state, const std::vector<double>& poses_before,
                  const BeforeAfterOptions& options) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("before and after: " + error);
  if (state.poses.empty()) {
    return Status::InvalidArgument("before and after: the graph has no poses");
  }
  if (poses_before.size() != state.poses.size()) {
    return Status::InvalidArgument("before and after: " + std::to_string(poses_before.size() / 3) +
                                   " poses before, " + std::to_string(state.num_poses()) +
                                   " after");
  }
  for (std::size_t i = 0; i < poses_before.size(); ++i) {
    if (std::isfinite(poses_before[i]) && std::isfinite(state.poses[i])) continue;
    return Status::InvalidArgument("before and after: pose " + std::to_string(i / 3) +
                                   " is not finite");
  }
  return Status::Ok();
}

// Where the two maps are on the canvas [px].
struct Layout {
  explicit Layout(const MapRaster& raster) {
    const int panel_width = std::max(raster.width, kMinPanelPx);
    const bool side_by_side = raster.height > panel_width;
    step_x = side_by_side ? panel_width + kBorderPx : 0;
    step_y = side_by_side ? 0 : raster.height + kTitlePx;
    width = step_x + panel_width + 2 * kBorderPx;
    height = step_y + kTitlePx + raster.height + kFooterPx;
  }
  int Left(int panel) const { return kBorderPx + panel * step_x; }
  int Top(int panel) const { return kTitlePx + panel * step_y; }

  int step_x, step_y;  // from the first map to the second
  int width, height;   // of the canvas
};

// The canvas holds one byte per pixel, its whiteness, which takes a third of the time that colours
// take. Cairo calls it opacity: what is drawn in black takes opacity away.
constexpr cairo_format_t kGrayFormat = CAIRO_FORMAT_A8;
constexpr cairo_operator_t kDrawBlack = CAIRO_OPERATOR_DEST_OUT;

void DrawFrame(const MapRaster& raster, int left, int top, cairo_t* context) {
  cairo_set_source_rgba(context, 0.0, 0.0, 0.0, 0.25);
  cairo_set_line_width(context, 1.0);
  cairo_rectangle(context, left - 0.5, top - 0.5, raster.width + 1.0, raster.height + 1.0);
  cairo_stroke(context);
}

}  // namespace

bool BeforeAfterOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(max_side_px, >=, 100);
  PLUMBLINE_CHECK_OPTION(max_side_px, <=, kLargestSidePx);
  return true;
}

Status BeforeAfterPicture::Gather(const SlamGraph& graph, const MapState& state,
                                  const std::vector<double>& poses_before,
                                  const BeforeAfterOptions& options, int drawn_by) {
  PLUMBLINE_RETURN_IF_ERROR(CheckInput(state, poses_before, options));
  PLUMBLINE_RETURN_IF_ERROR(
      ChooseRaster(graph, state, kCropShare, options.max_side_px, &raster_, kPixelM));
  panels_ = {
      Panel{options.before_title, CountHitsAtRest(graph, MapPoints(graph, poses_before), raster_)},
      Panel{options.after_title, CountHitsAtRest(graph, MapPoints(graph, state), raster_)}};
  for (Panel& panel : panels_) GatherHits(graph.peers(), drawn_by, &panel.hits);
  return Status::Ok();
}

Status BeforeAfterPicture::Draw(const std::string& path) const {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  const Layout layout(raster_);
  const CairoSurface surface(cairo_image_surface_create(kGrayFormat, layout.width, layout.height));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) {
    return Status::Unavailable("no memory for the picture '" + path + "'");
  }
  DrawPanels(surface.get());
  const CairoContext context(cairo_create(surface.get()));
  DrawCaptions(context.get());
  return CommitPng(path, surface.get(), context.get(), &file);
}

void BeforeAfterPicture::DrawPanels(cairo_surface_t* surface) const {
  const Layout layout(raster_);
  std::vector<std::uint32_t> both = panels_[0].hits;
  both.insert(both.end(), panels_[1].hits.begin(), panels_[1].hits.end());
  const double black_level = BlackLevel(both);
  cairo_surface_flush(surface);
  unsigned char* canvas = cairo_image_surface_get_data(surface);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
  std::fill(canvas, canvas + stride * layout.height, 255);
  for (int i = 0; i < 2; ++i) {
    const std::vector<std::uint8_t> gray = DensityImage(panels_[i].hits, black_level);
    for (int row = 0; row < raster_.height; ++row) {
      const auto first = gray.begin() + static_cast<std::size_t>(row) * raster_.width;
      std::copy(first, first + raster_.width,
                canvas + stride * (layout.Top(i) + row) + layout.Left(i));
    }
  }
  cairo_surface_mark_dirty(surface);
}

void BeforeAfterPicture::DrawCaptions(cairo_t* context) const {
  const Layout layout(raster_);
  cairo_set_operator(context, kDrawBlack);
  SelectFont(kFontPx, context);
  for (int i = 0; i < 2; ++i) {
    DrawFrame(raster_, layout.Left(i), layout.Top(i), context);
    cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
    DrawText(panels_[i].title, layout.Left(i), layout.Top(i) - 0.35 * kTitlePx, TextAnchor::kLeft,
             context);
  }
  const double y = layout.height - 0.5 * kFooterPx;
  const double bar_m = RoundDownToNice(std::max(raster_.width / 6.0, 50.0) * raster_.pixel_m);
  const ScaleBar bar{bar_m, bar_m / raster_.pixel_m, kFontPx};
  DrawScaleBar(bar, kBorderPx, y, context);
  char resolution[64];
  std::snprintf(resolution, sizeof(resolution), "%g cm per pixel", 100.0 * raster_.pixel_m);
  DrawText(resolution, kBorderPx + bar.WidthPx(context) + 30.0, y + 0.35 * kFontPx,
           TextAnchor::kLeft, context);
}

}  // namespace plumbline
