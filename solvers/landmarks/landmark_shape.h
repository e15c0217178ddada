#ifndef PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"

namespace plumbline {

/// Two landmarks that follow each other along scans: on one surface, or around a corner.
struct AdjacentLandmarks {
  int first = 0;
  int second = 0;  ///< > first
  int num_scans = 0;
};

/// Finds them: consecutive returns on different landmarks, no more than max_gap_m [m] apart. In
/// ascending order.
std::vector<AdjacentLandmarks> FindAdjacentLandmarks(const SlamGraph& graph,
                                                     const MeasuredSurface& surface,
                                                     const LineLandmarks& landmarks,
                                                     double max_gap_m, ThreadPool* pool);

/// Sets the shape terms of all landmarks: one per adjacent landmark and scan that saw both, if the
/// two are within margin_rad of parallel or orthogonal. The neighbour's direction is taken as it is
/// now, which leaves each term a function of one landmark alone:
///   1/2 w sin(angle)^2 / sigma^2 = 1/2 w (normal . t)^2 / sigma^2,
/// t the direction that the landmark should have, w the robust weight.
void SetShapeTerms(const std::vector<AdjacentLandmarks>& adjacent, const ShapeOptions& options,
                   double margin_rad, std::vector<LineLandmark>* landmarks);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_
