#ifndef PLUMBLINE_SOLVERS_LANDMARKS_FIT_LANDMARK_LINES_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_FIT_LANDMARK_LINES_H_

#include <vector>

#include "plumbline/core/pose_frame.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"

namespace plumbline {

/// Moves every landmark's line to where it fits best: the principal component of its observations'
/// moments, placed by the poses. Gives the cost of all observations at these lines.
double FitLandmarkLines(const LineObservations& observations, const std::vector<PoseFrame>& frames,
                        ThreadPool* pool, std::vector<LineLandmark>* landmarks);

/// The cost of all observations at the lines as they are.
double LandmarkLineCost(const LineObservations& observations, const std::vector<PoseFrame>& frames,
                        const std::vector<LineLandmark>& landmarks, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_FIT_LANDMARK_LINES_H_
