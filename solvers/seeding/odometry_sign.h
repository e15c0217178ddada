#ifndef PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_SIGN_H_
#define PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_SIGN_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/seeding/surface_points.h"

namespace plumbline {

/// Some drivers log the length of a motion and lose its sign: the robot backs up, the odometry says
/// forward. What the data says about that.
struct OdometrySignReport {
  /// Steps of the odometry that go backwards. One is enough: this odometry has a sign.
  int num_backward_steps = 0;
  /// Steps that scan matching alone, blind to the odometry's translation, could decide.
  int num_decided = 0;
  /// Of these, steps that went backwards by about the length that the odometry calls forward, and
  /// so did the next two decided ones.
  int num_contradicting = 0;
  bool sign_lost = false;
};

/// Recognises an odometry that lost the sign of its translation: it never goes backwards, and a
/// consistent share of consecutive scans says that the robot did.
/// surfaces: per scan, in the frame of the robot.
OdometrySignReport CheckOdometrySign(const SlamGraph& graph,
                                     const std::vector<SurfacePoints>& surfaces, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_SIGN_H_
