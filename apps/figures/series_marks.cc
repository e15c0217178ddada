#include "plumbline/apps/figures/series_marks.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "plumbline/apps/figures/plot_axes.h"
#include "plumbline/apps/pictures/cairo_canvas.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// In font sizes.
constexpr double kLineWidth = 0.12, kMarkerRadius = 0.32, kMarkerSpacing = 0.9;
constexpr double kSampleLength = 3.2, kRowHeight = 1.5, kColumnGap = 1.2, kLabelGap = 0.5;

void FillPolygon(const Eigen::Vector2d& center, double radius_px, int corners, double first_rad,
                 cairo_t* context) {
  for (int i = 0; i < corners; ++i) {
    const double angle = first_rad + 2.0 * kPi * i / corners;
    cairo_line_to(context, center.x() + radius_px * std::cos(angle),
                  center.y() + radius_px * std::sin(angle));
  }
  cairo_close_path(context);
  cairo_fill(context);
}

void DrawMarker(Marker marker, const Eigen::Vector2d& center, double font_px, cairo_t* context) {
  const double radius = kMarkerRadius * font_px;
  switch (marker) {
    case Marker::kDisc:
      cairo_arc(context, center.x(), center.y(), radius, 0.0, 2.0 * kPi);
      cairo_fill(context);
      break;
    // Corners stand out further, for an equal area.
    case Marker::kSquare:
      FillPolygon(center, 1.25 * radius, 4, 0.25 * kPi, context);
      break;
    case Marker::kDiamond:
      FillPolygon(center, 1.25 * radius, 4, 0.0, context);
      break;
    case Marker::kTriangle:
      FillPolygon(center, 1.4 * radius, 3, -0.5 * kPi, context);
      break;
    case Marker::kTriangleDown:
      FillPolygon(center, 1.4 * radius, 3, 0.5 * kPi, context);
      break;
  }
}

void StrokeSeries(const std::vector<Eigen::Vector2d>& pixels, const SeriesStyle& style,
                  double font_px, cairo_t* context) {
  SetColor(style.color, 1.0, context);
  const double line_px = kLineWidth * font_px;
  cairo_set_line_width(context, line_px);
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  std::array<double, 4> dash = style.dash.lengths;
  for (double& length : dash) length *= line_px;
  cairo_set_dash(context, dash.data(), style.dash.count, 0.0);
  for (const Eigen::Vector2d& pixel : pixels) cairo_line_to(context, pixel.x(), pixel.y());
  cairo_stroke(context);
  cairo_set_dash(context, nullptr, 0, 0.0);
}

}  // namespace

void SetColor(const Rgb& color, double opacity, cairo_t* context) {
  cairo_set_source_rgba(context, color.red, color.green, color.blue, opacity);
}

void DrawSeries(const std::vector<Eigen::Vector2d>& pixels, const SeriesStyle& style,
                double font_px, cairo_t* context) {
  StrokeSeries(pixels, style, font_px, context);
  const Eigen::Vector2d* marked = nullptr;
  for (const Eigen::Vector2d& pixel : pixels) {
    if (marked != nullptr && (pixel - *marked).norm() < kMarkerSpacing * font_px) continue;
    DrawMarker(style.marker, pixel, font_px, context);
    marked = &pixel;
  }
}

ChartLegend::ChartLegend(std::vector<std::string> labels, double width_px, double font_px,
                         cairo_t* context)
    : labels_(std::move(labels)), font_px_(font_px) {
  double label_px = 0.0;
  for (const std::string& label : labels_) {
    label_px = std::max(label_px, TextWidth(label, context));
  }
  const double entry_px = label_px + (kSampleLength + kLabelGap + kColumnGap) * font_px_;
  const std::size_t room = std::max(1, static_cast<int>(width_px / entry_px));
  num_rows_ = (labels_.size() + room - 1) / room;
  num_columns_ = num_rows_ == 0 ? 0 : (labels_.size() + num_rows_ - 1) / num_rows_;
  column_px_ = num_columns_ <= 1 ? width_px : std::min(entry_px, width_px / num_columns_);
}

double ChartLegend::height_px() const { return std::ceil(num_rows_ * kRowHeight * font_px_); }

void ChartLegend::Draw(double left, double top, cairo_t* context) const {
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    const std::size_t row = i / num_columns_, column = i % num_columns_;
    const double x = left + column * column_px_;
    const double y = top + (row + 0.5) * kRowHeight * font_px_;
    const double sample_px = kSampleLength * font_px_;
    const SeriesStyle style = StyleOfSeries(i);
    StrokeSeries({{x, y}, {x + sample_px, y}}, style, font_px_, context);
    DrawMarker(style.marker, {x + 0.5 * sample_px, y}, font_px_, context);
    SetColor(kBlack, 1.0, context);
    const double text_x = sample_px + kLabelGap * font_px_;
    DrawFittingText(labels_[i], x + text_x, y + 0.35 * font_px_, column_px_ - text_x, font_px_,
                    context);
  }
}

}  // namespace plumbline
