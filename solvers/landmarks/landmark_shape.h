#ifndef PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_

#include <vector>

#include "plumbline/core/pose_frame.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"

namespace plumbline {

/// Two landmarks that follow each other along a scan: on one surface, or around a corner.
struct AdjacentLandmarks {
  int pose = 0;  ///< of the scan
  int first = 0;
  int second = 0;  ///< > first
};

/// Finds them: consecutive returns on different landmarks, no more than kShapeRegionM apart. Once
/// per scan, in order of scans.
std::vector<AdjacentLandmarks> FindAdjacentLandmarks(const SlamGraph& graph,
                                                     const LineLandmarks& landmarks,
                                                     ThreadPool* pool);

/// Adds the shape terms of pairs that are within kShapeMarginRad of parallel or orthogonal,
///   1/2 w |n* - n|^2 / sigma^2,
/// n and n* the normals of the two, n* turned by right angles next to n, sigma kShapeSigmaRad, w
/// the weight of a robust loss with this gate [standard deviations]. They go to what the pose
/// observed of the two landmarks: each is drawn to the direction midway between n and n* as they
/// are now, in the frame of the pose, with twice the weight. That is of the form of a scatter; its
/// cost and its gradients, here, are those of the term, so the terms turn along with the map, and
/// their pulls on the pose cancel. Where nothing wants to move, that is a stationary point of the
/// terms with both directions free.
void AddShapeTerms(const std::vector<AdjacentLandmarks>& adjacent, double gate_sigmas,
                   const std::vector<LineLandmark>& landmarks, const std::vector<PoseFrame>& frames,
                   LineObservations* observations);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_LANDMARK_SHAPE_H_
