#ifndef PLUMBLINE_APPS_FIGURES_SERIES_MARKS_H_
#define PLUMBLINE_APPS_FIGURES_SERIES_MARKS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/apps/pictures/palette.h"

typedef struct _cairo cairo_t;

namespace plumbline {

void SetColor(const Rgb& color, double opacity, cairo_t* context);

/// Draws pixels joined in their order, with a marker on each unless it is close to the one before.
/// font_px: what widths and sizes go by.
void DrawSeries(const std::vector<Eigen::Vector2d>& pixels, const SeriesStyle& style,
                double font_px, cairo_t* context);

/// Samples of lines with their labels, in columns of equal width.
class ChartLegend {
 public:
  /// width_px: all that there is. The context has the font that labels are written in.
  ChartLegend(std::vector<std::string> labels, double width_px, double font_px, cairo_t* context);

  double height_px() const;
  /// The line of label i has StyleOfSeries(i).
  void Draw(double left, double top, cairo_t* context) const;

 private:
  std::vector<std::string> labels_;
  double font_px_, column_px_;
  std::size_t num_columns_, num_rows_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_FIGURES_SERIES_MARKS_H_
