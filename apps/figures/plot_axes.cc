#include "plumbline/apps/figures/plot_axes.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "plumbline/apps/pictures/cairo_canvas.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// Slack for values that rounding has put next to a tick, as a share of the step.
constexpr double kSlack = 1e-6;
constexpr int kMaxFineDecades = 6;  // more would be gray rather than finer lines
constexpr double kFactors[] = {1.0, 2.0, 5.0};

double FirstMultiple(double low, double step) { return std::ceil(low / step - kSlack); }
double LastMultiple(double high, double step) { return std::floor(high / step + kSlack); }
// Of the range that is widened to multiples of the step.
double FirstOutside(double low, double step) { return std::floor(low / step + kSlack); }
double LastOutside(double high, double step) { return std::ceil(high / step - kSlack); }

// The smallest of 1, 2, 5 times a power of ten for which fits(step) holds; at least a tenth of
// `length` over max_labels, which never does.
template <typename Fits>
double SmallestNiceStep(double length, int max_labels, const Fits& fits) {
  double decade = std::pow(10.0, std::floor(std::log10(0.1 * length / max_labels)));
  while (true) {
    for (const double factor : kFactors) {
      if (fits(factor * decade)) return factor * decade;
    }
    decade *= 10.0;
  }
}

std::string Number(const char* format, int precision, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, precision, value);
  return text;
}

// All labels of an axis with the same number of decimals.
std::string LinearLabel(double value, double step) {
  const double digits = -std::floor(std::log10(step) + kSlack);
  if (digits > 5.0 || std::abs(value) >= 1e6) return Number("%.*g", 9, value);
  return Number("%.*f", std::max(0, static_cast<int>(digits)), value);
}

// Short where a number would be long: 1e-5, 2e6.
std::string LogLabel(double value, int decade) {
  if (std::abs(decade) < 4) return Number("%.*g", 6, value);
  return Number("%.*f", 0, value / std::pow(10.0, decade)) + "e" + std::to_string(decade);
}

std::vector<AxisTick> LinearTicks(const AxisRange& range, int max_labels) {
  const double step = SmallestNiceStep(range.high - range.low, max_labels, [&](double candidate) {
    return LastMultiple(range.high, candidate) - FirstMultiple(range.low, candidate) < max_labels;
  });
  std::vector<AxisTick> ticks;
  const double last = LastMultiple(range.high, step);
  for (double i = FirstMultiple(range.low, step); i <= last; ++i) {
    const double value = i == 0.0 ? 0.0 : i * step;  // no "-0"
    ticks.push_back({value, LinearLabel(value, step)});
  }
  return ticks;
}

// The powers of ten at or below the range's low end, and at or above its high end.
int FirstDecade(const AxisRange& range) {
  return static_cast<int>(std::floor(std::log10(range.low) + kSlack));
}

int LastDecade(const AxisRange& range) {
  return static_cast<int>(std::ceil(std::log10(range.high) - kSlack));
}

std::vector<AxisTick> LogTicks(const AxisRange& range, int max_labels) {
  const double num_decades = std::log10(range.high / range.low);
  const int every = std::max(1, static_cast<int>(std::ceil(num_decades / (max_labels - 1))));
  const int first_inside = static_cast<int>(std::ceil(std::log10(range.low) - kSlack));
  const bool label_fractions = num_decades < 2.0 && 3.0 * num_decades + 1.0 <= max_labels;
  std::vector<AxisTick> ticks;
  for (int decade = FirstDecade(range); decade <= LastDecade(range); ++decade) {
    for (int i = 1; i < 10; ++i) {
      const double value = i * std::pow(10.0, decade);
      if (value < range.low * (1.0 - kSlack) || value > range.high * (1.0 + kSlack)) continue;
      const bool labelled =
          i == 1 ? (decade - first_inside) % every == 0 : label_fractions && (i == 2 || i == 5);
      if (i > 1 && num_decades > kMaxFineDecades) continue;
      ticks.push_back({value, labelled ? LogLabel(value, decade) : ""});
    }
  }
  return ticks;
}

AxisRange RoundedLogRange(double low, double high) {
  AxisRange range{low, high, true};
  const bool whole = std::log10(high / low) > 3.0;
  range.low = std::pow(10.0, FirstDecade({low, high, true}));
  range.high = std::pow(10.0, LastDecade({low, high, true}));
  if (!whole) {
    for (const double factor : {5.0, 2.0}) {
      if (factor * range.low <= low * (1.0 + kSlack)) {
        range.low *= factor;
        break;
      }
    }
    for (const double divisor : {5.0, 2.0}) {
      if (range.high / divisor >= high * (1.0 - kSlack)) {
        range.high /= divisor;
        break;
      }
    }
  }
  if (range.high <= range.low * (1.0 + kSlack)) return {0.5 * range.low, 2.0 * range.high, true};
  return range;
}

double LabelWidthPx(const std::vector<AxisTick>& ticks, cairo_t* context) {
  double width = 0.0;
  for (const AxisTick& tick : ticks) width = std::max(width, TextWidth(tick.label, context));
  return width;
}

// Lines one pixel wide are sharp between two pixels.
double Sharp(double px) { return std::round(px) + 0.5; }

void StrokeLine(double x0, double y0, double x1, double y1, cairo_t* context) {
  cairo_move_to(context, x0, y0);
  cairo_line_to(context, x1, y1);
  cairo_stroke(context);
}

void DrawTicks(const PlotFrame& frame, cairo_t* context) {
  const double tick_px = 0.3 * frame.font_px;
  for (const AxisTick& tick : frame.XTicks()) {
    if (tick.label.empty()) continue;
    const double x = Sharp(frame.x.At(tick.value));
    StrokeLine(x, frame.y.first_px, x, frame.y.first_px + tick_px, context);
    DrawText(tick.label, x, frame.y.first_px + 1.3 * frame.font_px, TextAnchor::kCenter, context);
  }
  for (const AxisTick& tick : frame.YTicks()) {
    if (tick.label.empty()) continue;
    const double y = Sharp(frame.y.At(tick.value));
    StrokeLine(frame.x.first_px - tick_px, y, frame.x.first_px, y, context);
    DrawText(tick.label, frame.x.first_px - 0.5 * frame.font_px, y + 0.35 * frame.font_px,
             TextAnchor::kRight, context);
  }
}

// A label whose middle is at the origin of the context.
void DrawAxisLabel(const std::string& label, double max_px, double font_px, cairo_t* context) {
  const double width = std::min(TextWidth(label, context), max_px);
  DrawFittingText(label, -0.5 * width, 0.0, max_px, font_px, context);
}

}  // namespace

double PrintFontPx(int figure_width_px) {
  constexpr double kFontPt = 8.0, kWidthCm = 16.0, kPtPerCm = 72.0 / 2.54;
  return kFontPt / (kWidthCm * kPtPerCm) * figure_width_px;
}

AxisRange RoundedRange(double low, double high, bool log, int max_labels) {
  if (log) return RoundedLogRange(low, high);
  // What is narrower than this would have labels that do not differ.
  const double magnitude = std::max(std::abs(low), std::abs(high));
  const double least = magnitude == 0.0 ? 1.0 : 1e-6 * magnitude;
  if (high - low < least) {
    const double pad = low == high && magnitude > 0.0 ? 0.1 * magnitude : least;
    low -= pad;
    high += pad;
  }
  const double step = SmallestNiceStep(high - low, max_labels, [&](double candidate) {
    return LastOutside(high, candidate) - FirstOutside(low, candidate) < max_labels;
  });
  return {step * FirstOutside(low, step), step * LastOutside(high, step), false};
}

std::vector<AxisTick> TicksOf(const AxisRange& range, int max_labels) {
  return range.log ? LogTicks(range, max_labels) : LinearTicks(range, max_labels);
}

double PlotAxis::At(double value) const {
  const double share = range.log ? std::log(value / range.low) / std::log(range.high / range.low)
                                 : (value - range.low) / (range.high - range.low);
  return first_px + share * (last_px - first_px);
}

int PlotAxis::MaxLabels(double label_px) const {
  return std::max(2, static_cast<int>(std::abs(last_px - first_px) / label_px));
}

std::vector<AxisTick> PlotFrame::XTicks() const {
  return TicksOf(x.range, x.MaxLabels(4.0 * font_px));
}

std::vector<AxisTick> PlotFrame::YTicks() const {
  return TicksOf(y.range, y.MaxLabels(2.2 * font_px));
}

double LeftMarginPx(const PlotFrame& frame, cairo_t* context) {
  const double label_px = frame.y.label.empty() ? 0.0 : 1.5 * frame.font_px;
  return std::ceil(LabelWidthPx(frame.YTicks(), context) + 0.9 * frame.font_px + label_px);
}

double RightMarginPx(const PlotFrame& frame, cairo_t* context) {
  return std::ceil(0.5 * LabelWidthPx(frame.XTicks(), context) + 0.3 * frame.font_px);
}

double BottomMarginPx(double font_px) { return std::ceil(3.0 * font_px); }

void DrawGrid(const PlotFrame& frame, cairo_t* context) {
  cairo_set_line_width(context, 1.0);
  const auto set_gray = [&](const AxisTick& tick) {
    const double gray = tick.label.empty() ? 0.93 : 0.8;
    cairo_set_source_rgb(context, gray, gray, gray);
  };
  for (const AxisTick& tick : frame.XTicks()) {
    set_gray(tick);
    const double x = Sharp(frame.x.At(tick.value));
    StrokeLine(x, frame.y.first_px, x, frame.y.last_px, context);
  }
  for (const AxisTick& tick : frame.YTicks()) {
    set_gray(tick);
    const double y = Sharp(frame.y.At(tick.value));
    StrokeLine(frame.x.first_px, y, frame.x.last_px, y, context);
  }
}

void DrawAxes(const PlotFrame& frame, cairo_t* context) {
  cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
  cairo_set_line_width(context, 1.0);
  cairo_rectangle(context, Sharp(frame.x.first_px), Sharp(frame.y.last_px),
                  std::round(frame.width_px()), std::round(frame.height_px()));
  cairo_stroke(context);
  DrawTicks(frame, context);
  cairo_save(context);
  cairo_translate(context, 0.5 * (frame.x.first_px + frame.x.last_px),
                  frame.y.first_px + 2.55 * frame.font_px);
  DrawAxisLabel(frame.x.label, frame.width_px(), frame.font_px, context);
  cairo_restore(context);
  cairo_save(context);
  const double left = frame.x.first_px - LeftMarginPx(frame, context);
  cairo_translate(context, left + frame.font_px, 0.5 * (frame.y.first_px + frame.y.last_px));
  cairo_rotate(context, -0.5 * kPi);
  DrawAxisLabel(frame.y.label, frame.height_px(), frame.font_px, context);
  cairo_restore(context);
}

void DrawFittingText(const std::string& text, double x, double y, double max_px, double font_px,
                     cairo_t* context) {
  const double width = TextWidth(text, context);
  if (width > max_px) cairo_set_font_size(context, font_px * max_px / width);
  DrawText(text, x, y, TextAnchor::kLeft, context);
  cairo_set_font_size(context, font_px);
}

}  // namespace plumbline
