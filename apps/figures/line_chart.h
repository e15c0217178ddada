#ifndef PLUMBLINE_APPS_FIGURES_LINE_CHART_H_
#define PLUMBLINE_APPS_FIGURES_LINE_CHART_H_

#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// Points joined in their order, with markers.
struct ChartSeries {
  std::string label;
  std::vector<double> x, y;       ///< of equal length, finite; may be empty
  std::vector<double> low, high;  ///< a band around y, e.g. quartiles; empty or as long as y
};

struct LineChart {
  std::string title;             ///< may be empty
  std::string x_label, y_label;  ///< with units
  bool log_x = false, log_y = false;
  std::vector<ChartSeries> series;
};

/// Draws the chart as a PNG picture of that size. Axes end at round numbers and hold all points and
/// bands; the legend is below; texts come out at 8 pt if the picture is printed 16 cm wide. Lines
/// are told apart by colour, marker and dashes, see palette.h. The same chart gives the same bytes.
///
/// InvalidArgument if there is no point; on lengths that differ; on a value that is not finite or
/// beyond 1e100, or not positive on a logarithmic axis (the message names series and point); on a
/// side that is not in [200, 10000] px; and on a picture too small for its legend.
/// Unavailable if the file cannot be written.
Status WriteLineChart(const std::string& path, const LineChart& chart, int width_px, int height_px);

/// Height [px] of the chart's legend in a picture of that width.
int LegendHeightPx(const LineChart& chart, int width_px);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_FIGURES_LINE_CHART_H_
