#ifndef PLUMBLINE_APPS_IO_MAP_RASTER_H_
#define PLUMBLINE_APPS_IO_MAP_RASTER_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "plumbline/core/map_points.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/pose2.h"
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
  /// Which one of the pixels, row by row, a point falls into; negative if that is outside, or the
  /// point is not finite.
  std::ptrdiff_t PixelAt(double x_m, double y_m) const {
    const double column = Column(x_m), row = Row(y_m);
    // Written so that a coordinate that is not a number fails.
    if (!(column >= 0.0 && column < width && row >= 0.0 && row < height)) return -1;
    return static_cast<std::ptrdiff_t>(row) * width + static_cast<std::ptrdiff_t>(column);
  }
};

/// The largest of 1, 2, 2.5, 5 times a power of ten that is <= value, which is positive.
double RoundDownToNice(double value);

/// An interval of world coordinates [m].
struct Interval {
  double low = 0.0, high = 0.0;
  double length() const { return high - low; }
};

/// The part of the world that a map picture shows.
struct MapExtent {
  Interval x, y;
};

/// The extent of the whole trajectory and all points but a share of crop_share at each side, with a
/// margin. Points that are not finite do not count. InvalidArgument if the map reaches farther than
/// 1e9 m. Needs a pose or a finite point; the poses are finite.
Status FindExtent(const MapPoints& points, const std::vector<Pose2>& trajectory, double crop_share,
                  MapExtent* extent);

/// The same for the points of a graph's returns, as MapPoints has them of a state, together with
/// those of its peers (collective).
Status FindExtent(const SlamGraph& graph, const MapState& state, double crop_share,
                  MapExtent* extent);

/// A raster over that extent, with pixels of a nice size, at least min_pixel_m, on a grid through
/// the world's origin. Fails like FindExtent.
Status ChooseRaster(const SlamGraph& graph, const MapState& state, double crop_share,
                    int max_side_px, MapRaster* raster, double min_pixel_m = 0.01);

/// Number of points per pixel, row by row. Points that are not finite fall outside.
std::vector<std::uint32_t> CountHits(const MapPoints& points, const MapRaster& raster);

/// The same for the points of a graph's returns, without those of what moves (SlamGraph::Moves).
std::vector<std::uint32_t> CountHitsAtRest(const SlamGraph& graph, const MapPoints& points,
                                           const MapRaster& raster);

/// Adds up what all who work on a graph have per pixel (collective): process `rank` gets the sums,
/// the others get nothing.
void GatherHits(const Peers* peers, int rank, std::vector<std::uint32_t>* hits);

/// Number of hits to be drawn black: what the fullest tenth of the pixels that were hit has. Maps
/// that are to be compared share the level of all their hits together.
double BlackLevel(const std::vector<std::uint32_t>& hits);

/// Gray value per pixel: the darker the more hits, black from black_level on; 255 where there is
/// none.
std::vector<std::uint8_t> DensityImage(const std::vector<std::uint32_t>& hits, double black_level);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_MAP_RASTER_H_
