#ifndef PLUMBLINE_APPS_FIGURES_CHOOSE_DETAILS_H_
#define PLUMBLINE_APPS_FIGURES_CHOOSE_DETAILS_H_

#include <vector>

#include "plumbline/apps/figures/map_figure.h"

namespace plumbline {

/// The `count` windows, squares of size_m [m], in which two maps of the same returns differ most,
/// the one with the largest difference first. They do not overlap. Fewer if the rest of the maps
/// is no sharper in `after`.
///
/// Difference: returns that lie side by side on one thin surface in `after` are looked up in
/// `before`; how much thicker they are there (as on a wall that was doubled), at most a quarter of
/// a window, summed over the window's surface. Does not depend on how often a wall was seen, nor on
/// whether the two maps lie exactly upon each other.
///
/// before, after: x, y [m] in turn, of equal length; points that are not finite do not count.
std::vector<MapWindow> ChooseDetails(const std::vector<double>& before,
                                     const std::vector<double>& after, int count, double size_m);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_FIGURES_CHOOSE_DETAILS_H_
