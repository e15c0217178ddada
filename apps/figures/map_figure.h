#ifndef PLUMBLINE_APPS_FIGURES_MAP_FIGURE_H_
#define PLUMBLINE_APPS_FIGURES_MAP_FIGURE_H_

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A rectangle of the world.
struct MapWindow {
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  double width_m = 0.0, height_m = 0.0;
};

/// One map.
struct MapPanel {
  std::string title;
  std::vector<double> points;     ///< x, y [m] in turn
  std::vector<Pose2> trajectory;  ///< of the robot; may be empty
  /// The two ends of walls that are really there, drawn thin under the points; may be empty.
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> truth_lines;
};

/// Maps to be compared, in one world frame.
struct MapFigure {
  std::vector<MapPanel> panels;
  /// Magnified below each panel, framed and lettered in the whole map.
  std::vector<MapWindow> details;
};

struct MapFigureOptions {
  int width_px = 2400;           ///< of the whole figure
  int max_map_height_px = 1600;  ///< of a map, without its axes
  double crop_share = 1e-3;      ///< of a map's points that may fall outside, at each side
  int point_px = 1;              ///< side of the square that a point is drawn as, odd

  bool Check(std::string* error) const;
};

/// Draws the maps side by side as one PNG picture, in rows of up to three: all with the same window
/// and scale, the details with another, larger one in common. Each has axes in m and a scale bar.
///
/// Points are a density image, the darker the more of them fall into a pixel, on one exposure for
/// all panels, so that a darker wall is a sharper one. The trajectory is a blue line, what is true
/// a green one, a detail's frame orange. Texts come out at 8 pt if the picture is printed 16 cm
/// wide. The same figure gives the same bytes.
///
/// InvalidArgument on options out of range; without panels; on a panel with neither points nor
/// trajectory or an odd number of coordinates; on coordinates that are not finite or beyond 1e9 m;
/// on details without area, or more than 26; if the picture would be taller than Cairo can hold.
/// Unavailable if the file cannot be written.
Status WriteMapFigure(const std::string& path, const MapFigure& figure,
                      const MapFigureOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_FIGURES_MAP_FIGURE_H_
