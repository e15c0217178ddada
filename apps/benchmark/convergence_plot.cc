#include "plumbline/apps/benchmark/convergence_plot.h"

#include "plumbline/apps/figures/line_chart.h"

namespace plumbline {
namespace {

constexpr int kWidthPx = 1200, kChartPx = 808;  // without the legend

bool HasPlace(const Eigen::Vector2d& point) {
  return point.allFinite() && point.x() > 0.0 && point.y() > 0.0;
}

}  // namespace

Status WriteConvergencePlot(const std::string& path, const ConvergencePlot& plot) {
  LineChart chart{plot.title, plot.x_label, plot.y_label, true, true, {}};
  for (const ConvergenceLine& line : plot.lines) {
    ChartSeries series;
    series.label = line.label;
    for (const Eigen::Vector2d& point : line.points) {
      if (!HasPlace(point)) continue;
      series.x.push_back(point.x());
      series.y.push_back(point.y());
    }
    chart.series.push_back(series);
  }
  return WriteLineChart(path, chart, kWidthPx, kChartPx + LegendHeightPx(chart, kWidthPx));
}

}  // namespace plumbline
