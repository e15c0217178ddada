#ifndef PLUMBLINE_TEST_SOLVERS_NOISY_ROOM_H_
#define PLUMBLINE_TEST_SOLVERS_NOISY_ROOM_H_

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/interface/solver_summary.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {

/// A robot's drive through a room of 6 x 4 m with a partition, by a laser that sits off the robot's
/// centre and turned. Every kind of term occurs. World frame.
struct NoisyRoom {
  SlamGraph graph;  ///< its initial guesses are the truth
  std::vector<Pose2> truth;
  MapState state;  ///< starts at the truth
};

struct NoisyRoomOptions {
  int num_poses = 12;
  int num_beams = 180;
  double range_sigma_m = 0.01;
  double odometry_sigma = 0.01;  ///< [m] and [rad] per step
};

inline NoisyRoom MakeNoisyRoom(const NoisyRoomOptions& options = NoisyRoomOptions()) {
  SyntheticScene scene;
  static const Face kFaces[] = {{{-3, -2}, {3, -2}}, {{3, -2}, {3, 2}},
                                {{3, 2}, {-3, 2}},   {{-3, 2}, {-3, -2}},
                                {{0, 0.8}, {0, 2}},  {{-1.5, -1.2}, {-0.7, -1.2}}};
  scene.faces.assign(std::begin(kFaces), std::end(kFaces));
  scene.laser = PanoramicLaser(options.num_beams);
  scene.laser.robot_from_laser = {0.1, -0.05, 0.3};
  scene.range_sigma_m = options.range_sigma_m;
  for (int i = 0; i < options.num_poses; ++i) {
    const double turn = 2.0 * kPi * i / options.num_poses;
    scene.poses.push_back({1.8 * std::cos(turn), 0.5 * std::sin(turn), turn + 0.5 * kPi});
  }
  NoisyRoom room{MakeGraph(scene, 7), scene.poses, {}};
  room.state = room.graph.InitialState();
  RandomStates random(11);
  const auto motion = [&](int from, int to) {
    const Pose2 exact = Between(room.truth[from], room.truth[to]);
    const double sigma = options.odometry_sigma;
    // One after the other: compilers differ in the order of arguments.
    const double yaw = random.Gaussian(sigma), y = random.Gaussian(sigma);
    return exact * Pose2(random.Gaussian(sigma), y, yaw);
  };
  for (int i = 0; i + 1 < options.num_poses; ++i) {
    room.graph.AddOdometry({i, i + 1, motion(i, i + 1)});
  }
  const Eigen::Matrix3d covariance = 0.01 * CorrelatedCovariance();
  const int last = options.num_poses - 1;
  room.graph.AddRelativePose({last, 0, motion(last, 0), covariance});
  room.graph.AddRelativePose({1, last / 2, motion(1, last / 2), covariance});
  return room;
}

/// Moves all poses but the first by some noise [m] and [rad], and the points with them.
inline void DisturbPoses(double sigma, const SlamGraph& graph, MapState* state) {
  RandomStates random(5);
  for (std::size_t i = 3; i < state->poses.size(); ++i) state->poses[i] += random.Gaussian(sigma);
  state->points = graph.MeasuredMap(state->poses);
}

/// Moves every point by some noise [m].
inline void DisturbPoints(double sigma, MapState* state) {
  RandomStates random(6);
  for (double& coordinate : state->points) coordinate += random.Gaussian(sigma);
}

/// The room with a relative pose from every pose to the next, beside the two that it comes with.
inline NoisyRoom RoomWithEdges(const NoisyRoomOptions& options = NoisyRoomOptions()) {
  NoisyRoom room = MakeNoisyRoom(options);
  const std::vector<OdometryConstraint> steps = room.graph.odometry();
  const Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
  for (const OdometryConstraint& step : steps) {
    room.graph.AddRelativePose({step.from, step.to, step.from_from_to, covariance});
  }
  return room;
}

/// The defaults, with the shape terms that they leave out.
inline FactorOptions EveryTerm() {
  FactorOptions factors;
  factors.shape = true;
  return factors;
}

inline Associations AssociationsOf(const SlamGraph& graph, const MapState& state,
                                   double radius_m = 0.2) {
  ThreadPool pool(1);
  return BuildAssociations(graph, state, SurfaceOf(graph), AssociationOptions(), radius_m, &pool);
}

/// Mean distance [m] of the state's poses from the truth. The gauge is the first pose of both.
inline double MeanPoseError(const NoisyRoom& room) {
  double sum = 0.0;
  for (std::size_t i = 0; i < room.truth.size(); ++i) {
    const Pose2 pose = room.state.WorldFromRobot(static_cast<int>(i));
    sum += (pose.translation() - room.truth[i].translation()).norm();
  }
  return sum / room.truth.size();
}

/// What a summary says of a term.
inline TermSummary TermOfSummary(const SolverSummary& summary, const std::string& name) {
  for (const TermSummary& term : summary.terms) {
    if (term.name == name) return term;
  }
  ADD_FAILURE() << "there is no term " << name;
  return {};
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_SOLVERS_NOISY_ROOM_H_
