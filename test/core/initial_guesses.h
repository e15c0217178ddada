#ifndef PLUMBLINE_TEST_CORE_INITIAL_GUESSES_H_
#define PLUMBLINE_TEST_CORE_INITIAL_GUESSES_H_

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// The measurements of a graph with other initial guesses, one per pose, and no named fixed poses.
inline SlamGraph WithInitialPoses(const SlamGraph& graph, const std::vector<Pose2>& poses) {
  SlamGraph other;
  int id = 0;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    EXPECT_TRUE(other.AddPose(poses[pose], graph.timestamp_s(pose), &id).ok());
  }
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    EXPECT_TRUE(other.AddScanOf(graph, scan, graph.scan(scan).pose).ok());
  }
  for (const OdometryConstraint& step : graph.odometry()) {
    EXPECT_TRUE(other.AddOdometry(step).ok());
  }
  for (const RelativePoseConstraint& edge : graph.relative_poses()) {
    EXPECT_TRUE(other.AddRelativePose(edge).ok());
  }
  return other;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_CORE_INITIAL_GUESSES_H_
