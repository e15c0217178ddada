#include "plumbline/apps/evaluation/map_sharpness.h"

namespace plumbline {

MapSharpness MeasureSharpness(const std::vector<double>& points, ThreadPool* pool) {
  MapSharpness sharpness;
  sharpness.num_points = points.size() / 2;
  for (const double radius_m : {0.1, 0.15, 0.2}) {
    MapQualityOptions options;
    options.radius_m = radius_m;
    sharpness.radii.push_back({radius_m, MeasureMapQuality(points, options, pool)});
  }
  return sharpness;
}

}  // namespace plumbline
