#ifndef PLUMBLINE_APPS_PICTURES_MAP_OVERLAY_H_
#define PLUMBLINE_APPS_PICTURES_MAP_OVERLAY_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/apps/io/map_raster.h"
#include "plumbline/apps/pictures/palette.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"

typedef struct _cairo cairo_t;

namespace plumbline {

enum class OverlayStyle {
  kLinks,        ///< solid lines with a dot at both ends
  kDashedLinks,  ///< dashed lines
  kRings,        ///< circles of a fixed size on the picture
  kPoints,       ///< the pixels that they fall into
  kScans,        ///< the pixels that the map points of scans fall into
};

/// One kind of marks on a map, with a line of the legend.
struct MapOverlay {
  OverlayStyle style = OverlayStyle::kLinks;
  Rgb color;
  std::string label;  ///< empty: no line of the legend
  /// World frame [m]. Links: the two ends of each in turn; rings: their centres.
  std::vector<Eigen::Vector2d> points;
  /// Of kScans: those from the first one on, by ids among all.
  int first_scan = 0, num_scans = 0;
};

/// Which pixels the points of an overlay fall into, row by row; empty but for kPoints and kScans. A
/// graph with peers gives process `drawn_by` those of the scans of all (collective).
std::vector<bool> PixelsOf(const MapOverlay& overlay, const SlamGraph& graph, const MapState& state,
                           const MapRaster& raster, int drawn_by);

/// Draws the marks on a map whose upper left corner is the origin of the context. pixels: PixelsOf
/// the overlay.
void DrawOverlay(const MapOverlay& overlay, const MapRaster& raster,
                 const std::vector<bool>& pixels, cairo_t* context);

/// Draws a sample of the marks, some 40 pixels wide and centred at (x, y) [px].
void DrawOverlaySample(const MapOverlay& overlay, double x, double y, cairo_t* context);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_MAP_OVERLAY_H_
