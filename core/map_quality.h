#ifndef PLUMBLINE_CORE_MAP_QUALITY_H_
#define PLUMBLINE_CORE_MAP_QUALITY_H_

#include <cstddef>
#include <string>

#include "plumbline/core/map_points.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

struct MapQualityOptions {
  /// Neighbourhood [m]: wide enough to hold both sides of a doubled wall, narrow enough to hold
  /// one wall only.
  double radius_m = 0.15;

  bool Check(std::string* error) const;
};

/// Sharpness of a point map, measured without ground truth, clutter included. Smaller is sharper,
/// but not always right: a map can be sharp and bent. Compares maps of the same returns.
struct MapQuality {
  /// Median over the samples of the square root of the smaller eigenvalue of the covariance of all
  /// points within the radius [m].
  double wall_thickness_m = 0.0;
  /// Mean map entropy: mean of ln(det(2 pi e Sigma)) / 2 over the same neighbourhoods [nat], as in
  /// Razlaw, Droeschel, Holz, Behnke: Evaluation of registration methods for sparse 3D laser scans
  /// (2015). Thinner than 0.1 mm counts as 0.1 mm.
  double mean_map_entropy = 0.0;
  std::size_t num_samples = 0;
};

/// points: finite. The result does not depend on the number of threads. Zero everywhere if no
/// neighbourhood has enough points.
MapQuality MeasureMapQuality(const MapPoints& points, const MapQualityOptions& options,
                             ThreadPool* pool);

/// The same for the points of a graph's returns, together with those of its peers (collective).
MapQuality MeasureMapQuality(const SlamGraph& graph, const MapPoints& points,
                             const MapQualityOptions& options, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_MAP_QUALITY_H_
