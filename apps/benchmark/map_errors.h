#ifndef PLUMBLINE_APPS_BENCHMARK_MAP_ERRORS_H_
#define PLUMBLINE_APPS_BENCHMARK_MAP_ERRORS_H_

#include <limits>
#include <vector>

#include "plumbline/apps/benchmark/synthetic_drive.h"

namespace plumbline {

/// How far a map is off, with the first poses of estimate and truth on each other.
struct MapErrors {
  std::vector<double> pose_m;       ///< per pose, of its position
  std::vector<double> heading_rad;  ///< per pose, without sign
  /// Per return, from the point on the surface that its beam hit; NaN if there is none.
  std::vector<double> point_m;
};

/// estimate and truth have as many poses and points.
MapErrors MeasureMapErrors(const MapEstimate& estimate, const MapEstimate& truth);

/// Mean and variance over n; values that are NaN do not count. NaN if none is left.
struct MeanAndVariance {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double variance = std::numeric_limits<double>::quiet_NaN();
};
MeanAndVariance MeanAndVarianceOf(const std::vector<double>& values);

/// Of a set of values, those below which a quarter, half and three quarters of them are, between
/// two neighbours in proportion. NaN if there are none.
struct Quartiles {
  double low = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};
Quartiles QuartilesOf(std::vector<double> values);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_MAP_ERRORS_H_
