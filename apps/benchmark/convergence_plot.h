#ifndef PLUMBLINE_APPS_BENCHMARK_CONVERGENCE_PLOT_H_
#define PLUMBLINE_APPS_BENCHMARK_CONVERGENCE_PLOT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// Points joined in their order, each with a marker unless it is close to the one before.
struct ConvergenceLine {
  std::string label;
  std::vector<Eigen::Vector2d> points;
};

struct ConvergencePlot {
  std::string title;
  std::string x_label, y_label;        ///< with units
  std::vector<ConvergenceLine> lines;  ///< drawn in the order of palette.h
};

/// Draws the lines as a PNG picture, 1200 pixels wide. Both axes are logarithmic and hold all
/// points; a point with a coordinate that is not finite and positive has no place on them and is
/// left out. The legend is below and adds its height to the picture. The same plot gives the same
/// bytes.
///
/// InvalidArgument if there is no point to draw; Unavailable if the file cannot be
/// written.
Status WriteConvergencePlot(const std::string& path, const ConvergencePlot& plot);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_CONVERGENCE_PLOT_H_
