#ifndef PLUMBLINE_APPS_IO_MAP_RASTER_H_
#define PLUMBLINE_APPS_IO_MAP_RASTER_H_

#include <cstdint>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// The pixels of a picture's map area; column 0 and row 0 are at the top left.
struct MapRaster {
  double pixel_m = 0.0;
  double left_m = 0.0;  ///< world x of the left edge
  double top_m = 0.0;   ///< world y of the upper edge
  int width = 0, height = 0;

  double Column(double x_m) const { return (x_m - left_m) / pixel_m; }
  double Row(double y_m) const { return (top_m - y_m) / pixel_m; }
};

/// The largest of 1, 2, 2.5, 5 times a power of ten that is <= value, which is positive.
double RoundDownToNice(double value);

/// A raster for the whole trajectory and all points but a share of crop_share at each side. Fails
/// on a map that reaches farther than 1e9 m. The graph has poses, all finite.
Status ChooseRaster(const SlamGraph& graph, double crop_share, int max_side_px, MapRaster* raster);

/// Gray value per pixel, row by row: the darker the more map points, on an exposure taken from the
/// image itself; 255 where there is none. Points that are not finite fall outside.
std::vector<std::uint8_t> DensityImage(const SlamGraph& graph, const MapRaster& raster);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_MAP_RASTER_H_
