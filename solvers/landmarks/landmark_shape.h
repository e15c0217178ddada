#ifndef PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"

namespace plumbline {

/// Two landmarks that follow each other along a scan: on one surface, or around a corner.
struct AdjacentLandmarks {
  int pose = 0;  ///< of the scan
  int first = 0;
  int second = 0;  ///< > first
};

/// Finds them: consecutive returns on different landmarks, no more than max_gap_m [m] apart. Once
/// per scan, in order of scans.
std::vector<AdjacentLandmarks> FindAdjacentLandmarks(const SlamGraph& graph,
                                                     const MeasuredSurface& surface,
                                                     const LineLandmarks& landmarks,
                                                     double max_gap_m, ThreadPool* pool);

/// Adds the shape terms of pairs that are within margin_rad of parallel or orthogonal,
///   1/2 w sin(angle)^2 / sigma^2,
/// w the robust weight, to what the pose observed of both landmarks. Each landmark of a pair is
/// told a direction t by the other one's normal as it is now, in the frame of the pose:
/// 1/2 w (n_r . t)^2 / sigma^2, n_r the landmark's normal in that frame, is of the form of a
/// scatter. So the terms turn along with the map. Their gradients on the pose cancel, and those on
/// the two landmarks are those of the term: where no line and no pose wants to move, that is an
/// optimum of the terms with both directions free.
void AddShapeTerms(const std::vector<AdjacentLandmarks>& adjacent, const ShapeOptions& options,
                   double margin_rad, const std::vector<LineLandmark>& landmarks,
                   const std::vector<PoseFrame>& frames, LineObservations* observations);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_
