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

/// Fills the canvas white and puts the density image onto an area, its darkness multiplied by
/// `strength`.
void DrawDensity(const std::vector<std::uint8_t>& gray, double strength, const MapArea& area,
                 cairo_surface_t* surface) {
  const MapRaster& raster = area.raster;
  cairo_surface_flush(surface);
  unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  std::fill(data, data + static_cast<std::size_t>(stride) * cairo_image_surface_get_height(surface),
            255);
  for (int row = 0; row < raster.height; ++row) {
    auto* pixels = reinterpret_cast<std::uint32_t*>(data + static_cast<std::size_t>(stride) *
                                                               (area.top_px + row)) +
                   area.left_px;
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

Status MapPicture::Gather(const SlamGraph& graph, const MapState& state,
                          const MapPictureOptions& options, int drawn_by) {
  PLUMBLINE_RETURN_IF_ERROR(CheckInput(state, options));
  PLUMBLINE_RETURN_IF_ERROR(
      ChooseRaster(graph, state, options.crop_share, options.max_side_px, &raster_));
  graph_ = &graph;
  state_ = &state;
  options_ = options;
  hits_ = CountHitsAtRest(graph, MapPoints(graph, state), raster_);
  GatherHits(graph.peers(), drawn_by, &hits_);
  overlay_pixels_.clear();
  for (const MapOverlay& overlay : options.overlays) {
    overlay_pixels_.push_back(PixelsOf(overlay, graph, state, raster_, drawn_by));
  }
  return Status::Ok();
}

int MapPicture::LegendHeight() const {
  const std::vector<MapOverlay>& overlays = options_.overlays;
  return kLegendRowPx *
         static_cast<int>(std::count_if(overlays.begin(), overlays.end(), HasLegend));
}

int MapPicture::Width() const { return std::max(raster_.width + 2 * kBorderPx, kMinWidthPx); }

MapArea MapPicture::area() const { return {raster_, (Width() - raster_.width) / 2, kTitlePx}; }

Status MapPicture::Draw(const std::string& path) const {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  const int height = kTitlePx + raster_.height + kFooterPx + LegendHeight();
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, Width(), height));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) {
    return Status::Unavailable("no memory for the picture '" + path + "'");
  }
  DrawDensity(DensityImage(hits_, BlackLevel(hits_)),
              options_.overlays.empty() ? 1.0 : kFadedStrength, area(), surface.get());

  const CairoContext context(cairo_create(surface.get()));
  SelectFont(kFontPx, context.get());
  DrawTitle(*graph_, options_.title, context.get());
  const int footer_top = kTitlePx + raster_.height;
  const double bar_m = RoundDownToNice(std::max(raster_.width / 6.0, 50.0) * raster_.pixel_m);
  DrawScaleBar({bar_m, bar_m / raster_.pixel_m, kFontPx}, kBorderPx, footer_top + 0.5 * kFooterPx,
               context.get());
  DrawLegend(options_.overlays, kBorderPx, footer_top + kFooterPx, context.get());
  DrawMap(context.get());
  return CommitPng(path, surface.get(), context.get(), &file);
}

// The lines and marks on the map area, which cuts them off.
void MapPicture::DrawMap(cairo_t* context) const {
  const std::vector<MapOverlay>& overlays = options_.overlays;
  cairo_translate(context, area().left_px, area().top_px);
  cairo_rectangle(context, 0.0, 0.0, raster_.width, raster_.height);
  cairo_clip(context);
  if (overlays.empty()) {
    cairo_set_source_rgb(context, 0.85, 0.15, 0.1);
  } else {
    cairo_set_source_rgb(context, 0.72, 0.72, 0.72);
  }
  DrawTrajectory(*graph_, *state_, raster_, context);
  for (std::size_t i = 0; i < overlays.size(); ++i) {
    DrawOverlay(overlays[i], raster_, overlay_pixels_[i], context);
  }
}

Status WriteMapPicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                       const MapPictureOptions& options, MapArea* area) {
  MapPicture picture;
  PLUMBLINE_RETURN_IF_ERROR(picture.Gather(graph, state, options));
  if (SpeaksForAll(graph.peers())) PLUMBLINE_RETURN_IF_ERROR(picture.Draw(path));
  if (area != nullptr) *area = picture.area();
  return Status::Ok();
}

}  // namespace plumbline
