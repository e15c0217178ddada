#include "plumbline/apps/benchmark/convergence_plot.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/cairo_canvas.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr int kWidthPx = 1200, kPlotHeightPx = 620;
constexpr int kLeftPx = 110, kRightPx = 30, kTopPx = 50, kBottomPx = 80, kLegendRowPx = 30;
constexpr double kFontPx = 18.0, kMarkerPx = 6.0, kMarkerSpacingPx = 16.0;

// Told apart with any kind of colour vision (Okabe and Ito: Color universal design, 2002).
struct Color {
  double red, green, blue;
};
constexpr Color kColors[] = {{0.00, 0.45, 0.70}, {0.84, 0.37, 0.00}, {0.00, 0.62, 0.45},
                             {0.80, 0.47, 0.65}, {0.90, 0.62, 0.00}, {0.34, 0.71, 0.91},
                             {0.00, 0.00, 0.00}, {0.50, 0.50, 0.50}};
constexpr int kNumMarkers = 4;

bool HasPlace(const Eigen::Vector2d& point) {
  return point.allFinite() && point.x() > 0.0 && point.y() > 0.0;
}

// Whole decades of one coordinate, drawn from one pixel to another.
struct LogAxis {
  int first = 0, last = 0;  // powers of ten
  double first_px = 0.0, last_px = 0.0;

  double At(double value) const {
    return first_px + (std::log10(value) - first) / (last - first) * (last_px - first_px);
  }
};

// The decades that hold the coordinate (0 = x, 1 = y) of all points; at least one.
LogAxis AxisOf(const ConvergencePlot& plot, int coordinate, double first_px, double last_px) {
  double low = INFINITY, high = -INFINITY;
  for (const ConvergenceLine& line : plot.lines) {
    for (const Eigen::Vector2d& point : line.points) {
      if (!HasPlace(point)) continue;
      low = std::min(low, std::log10(point[coordinate]));
      high = std::max(high, std::log10(point[coordinate]));
    }
  }
  const int first = static_cast<int>(std::floor(low));
  return {first, std::max(first + 1, static_cast<int>(std::ceil(high))), first_px, last_px};
}

void SetColor(const Color& color, cairo_t* context) {
  cairo_set_source_rgb(context, color.red, color.green, color.blue);
}

enum class Anchor { kLeft, kCenter, kRight };

// (x, y) is the left, middle or right end of the text's base line.
void DrawText(const std::string& text, double x, double y, Anchor anchor, cairo_t* context) {
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  const double share = anchor == Anchor::kLeft ? 0.0 : anchor == Anchor::kCenter ? 0.5 : 1.0;
  cairo_move_to(context, x - share * extents.x_advance, y);
  cairo_show_text(context, text.c_str());
  cairo_new_path(context);  // Text leaves its end behind as the current point.
}

std::string PowerOfTen(int exponent) {
  if (std::abs(exponent) > 3) return "1e" + std::to_string(exponent);
  char text[32];
  std::snprintf(text, sizeof(text), "%g", std::pow(10.0, exponent));
  return text;
}

class Painter {
 public:
  Painter(const ConvergencePlot& plot, cairo_t* context)
      : plot_(plot),
        context_(context),
        x_(AxisOf(plot, 0, kLeftPx, kWidthPx - kRightPx)),
        y_(AxisOf(plot, 1, kTopPx + kPlotHeightPx, kTopPx)) {}

  void Paint() {
    cairo_set_source_rgb(context_, 1.0, 1.0, 1.0);
    cairo_paint(context_);
    cairo_select_font_face(context_, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context_, kFontPx);
    PaintGrid(x_);
    PaintGrid(y_);
    PaintLabels();
    for (std::size_t i = 0; i < plot_.lines.size(); ++i) {
      PaintLine(i);
      PaintLegend(i);
    }
  }

 private:
  void StrokeAt(const LogAxis& axis, double value) {
    const double at = std::round(axis.At(value)) + 0.5;
    if (&axis == &x_) {
      cairo_move_to(context_, at, y_.first_px);
      cairo_line_to(context_, at, y_.last_px);
    } else {
      cairo_move_to(context_, x_.first_px, at);
      cairo_line_to(context_, x_.last_px, at);
    }
    cairo_stroke(context_);
  }

  // Decades and, fainter, what lies between them.
  void PaintGrid(const LogAxis& axis) {
    cairo_set_line_width(context_, 1.0);
    for (int decade = axis.first; decade < axis.last; ++decade) {
      cairo_set_source_rgb(context_, 0.93, 0.93, 0.93);
      for (int i = 2; i < 10; ++i) StrokeAt(axis, i * std::pow(10.0, decade));
    }
    cairo_set_source_rgb(context_, 0.75, 0.75, 0.75);
    for (int decade = axis.first; decade <= axis.last; ++decade) {
      StrokeAt(axis, std::pow(10.0, decade));
    }
  }

  void PaintLabels() {
    cairo_set_source_rgb(context_, 0.0, 0.0, 0.0);
    for (int decade = x_.first; decade <= x_.last; ++decade) {
      DrawText(PowerOfTen(decade), x_.At(std::pow(10.0, decade)), y_.first_px + 26.0,
               Anchor::kCenter, context_);
    }
    for (int decade = y_.first; decade <= y_.last; ++decade) {
      DrawText(PowerOfTen(decade), x_.first_px - 10.0,
               y_.At(std::pow(10.0, decade)) + 0.35 * kFontPx, Anchor::kRight, context_);
    }
    DrawText(plot_.title, x_.first_px, 0.65 * kTopPx, Anchor::kLeft, context_);
    DrawText(plot_.x_label, 0.5 * (x_.first_px + x_.last_px), y_.first_px + 56.0, Anchor::kCenter,
             context_);
    cairo_save(context_);
    cairo_translate(context_, 28.0, 0.5 * (y_.first_px + y_.last_px));
    cairo_rotate(context_, -0.5 * kPi);
    DrawText(plot_.y_label, 0.0, 0.0, Anchor::kCenter, context_);
    cairo_restore(context_);
  }

  void PaintLine(std::size_t index) {
    SetColor(kColors[index % std::size(kColors)], context_);
    cairo_set_line_width(context_, 2.0);
    cairo_set_line_join(context_, CAIRO_LINE_JOIN_ROUND);
    std::vector<Eigen::Vector2d> pixels;
    for (const Eigen::Vector2d& point : plot_.lines[index].points) {
      if (HasPlace(point)) pixels.emplace_back(x_.At(point.x()), y_.At(point.y()));
    }
    for (const Eigen::Vector2d& pixel : pixels) cairo_line_to(context_, pixel.x(), pixel.y());
    cairo_stroke(context_);
    const Eigen::Vector2d* marked = nullptr;
    for (const Eigen::Vector2d& pixel : pixels) {
      if (marked != nullptr && (pixel - *marked).norm() < kMarkerSpacingPx) continue;
      PaintMarker(index, pixel);
      marked = &pixel;
    }
  }

  // Disc, square, diamond or triangle.
  void PaintMarker(std::size_t index, const Eigen::Vector2d& center) {
    const int kind = static_cast<int>(index % kNumMarkers);
    if (kind == 0) {
      cairo_arc(context_, center.x(), center.y(), kMarkerPx, 0.0, 2.0 * kPi);
    } else {
      const int corners = kind == 3 ? 3 : 4;
      const double first_rad = kind == 1 ? 0.25 * kPi : -0.5 * kPi;
      for (int i = 0; i < corners; ++i) {
        const double angle = first_rad + 2.0 * kPi * i / corners;
        cairo_line_to(context_, center.x() + 1.2 * kMarkerPx * std::cos(angle),
                      center.y() + 1.2 * kMarkerPx * std::sin(angle));
      }
      cairo_close_path(context_);
    }
    cairo_fill(context_);
  }

  // Two columns.
  void PaintLegend(std::size_t index) {
    constexpr double kSamplePx = 48.0;
    const double x = x_.first_px + 0.5 * (index % 2) * (x_.last_px - x_.first_px);
    const double y = kTopPx + kPlotHeightPx + kBottomPx + (index / 2 + 0.5) * kLegendRowPx;
    SetColor(kColors[index % std::size(kColors)], context_);
    cairo_move_to(context_, x, y);
    cairo_line_to(context_, x + kSamplePx, y);
    cairo_stroke(context_);
    PaintMarker(index, {x + 0.5 * kSamplePx, y});
    cairo_set_source_rgb(context_, 0.0, 0.0, 0.0);
    DrawText(plot_.lines[index].label, x + kSamplePx + 12.0, y + 0.35 * kFontPx, Anchor::kLeft,
             context_);
  }

  const ConvergencePlot& plot_;
  cairo_t* context_;
  const LogAxis x_, y_;
};

}  // namespace

Status WriteConvergencePlot(const std::string& path, const ConvergencePlot& plot) {
  const bool empty =
      std::none_of(plot.lines.begin(), plot.lines.end(), [](const ConvergenceLine& line) {
        return std::any_of(line.points.begin(), line.points.end(), HasPlace);
      });
  if (empty) return Status::InvalidArgument("plot '" + path + "': there is no point to draw");
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  const int num_rows = static_cast<int>((plot.lines.size() + 1) / 2);
  const int height = kTopPx + kPlotHeightPx + kBottomPx + num_rows * kLegendRowPx + 10;
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, kWidthPx, height));
  const CairoContext context(cairo_create(surface.get()));
  Painter(plot, context.get()).Paint();
  return CommitPng(path, surface.get(), context.get(), &file);
}

}  // namespace plumbline
