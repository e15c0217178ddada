#ifndef PLUMBLINE_TEST_CORE_INITIAL_GUESSES_H_
#define PLUMBLINE_TEST_CORE_INITIAL_GUESSES_H_

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// The measurements of a graph with other initial guesses, one per pose, and no named fixed poses.
inline SlamGraph WithInitialPoses(const SlamGraph& graph, const std::vector<Pose2>& poses) {
  SlamGraph other;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    other.AddPose(poses[pose], graph.timestamp_s(pose));
  }
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    other.AddScanOf(graph, scan, graph.scan(scan).pose);
  }
  for (const OdometryConstraint& step : graph.odometry()) {
    other.AddOdometry(step);
  }
  for (const RelativePoseConstraint& edge : graph.relative_poses()) {
    other.AddRelativePose(edge);
  }
  return other;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_CORE_INITIAL_GUESSES_H_
