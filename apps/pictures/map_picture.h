#ifndef PLUMBLINE_APPS_PICTURES_MAP_PICTURE_H_
#define PLUMBLINE_APPS_PICTURES_MAP_PICTURE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/io/map_raster.h"
#include "plumbline/apps/pictures/map_overlay.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

typedef struct _cairo cairo_t;

namespace plumbline {

struct MapPictureOptions {
  std::string title;         ///< stands before the numbers of scans and returns
  int max_side_px = 2400;    ///< the longer side of the map area
  double crop_share = 1e-3;  ///< of the points that may fall outside, at each side
  /// Drawn in this order. Map and trajectory step back behind them in lighter shades of gray.
  std::vector<MapOverlay> overlays;

  bool Check(std::string* error) const;
};

/// Where the map is in its picture: column 0 and row 0 of the raster are at the pixel (left_px,
/// top_px), and the strips for title and legend lie around it.
struct MapArea {
  MapRaster raster;
  int left_px = 0, top_px = 0;
};

/// The map points of a state as a PNG picture: x to the right, y up, equal scale. Those of a state
/// without points are where the measurements put them.
///
/// Points are a density image, the darker the more returns fall into a pixel, on an exposure taken
/// from the picture itself. The trajectory of the robot is a red line that starts at a green dot.
/// A pixel is 1, 2, 2.5 or 5 times a power of ten [cm], at least 1 cm, on a grid through the
/// world's origin, so that pictures of one log can be laid over each other. The area holds the
/// whole trajectory and all but the farthest points (crop_share). The same input gives the same
/// bytes.
///
/// It takes two steps, so that processes that share a graph gather together what several pictures
/// show, and then each draw one.
class MapPicture {
 public:
  /// Counts the returns per pixel, without those of what moves. A graph with peers gets those of
  /// all (collective); only process `drawn_by` can draw them. Refers to the graph and the state.
  ///
  /// InvalidArgument on options out of range, on a graph without poses, and on poses that are not
  /// finite or a map larger than 1e9 m; points that are not finite are left out.
  Status Gather(const SlamGraph& graph, const MapState& state, const MapPictureOptions& options,
                int drawn_by = 0);

  /// Where the map will be in the picture, known to all processes.
  MapArea area() const;

  /// Writes the file. Unavailable if that fails.
  Status Draw(const std::string& path) const;

 private:
  int LegendHeight() const;
  int Width() const;
  void DrawMap(cairo_t* context) const;

  const SlamGraph* graph_ = nullptr;
  const MapState* state_ = nullptr;
  MapPictureOptions options_;
  MapRaster raster_;
  std::vector<std::uint32_t> hits_;                // per pixel
  std::vector<std::vector<bool>> overlay_pixels_;  // PixelsOf each
};

/// Both steps, the second one by process 0. Sets *area, if given, on success only.
Status WriteMapPicture(const std::string& path, const SlamGraph& graph, const MapState& state,
                       const MapPictureOptions& options, MapArea* area = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_MAP_PICTURE_H_
