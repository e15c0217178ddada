#ifndef PLUMBLINE_SOLVERS_FRONT_END_CORRELATIVE_MATCHER_H_
#define PLUMBLINE_SOLVERS_FRONT_END_CORRELATIVE_MATCHER_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

/// Poses within half_width_m (in x and in y) and half_angle_rad of the center.
struct SearchWindow {
  Pose2 center;
  double half_width_m = 0.0;
  double half_angle_rad = 0.0;
};

struct CorrelativeMatch {
  bool found = false;
  /// The search was ended early: there may be a better pose, or one after all.
  bool gave_up = false;
  Pose2 map_from_scan;
  /// Mean likelihood of the scan's points in [0, 1].
  double score = 0.0;
};

/// Size of a peak: its poses are this near to its best one.
struct PeakSize {
  double radius_m = 0.0;
  double angle_rad = 0.0;
};

/// Finds where in a map a scan fits best, anywhere in a window, by branch and bound over a pyramid
/// of likelihood grids. Source: Olson: Real-time correlative scan matching (2009); Hess et al.:
/// Real-time loop closure in 2D lidar SLAM (2016).
class CorrelativeMatcher {
 public:
  /// The pose is found to about cell_m; a map point is felt within two cells. Searches of windows
  /// up to half_width_m [m] are fast; those of wider ones find the same, more slowly.
  CorrelativeMatcher(const SurfacePoints& map, double cell_m, double half_width_m);

  /// The best pose of the window that scores more than min_score, if there is one.
  CorrelativeMatch Search(const SurfacePoints& scan, const SearchWindow& window,
                          double min_score) const;

  /// The best poses of up to max_peaks peaks that score more than min_score, the best first. Peaks
  /// that share poses may count as one; some may be missing if the search is ended early, where
  /// everything fits a little.
  std::vector<CorrelativeMatch> SearchPeaks(const SurfacePoints& scan, const SearchWindow& window,
                                            double min_score, int max_peaks,
                                            const PeakSize& size) const;

 private:
  friend class BranchAndBound;

  // Level h holds, per cell, the largest likelihood of the 2^h x 2^h cells from there upwards.
  using Level = std::vector<std::uint8_t>;

  void Splat(const Eigen::Vector2d& point);
  void Coarsen(int level);

  double cell_m_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int width_ = 0;
  int height_ = 0;
  // The cells outside these are empty.
  Eigen::Vector2i map_low_ = Eigen::Vector2i::Zero(), map_high_ = Eigen::Vector2i::Zero();
  std::vector<Level> levels_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_CORRELATIVE_MATCHER_H_
