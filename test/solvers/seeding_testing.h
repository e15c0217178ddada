#ifndef PLUMBLINE_TEST_SOLVERS_SEEDING_TESTING_H_
#define PLUMBLINE_TEST_SOLVERS_SEEDING_TESTING_H_

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/surface_points.h"
#include "plumbline/test/core/synthetic_scene.h"

namespace plumbline {

/// The four walls of a rectangle.
inline std::vector<Face> Rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const Eigen::Vector2d right(high.x(), low.y()), left(low.x(), high.y());
  return {{low, right}, {right, high}, {high, left}, {left, low}};
}

/// A rectangle of 6 m x 5 m about the origin whose view is the same from nowhere else: one corner
/// is cut off by an inner wall, and a pillar stands in another.
inline SyntheticScene Room() {
  SyntheticScene scene;
  scene.faces = Rectangle({-3.0, -2.5}, {3.0, 2.5});
  scene.faces.push_back({{1.5, 2.5}, {1.5, 1.2}});
  scene.discs.push_back({{-2.2, -1.6}, 0.3});
  return scene;
}

/// Adds odometry from each pose to the next: the true motion, passed through `distort`.
inline void AddOdometry(const std::function<Pose2(const Pose2&)>& distort, SlamGraph* graph) {
  for (int pose = 1; pose < graph->num_poses(); ++pose) {
    const Pose2 step = Between(graph->InitialPose(pose - 1), graph->InitialPose(pose));
    graph->AddOdometry({pose - 1, pose, distort(step)});
  }
}

inline std::vector<SurfacePoints> SurfacesOf(const SlamGraph& graph) {
  const MeasuredSurface surface = SurfaceOf(graph);
  std::vector<SurfacePoints> surfaces;
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    surfaces.push_back(ThinnedSurfaceOf(graph, scan, surface, kPointSpacingM));
  }
  return surfaces;
}

inline double DistanceM(const Pose2& a, const Pose2& b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_SOLVERS_SEEDING_TESTING_H_
