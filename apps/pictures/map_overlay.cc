#include "plumbline/apps/pictures/map_overlay.h"

#include <cairo.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "plumbline/core/angle.h"
#include "plumbline/core/map_points.h"
#include "plumbline/core/share_graph.h"

namespace plumbline {
namespace {

constexpr double kLinePx = 1.6;
constexpr double kDotRadiusPx = 3.0;
constexpr double kRingPx = 2.0;
constexpr double kRingRadiusPx = 9.0;
constexpr double kSamplePx = 16.0;  // side of a square that stands for points
constexpr double kDashPx[] = {7.0, 5.0};

void DrawLinks(const std::vector<Eigen::Vector2d>& ends, cairo_t* context) {
  cairo_set_line_width(context, kLinePx);
  for (std::size_t i = 0; i + 1 < ends.size(); i += 2) {
    cairo_move_to(context, ends[i].x(), ends[i].y());
    cairo_line_to(context, ends[i + 1].x(), ends[i + 1].y());
  }
  cairo_stroke(context);
}

void DrawDots(const std::vector<Eigen::Vector2d>& centers, cairo_t* context) {
  for (const Eigen::Vector2d& center : centers) {
    cairo_arc(context, center.x(), center.y(), kDotRadiusPx, 0.0, 2.0 * kPi);
    cairo_fill(context);
  }
}

void DrawRings(const std::vector<Eigen::Vector2d>& centers, cairo_t* context) {
  cairo_set_line_width(context, kRingPx);
  for (const Eigen::Vector2d& center : centers) {
    cairo_new_sub_path(context);
    cairo_arc(context, center.x(), center.y(), kRingRadiusPx, 0.0, 2.0 * kPi);
  }
  cairo_stroke(context);
}

void FillSquare(double x, double y, double side, cairo_t* context) {
  cairo_rectangle(context, x, y, side, side);
  cairo_fill(context);
}

void SetColor(const MapOverlay& overlay, cairo_t* context) {
  cairo_set_source_rgb(context, overlay.color.red, overlay.color.green, overlay.color.blue);
}

void FillPixels(const std::vector<bool>& pixels, const MapRaster& raster, cairo_t* context) {
  auto pixel = pixels.begin();
  for (int row = 0; row < raster.height; ++row) {
    for (int column = 0; column < raster.width; ++column) {
      if (*pixel++) FillSquare(column, row, 1.0, context);
    }
  }
}

// points: in pixels.
void DrawMarks(const MapOverlay& overlay, const std::vector<Eigen::Vector2d>& points,
               cairo_t* context) {
  SetColor(overlay, context);
  switch (overlay.style) {
    case OverlayStyle::kLinks:
      DrawLinks(points, context);
      DrawDots(points, context);
      break;
    case OverlayStyle::kDashedLinks:
      cairo_set_dash(context, kDashPx, 2, 0.0);
      DrawLinks(points, context);
      cairo_set_dash(context, nullptr, 0, 0.0);
      break;
    case OverlayStyle::kRings:
      DrawRings(points, context);
      break;
    case OverlayStyle::kPoints:
    case OverlayStyle::kScans:  // a sample of them
      FillSquare(points.front().x() - 0.5 * kSamplePx, points.front().y() - 0.5 * kSamplePx,
                 kSamplePx, context);
      break;
  }
}

}  // namespace

std::vector<bool> PixelsOf(const MapOverlay& overlay, const SlamGraph& graph, const MapState& state,
                           const MapRaster& raster, int drawn_by) {
  const std::size_t num_pixels = static_cast<std::size_t>(raster.width) * raster.height;
  if (overlay.style == OverlayStyle::kPoints) {
    std::vector<bool> pixels(num_pixels, false);
    for (const Eigen::Vector2d& point : overlay.points) {
      const std::ptrdiff_t pixel = raster.PixelAt(point.x(), point.y());
      if (pixel >= 0) pixels[pixel] = true;
    }
    return pixels;
  }
  if (overlay.style != OverlayStyle::kScans) return {};
  std::vector<std::uint32_t> hits(num_pixels, 0);
  const MapPoints points(graph, state);
  const int end = FirstOwnScanFrom(graph, overlay.first_scan + overlay.num_scans);
  for (int scan = FirstOwnScanFrom(graph, overlay.first_scan); scan < end; ++scan) {
    const ScanEntry& entry = graph.scan(scan);
    for (std::size_t r = entry.first_return; r < entry.first_return + entry.num_returns; ++r) {
      const Eigen::Vector2d point = points.At(r);
      const std::ptrdiff_t pixel = raster.PixelAt(point.x(), point.y());
      if (pixel >= 0) hits[pixel] = 1;
    }
  }
  GatherHits(graph.peers(), drawn_by, &hits);
  std::vector<bool> pixels(hits.size());
  std::transform(hits.begin(), hits.end(), pixels.begin(), [](auto count) { return count != 0; });
  return pixels;
}

void DrawOverlay(const MapOverlay& overlay, const MapRaster& raster,
                 const std::vector<bool>& pixels, cairo_t* context) {
  if (!pixels.empty()) {
    SetColor(overlay, context);
    FillPixels(pixels, raster, context);
    return;
  }
  std::vector<Eigen::Vector2d> points;
  for (const Eigen::Vector2d& point : overlay.points) {
    points.emplace_back(raster.Column(point.x()), raster.Row(point.y()));
  }
  DrawMarks(overlay, points, context);
}

void DrawOverlaySample(const MapOverlay& overlay, double x, double y, cairo_t* context) {
  switch (overlay.style) {
    case OverlayStyle::kRings:
    case OverlayStyle::kPoints:
    case OverlayStyle::kScans:
      DrawMarks(overlay, {{x, y}}, context);
      break;
    case OverlayStyle::kLinks:
    case OverlayStyle::kDashedLinks:
      DrawMarks(overlay, {{x - 18.0, y}, {x + 18.0, y}}, context);
      break;
  }
}

}  // namespace plumbline
