#ifndef PLUMBLINE_TEST_CORE_SYNTHETIC_SCENE_H_
#define PLUMBLINE_TEST_CORE_SYNTHETIC_SCENE_H_

#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

#include "plumbline/apps/simulation/world.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// A laser that looks all around, counter-clockwise from straight behind.
inline LaserModel PanoramicLaser(int num_beams) {
  LaserModel laser;
  laser.num_beams = num_beams;
  laser.first_bearing_rad = -kPi;
  laser.bearing_step_rad = 2.0 * kPi / num_beams;
  return laser;
}

/// Walls, and a robot that looks around from several places. World frame.
struct SyntheticScene {
  std::vector<Face> faces;
  std::vector<Disc> discs;
  std::vector<Pose2> poses;  ///< world_from_robot, one scan from each
  LaserModel laser = PanoramicLaser(720);
  double range_sigma_m = 0.0;
};

/// The graph of a scene: initial guesses at the true poses, and returns where the beams meet the
/// walls, give or take the noise of the ranges.
inline SlamGraph MakeGraph(const SyntheticScene& scene, unsigned seed = 1) {
  Building building;
  building.faces = scene.faces;
  building.discs = scene.discs;
  const World world(std::move(building));
  std::mt19937 engine(seed);
  std::normal_distribution<double> gaussian;
  SlamGraph graph;
  const int laser_id = graph.AddLaser(scene.laser);
  for (const Pose2& pose : scene.poses) {
    const int pose_id = graph.AddPose(pose, static_cast<double>(graph.num_poses()));
    const Pose2 world_from_laser = pose * scene.laser.robot_from_laser;
    std::vector<double> ranges;
    for (int beam = 0; beam < scene.laser.num_beams; ++beam) {
      const double bearing = world_from_laser.yaw + scene.laser.Bearing(beam);
      ranges.push_back(world.CastRay(world_from_laser.translation(), bearing) +
                       scene.range_sigma_m * gaussian(engine));
    }
    graph.AddScan(pose_id, laser_id, ranges);
  }
  return graph;
}

inline MeasuredSurface SurfaceOf(const SlamGraph& graph) {
  ThreadPool pool(1);
  return MeasureSurface(graph, ReturnNormalOptions(), &pool);
}

inline Eigen::Vector2d MapPoint(const MapState& state, std::size_t return_id) {
  return {state.points[2 * return_id], state.points[2 * return_id + 1]};
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_CORE_SYNTHETIC_SCENE_H_
