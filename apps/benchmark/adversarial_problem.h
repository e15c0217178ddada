#ifndef PLUMBLINE_APPS_BENCHMARK_ADVERSARIAL_PROBLEM_H_
#define PLUMBLINE_APPS_BENCHMARK_ADVERSARIAL_PROBLEM_H_

#include <vector>

#include "plumbline/apps/benchmark/adversarial.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A graph that is ready to be solved, and where its poses should be.
struct AdversarialProblem {
  SlamGraph graph;
  std::vector<Pose2> truth;  ///< one per pose, in the frame of the first
  /// Per relative pose of the graph: it is wrong on purpose.
  std::vector<char> is_false;
};

/// Simulates the drive of a case and falsifies it. A host's graph holds odometry from pose to pose
/// and, between poses of different passes that look at the same place, relative poses.
/// InvalidArgument if the simulation refuses.
Status MakeAdversarialProblem(const AdversarialCase& run, AdversarialProblem* problem);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_ADVERSARIAL_PROBLEM_H_
