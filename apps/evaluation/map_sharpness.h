#ifndef PLUMBLINE_APPS_EVALUATION_MAP_SHARPNESS_H_
#define PLUMBLINE_APPS_EVALUATION_MAP_SHARPNESS_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/map_quality.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

struct SharpnessAtRadius {
  double radius_m = 0.0;
  MapQuality quality;
};

/// Sharpness of one map at several scales.
struct MapSharpness {
  std::size_t num_points = 0;
  std::vector<SharpnessAtRadius> radii;
};

/// Measures points (x, y [m] in turn, finite) with neighbourhoods of 0.1, 0.15 and 0.2 m, so that
/// the order of two maps does not hang on the one radius that was picked.
MapSharpness MeasureSharpness(const std::vector<double>& points, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_MAP_SHARPNESS_H_
