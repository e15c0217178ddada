#ifndef PLUMBLINE_SOLVERS_INCREMENTAL_ACTIVE_PROBLEM_H_
#define PLUMBLINE_SOLVERS_INCREMENTAL_ACTIVE_PROBLEM_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/pose_frame.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/incremental/edges_by_pose.h"
#include "plumbline/solvers/incremental/landmark_store.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

/// The part of a map that moves: the active poses, the landmarks that they see, and the constraints
/// on them. What other poses saw of these landmarks is held: it is summed up, as if the first pose
/// of the problem, which is constant and has no counterpart in the graph, had seen it. So the
/// problem has the size of the part, not of the map.
struct ActiveProblem {
  /// active: ascending. poses: of the graph, (x, y, yaw) each.
  ActiveProblem(const std::vector<int>& active, const SlamGraph& graph, const EdgesByPose& edges,
                const LandmarkStore& store, const std::vector<double>& poses, ThreadPool* pool);

  /// Reads what the active poses saw again, after they were weighed.
  void ReadObservations(const LandmarkStore& store, ThreadPool* pool);

  /// The active poses, by their ids in the graph, whose returns have moved against their lines by
  /// more than the tolerance [m] since they were weighed, root mean square.
  std::vector<int> MovedPoses(const LandmarkStore& store, double tolerance_m) const;

  std::vector<int> pose_ids;      ///< in the graph; that of the first pose means nothing
  std::vector<double> poses;      ///< (x, y, yaw) each
  std::vector<int> landmark_ids;  ///< in the store
  std::vector<LineLandmark> landmarks;
  LineObservations observations;
  PoseTerms terms;

 private:
  void AddEdges(const EdgesByPose& edges, const std::vector<double>& all_poses);
  void AddObservations(const LandmarkStore& store, const std::vector<double>& all_poses,
                       ThreadPool* pool);
  void ReadLandmark(const StoredLandmark& landmark, std::size_t p,
                    const std::vector<double>& all_poses);
  bool IsActive(int id) const;
  const StoredObservation& Stored(const LandmarkStore& store, std::size_t i) const;
  int PoseInPart(int id, const std::vector<double>& all_poses);

  std::size_t num_active_ = 0;
  std::vector<int> part_of_pose_;      // per pose of the graph; -1: not in the part
  std::vector<std::size_t> in_store_;  // per observation: which one of its landmark
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INCREMENTAL_ACTIVE_PROBLEM_H_
