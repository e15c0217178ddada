#include "plumbline/apps/pictures/map_picture.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/map_raster.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/pictures/cairo_canvas.h"
#include "plumbline/apps/pictures/picture_layout.h"
#include "plumbline/apps/pictures/scale_bar.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

constexpr int kMinWidthPx = 640;  // room for title and scale bar
constexpr int kLegendRowPx = 30;
constexpr double kFadedStrength = 0.75;  // of a map that is the background of overlays

/// Fills the canvas white and puts the density image with its upper left corner at (left, top), its
/// darkness multiplied by `strength`.
void DrawDensity(const std::vector<std::uint8_t>& gray, double strength, const MapRaster& raster,
                 int left, int top, cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  std::fill(data, data + static_cast<std::size_t>(stride) * cairo_image_surface_get_height(surface),
            255);
  for (int row = 0; row < raster.height; ++row) {
    auto* pixels =
        reinterpret_cast<std::uint32_t*>(data + static_cast<std::size_t>(stride) * (top + row)) +
        left;
    for (int column = 0; column < raster.width; ++column) {
      const int darkness = 255 - gray[static_cast<std::size_t>(row) * raster.width + column];
      pixels[column] = 0x010101u * (255u - static_cast<std::uint32_t>(strength * darkness));
    }
  }
  cairo_surface_mark_dirty(surface);
}

/// Whether the robot drove from the pose before to this one. Without any odometry it is taken to
/// have done so.
std::vector<bool> FollowsPoseBefore(const SlamGraph& graph, int num_poses) {
  std::vector<bool> follows(num_poses, graph.odometry().empty());
  for (const OdometryConstraint& step : graph.odometry()) {
    if (step.to == step.from + 1 && step.to < num_poses) follows[step.to] = true;
  }
  return follows;
}

/// The path in the current colour, its start as a green dot.
void DrawTrajectory(const SlamGraph& graph, const MapState& state, const MapRaster& raster,
                    cairo_t* context) {
  cairo_set_line_width(context, 1.5);
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  const std::vector<bool> follows = FollowsPoseBefore(graph, state.num_poses());
  for (int pose = 0; pose < state.num_poses(); ++pose) {
    const Pose2 robot = state.WorldFromRobot(pose);
    if (!follows[pose]) cairo_new_sub_path(context);
    cairo_line_to(context, raster.Column(robot.x), raster.Row(robot.y));
  }
  cairo_stroke(context);
  const Pose2 start = state.WorldFromRobot(0);
  cairo_arc(context, raster.Column(start.x), raster.Row(start.y), 6.0, 0.0, 2.0 * kPi);
  cairo_set_source_rgb(context, 0.1, 0.6, 0.2);
  cairo_fill(context);
}

void DrawTitle(const SlamGraph& graph, const std::string& title, cairo_t* context) {
  const std::string numbers = WithThousands(graph.all_scans().size()) + " scans, " +
                              WithThousands(graph.num_returns_of_all()) + " returns";
  cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
  DrawText(title.empty() ? numbers : title + ": " + numbers, kBorderPx, 0.65 * kTitlePx,
           TextAnchor::kLeft, context);
}

/// The lines and marks on the map area, which cuts them off. overlay_pixels: PixelsOf each.
void DrawMap(const SlamGraph& graph, const MapState& state, const std::vector<MapOverlay>& overlays,
             const std::vector<std::vector<bool>>& overlay_pixels, const MapRaster& raster,
             int left, cairo_t* context) {
  cairo_translate(context, left, kTitlePx);
  cairo_rectangle(context, 0.0, 0.0, raster.width, raster.height);
  cairo_clip(context);
  if (overlays.empty()) {
    cairo_set_source_rgb(context, 0.85, 0.15, 0.1);
  } else {
    cairo_set_source_rgb(context, 0.72, 0.72, 0.72);
  }
  DrawTrajectory(graph, state, raster, context);
  for (std::size_t i = 0; i < overlays.size(); ++i) {
    DrawOverlay(overlays[i], raster, overlay_pixels[i], context);
  }
}

bool HasLegend(const MapOverlay& overlay) { return !overlay.label.empty(); }

/// One row per overlay that has a label, the first one at the top.
void DrawLegend(const std::vector<MapOverlay>& overlays, double left, double top,
                cairo_t* context) {
  constexpr double kSampleWidthPx = 40.0;
  double y = top + 0.5 * kLegendRowPx;
  for (const MapOverlay& overlay : overlays) {
    if (!HasLegend(overlay)) continue;
    DrawOverlaySample(overlay, left + 0.5 * kSampleWidthPx, y, context);
    cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
    DrawText(overlay.label, left + kSampleWidthPx + 12.0, y + 0.35 * kFontPx, TextAnchor::kLeft,
             context);
    y += kLegendRowPx;
  }
}

Status CheckInput(const MapState& state, const MapPictureOptions& options) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("map picture options: " + error);
  if (state.poses.empty()) return Status::InvalidArgument("map picture: the graph has no poses");
  for (int pose = 0; pose < state.num_poses(); ++pose) {
    if (IsFinite(state.WorldFromRobot(pose))) continue;
    return Status::InvalidArgument("map picture: pose " + std::to_string(pose) + " is not finite");
  }
  return Status::Ok();
}

}  // namespace

bool MapPictureOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(max_side_px, >=, 100);
  PLUMBLINE_CHECK_OPTION(max_side_px, <=, 30000);  // Cairo's images end at 32767 pixels.
  PLUMBLINE_CHECK_OPTION(crop_share, >=, 0.0);
  PLUMBLINE_CHECK_OPTION(crop_share, <, 0.5);
  return true;
}

Status WriteMapPicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                       const MapPictureOptions& options, MapArea* area) {
  PLUMBLINE_RETURN_IF_ERROR(CheckInput(state, options));
  MapRaster raster;
  PLUMBLINE_RETURN_IF_ERROR(
      ChooseRaster(graph, state, options.crop_share, options.max_side_px, &raster));
  std::vector<std::uint32_t> hits = CountHits(MapPoints(graph, state), raster);
  SumOverPeers(graph.peers(), &hits);
  std::vector<std::vector<bool>> overlay_pixels;
  overlay_pixels.reserve(options.overlays.size());
  for (const MapOverlay& overlay : options.overlays) {
    overlay_pixels.push_back(PixelsOf(overlay, graph, state, raster));
  }
  if (!SpeaksForAll(graph.peers())) return Status::Ok();
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));

  const bool has_overlays = !options.overlays.empty();
  const int width = std::max(raster.width + 2 * kBorderPx, kMinWidthPx);
  const int num_rows =
      static_cast<int>(std::count_if(options.overlays.begin(), options.overlays.end(), HasLegend));
  const int legend_height = kLegendRowPx * num_rows;
  const int height = kTitlePx + raster.height + kFooterPx + legend_height;
  const int map_left = (width - raster.width) / 2;
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) {
    return Status::Unavailable("no memory for the picture '" + path + "'");
  }
  DrawDensity(DensityImage(hits, BlackLevel(hits)), has_overlays ? kFadedStrength : 1.0, raster,
              map_left, kTitlePx, surface.get());

  const CairoContext context(cairo_create(surface.get()));
  SelectFont(kFontPx, context.get());
  DrawTitle(graph, options.title, context.get());
  const int footer_top = kTitlePx + raster.height;
  const double bar_m = RoundDownToNice(std::max(raster.width / 6.0, 50.0) * raster.pixel_m);
  DrawScaleBar({bar_m, bar_m / raster.pixel_m, kFontPx}, kBorderPx, footer_top + 0.5 * kFooterPx,
               context.get());
  DrawLegend(options.overlays, kBorderPx, footer_top + kFooterPx, context.get());
  DrawMap(graph, state, options.overlays, overlay_pixels, raster, map_left, context.get());

  PLUMBLINE_RETURN_IF_ERROR(CommitPng(path, surface.get(), context.get(), &file));
  if (area != nullptr) *area = {raster, map_left, kTitlePx};
  return Status::Ok();
}

}  // namespace plumbline
