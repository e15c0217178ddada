#include "plumbline/apps/figures/line_chart.h"

#include <cairo.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plumbline/apps/figures/plot_axes.h"
#include "plumbline/apps/figures/series_marks.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/pictures/cairo_canvas.h"
#include "plumbline/apps/pictures/palette.h"

namespace plumbline {
namespace {

constexpr int kMinSidePx = 200, kMaxSidePx = 10000;
constexpr double kMinPlotFonts = 6.0;    // shortest side of the plot, in font sizes
constexpr double kMaxMagnitude = 1e100;  // keeps differences and ratios finite
constexpr int kMaxLabels = 8;            // that the ends of an axis are chosen for

Status CheckValues(const ChartSeries& series, const char* name, const std::vector<double>& values,
                   bool log) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    // Written so that a value that is not a number fails.
    if (std::abs(values[i]) <= kMaxMagnitude && (!log || values[i] >= 1.0 / kMaxMagnitude))
      continue;
    return Status::InvalidArgument("series '" + series.label + "', point " + std::to_string(i) +
                                   ": " + name + " = " + std::to_string(values[i]) +
                                   " has no place on a " + (log ? "logarithmic" : "linear") +
                                   " axis");
  }
  return Status::Ok();
}

Status CheckSeries(const ChartSeries& series, const LineChart& chart) {
  const std::size_t size = series.y.size();
  const bool has_band = !series.low.empty() || !series.high.empty();
  if (series.x.size() != size ||
      (has_band && (series.low.size() != size || series.high.size() != size))) {
    return Status::InvalidArgument("series '" + series.label +
                                   "': x, y, low and high differ in length");
  }
  PLUMBLINE_RETURN_IF_ERROR(CheckValues(series, "x", series.x, chart.log_x));
  PLUMBLINE_RETURN_IF_ERROR(CheckValues(series, "y", series.y, chart.log_y));
  PLUMBLINE_RETURN_IF_ERROR(CheckValues(series, "low", series.low, chart.log_y));
  return CheckValues(series, "high", series.high, chart.log_y);
}

Status CheckChart(const LineChart& chart, int width_px, int height_px) {
  for (const int side : {width_px, height_px}) {
    if (side >= kMinSidePx && side <= kMaxSidePx) continue;
    return Status::InvalidArgument("a side of " + std::to_string(side) +
                                   " px, but it must be from " + std::to_string(kMinSidePx) +
                                   " to " + std::to_string(kMaxSidePx));
  }
  bool empty = true;
  for (const ChartSeries& series : chart.series) {
    PLUMBLINE_RETURN_IF_ERROR(CheckSeries(series, chart));
    empty = empty && series.y.empty();
  }
  return empty ? Status::InvalidArgument("there is no point to draw") : Status::Ok();
}

// The context has the font that labels are written in.
ChartLegend LegendOf(const LineChart& chart, int width_px, cairo_t* context) {
  std::vector<std::string> labels;
  for (const ChartSeries& series : chart.series) labels.push_back(series.label);
  const double font_px = PrintFontPx(width_px);
  return ChartLegend(std::move(labels), width_px - font_px, font_px, context);
}

class ChartPainter {
 public:
  ChartPainter(const LineChart& chart, int width_px, int height_px, cairo_t* context)
      : chart_(chart), width_px_(width_px), height_px_(height_px), context_(context) {
    frame_.font_px = PrintFontPx(width_px);
    SelectFont(frame_.font_px, context);
    frame_.x.range = RangeOf({&ChartSeries::x}, chart.log_x);
    frame_.y.range = RangeOf({&ChartSeries::y, &ChartSeries::low, &ChartSeries::high}, chart.log_y);
    frame_.x.label = chart.x_label;
    frame_.y.label = chart.y_label;
  }

  Status Paint() {
    cairo_set_source_rgb(context_, 1.0, 1.0, 1.0);
    cairo_paint(context_);
    const double font = frame_.font_px;
    const ChartLegend legend = LegendOf(chart_, width_px_, context_);
    const double legend_top = height_px_ - legend.height_px() - 0.3 * font;
    frame_.y.first_px = std::floor(legend_top - BottomMarginPx(font) - 0.3 * font);
    frame_.y.last_px = std::ceil((chart_.title.empty() ? 0.8 : 2.0) * font);
    frame_.x.first_px = std::ceil(LeftMarginPx(frame_, context_) + 0.2 * font);
    frame_.x.last_px = width_px_ - font;  // near enough to tell the labels
    frame_.x.last_px = width_px_ - RightMarginPx(frame_, context_);
    if (!(std::min(frame_.width_px(), frame_.height_px()) >= kMinPlotFonts * font)) {
      return Status::InvalidArgument("the picture is too small for its legend and labels");
    }
    DrawGrid(frame_, context_);
    for (std::size_t i = 0; i < chart_.series.size(); ++i) PaintBand(i);
    DrawAxes(frame_, context_);
    for (std::size_t i = 0; i < chart_.series.size(); ++i) PaintSeries(i);
    SetColor(kBlack, 1.0, context_);
    DrawFittingText(chart_.title, frame_.x.first_px, 1.35 * font, frame_.width_px(), font,
                    context_);
    legend.Draw(0.5 * font, legend_top, context_);
    return Status::Ok();
  }

 private:
  AxisRange RangeOf(const std::vector<std::vector<double> ChartSeries::*>& values, bool log) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const ChartSeries& series : chart_.series) {
      for (const auto member : values) {
        for (const double value : series.*member) {
          low = std::min(low, value);
          high = std::max(high, value);
        }
      }
    }
    return RoundedRange(low, high, log, kMaxLabels);
  }

  Eigen::Vector2d At(double x, double y) const { return {frame_.x.At(x), frame_.y.At(y)}; }

  void PaintBand(std::size_t index) {
    const ChartSeries& series = chart_.series[index];
    if (series.low.empty()) return;
    const auto line_to = [&](double x, double y) {
      const Eigen::Vector2d pixel = At(x, y);
      cairo_line_to(context_, pixel.x(), pixel.y());
    };
    for (std::size_t i = 0; i < series.x.size(); ++i) line_to(series.x[i], series.low[i]);
    for (std::size_t i = series.x.size(); i-- > 0;) line_to(series.x[i], series.high[i]);
    cairo_close_path(context_);
    SetColor(StyleOfSeries(index).color, 0.18, context_);
    cairo_fill(context_);
  }

  void PaintSeries(std::size_t index) {
    const ChartSeries& series = chart_.series[index];
    std::vector<Eigen::Vector2d> pixels;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      pixels.push_back(At(series.x[i], series.y[i]));
    }
    DrawSeries(pixels, StyleOfSeries(index), frame_.font_px, context_);
  }

  const LineChart& chart_;
  const int width_px_, height_px_;
  cairo_t* context_;
  PlotFrame frame_;
};

}  // namespace

Status WriteLineChart(const std::string& path, const LineChart& chart, int width_px,
                      int height_px) {
  const auto refuse = [&path](const Status& status) {
    return Status::InvalidArgument("chart '" + path + "': " + status.message());
  };
  const Status input = CheckChart(chart, width_px, height_px);
  if (!input.ok()) return refuse(input);
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px));
  const CairoContext context(cairo_create(surface.get()));
  const Status painted = ChartPainter(chart, width_px, height_px, context.get()).Paint();
  if (!painted.ok()) return refuse(painted);
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  return CommitPng(path, surface.get(), context.get(), &file);
}

int LegendHeightPx(const LineChart& chart, int width_px) {
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1));
  const CairoContext context(cairo_create(surface.get()));
  SelectFont(PrintFontPx(width_px), context.get());
  return static_cast<int>(LegendOf(chart, width_px, context.get()).height_px());
}

}  // namespace plumbline
