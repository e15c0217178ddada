#ifndef PLUMBLINE_APPS_PICTURES_BEFORE_AFTER_PICTURE_H_
#define PLUMBLINE_APPS_PICTURES_BEFORE_AFTER_PICTURE_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/io/map_raster.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

typedef struct _cairo cairo_t;
typedef struct _cairo_surface cairo_surface_t;

namespace plumbline {

struct BeforeAfterOptions {
  /// Two maps of this side fit into one of Cairo's images.
  static constexpr int kLargestSidePx = 15000;

  std::string before_title, after_title;
  int max_side_px = 2400;  ///< the longer side of either map; at most kLargestSidePx

  bool Check(std::string* error) const;
};

/// A map before and after its estimation as one PNG picture: two density images of the same window
/// and size, on one exposure, side by side if the map is taller than wide and one above the other
/// if not, so that the picture stays handy. Gathered and drawn like a MapPicture.
class BeforeAfterPicture {
 public:
  /// poses_before: in the form of MapState::poses; the points before are where the measurements
  /// put them from there. After: the poses and points of `state`, which also choose the window, as
  /// in a MapPicture. A pixel is 2 cm; on maps for which max_side_px is too small the next of 2.5,
  /// 5, 10, 20, 25 ... cm. The scale bar's line tells. The same input gives the same bytes.
  ///
  /// InvalidArgument on options out of range, poses that are not finite or not as many as the
  /// graph's, a graph without poses, and a map larger than 1e9 m; points that are not finite are
  /// left out. A graph with peers gets the returns of all (collective); only process `drawn_by` can
  /// draw them.
  Status Gather(const SlamGraph& graph, const MapState& state,
                const std::vector<double>& poses_before, const BeforeAfterOptions& options,
                int drawn_by = 0);

  /// Writes the file. Unavailable if that fails.
  Status Draw(const std::string& path) const;

 private:
  struct Panel {
    std::string title;
    std::vector<std::uint32_t> hits;  // per pixel
  };
  void DrawPanels(cairo_surface_t* surface) const;
  void DrawCaptions(cairo_t* context) const;

  MapRaster raster_;
  std::array<Panel, 2> panels_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_BEFORE_AFTER_PICTURE_H_
