#ifndef PLUMBLINE_APPS_FIGURES_MAP_LAYOUT_H_
#define PLUMBLINE_APPS_FIGURES_MAP_LAYOUT_H_

#include <vector>

#include "plumbline/apps/figures/map_figure.h"
#include "plumbline/apps/figures/plot_axes.h"
#include "plumbline/apps/io/map_raster.h"

namespace plumbline {

/// A window of the world on the figure.
struct MapView {
  MapRaster raster;
  int left_px = 0, top_px = 0;  ///< of the raster, within its panel or the figure

  /// The axes around it, moved by (left, top).
  PlotFrame Frame(double left, double top, double font_px) const;
};

/// Where everything in a map figure goes [px].
struct MapLayout {
  double font_px = 0.0;
  int title_px = 0;  ///< height of the row above each view, with its title and scale bar
  int num_columns = 1;
  int panel_width_px = 0, panel_height_px = 0;
  int height_px = 0;             ///< of the whole figure
  MapView map;                   ///< of a panel, within it
  std::vector<MapView> details;  ///< likewise, one per detail

  int PanelLeft(int panel) const { return panel % num_columns * panel_width_px; }
  int PanelTop(int panel) const { return panel / num_columns * panel_height_px; }
};

/// extent: what all maps show. The figure has panels, and its details have areas.
MapLayout LayOutMaps(const MapFigure& figure, const MapExtent& extent,
                     const MapFigureOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_FIGURES_MAP_LAYOUT_H_
