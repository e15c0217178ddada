#ifndef PLUMBLINE_APPS_FIGURES_PLOT_AXES_H_
#define PLUMBLINE_APPS_FIGURES_PLOT_AXES_H_

#include <string>
#include <vector>

typedef struct _cairo cairo_t;

namespace plumbline {

/// Size of a font [px] that comes out at 8 pt where a figure of this width [px] is printed 16 cm
/// wide, as over both columns of a paper.
double PrintFontPx(int figure_width_px);

/// The values that an axis covers: low < high, both finite, and positive on a logarithmic axis.
struct AxisRange {
  double low = 0.0, high = 1.0;
  bool log = false;
};

struct AxisTick {
  double value = 0.0;
  std::string label;  ///< empty for the finer lines of the grid
};

/// The values low <= high widened to where ticks are, at least a little: to multiples of a nice
/// step, some max_labels of them at most; on a logarithmic axis to 1, 2 or 5 times a power of ten,
/// to whole powers if they are more than three decades.
AxisRange RoundedRange(double low, double high, bool log, int max_labels);

/// Ticks within the range in ascending order, at most max_labels (>= 2) of them with a label:
/// multiples of 1, 2 or 5 times a power of ten; on a logarithmic axis powers of ten, with 2 and 5
/// times them if there is room and less than two decades.
std::vector<AxisTick> TicksOf(const AxisRange& range, int max_labels);

/// A range drawn from one pixel to another.
struct PlotAxis {
  AxisRange range;
  double first_px = 0.0, last_px = 0.0;
  std::string label;  ///< with its unit

  /// The pixel of a value that has a place on the axis.
  double At(double value) const;
  /// How many labels there is room for, at least 2. label_px: size of one along the axis.
  int MaxLabels(double label_px) const;
};

/// A plot's frame: x to the right, y up, so that y.first_px > y.last_px.
struct PlotFrame {
  PlotAxis x, y;
  double font_px = 0.0;

  double width_px() const { return x.last_px - x.first_px; }
  double height_px() const { return y.first_px - y.last_px; }
  /// Ticks of either axis, with as many labels as there is room for.
  std::vector<AxisTick> XTicks() const;
  std::vector<AxisTick> YTicks() const;
};

/// Room that the axes' labels take at the left of a frame, at its right and below it [px].
double LeftMarginPx(const PlotFrame& frame, cairo_t* context);
double RightMarginPx(const PlotFrame& frame, cairo_t* context);
double BottomMarginPx(double font_px);

/// Faint lines across the frame at all ticks.
void DrawGrid(const PlotFrame& frame, cairo_t* context);

/// Frame, ticks and labels, in the current font, of size frame.font_px. Labels that would be longer
/// than their axis are drawn smaller.
void DrawAxes(const PlotFrame& frame, cairo_t* context);

/// Draws a text like DrawText with its left end at (x, y), smaller if it is longer than max_px.
void DrawFittingText(const std::string& text, double x, double y, double max_px, double font_px,
                     cairo_t* context);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_FIGURES_PLOT_AXES_H_
