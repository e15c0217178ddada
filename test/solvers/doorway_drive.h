#ifndef PLUMBLINE_TEST_SOLVERS_DOORWAY_DRIVE_H_
#define PLUMBLINE_TEST_SOLVERS_DOORWAY_DRIVE_H_

#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {

/// A drive there and back in a corridor along x, 30 m long. Its ends are too far off to see; frames
/// of doors stand out from its walls by 25 cm.
struct DoorwayDrive {
  static constexpr int kNumPoses = 120;

  SlamGraph graph;                     ///< initial guesses at the true poses, no odometry
  std::vector<Pose2> odometry, poses;  ///< without errors

  /// Puts poses first to last beside where they belong.
  void Misplace(int first, int last, double along_m) {
    for (int p = first; p <= last; ++p) poses[p] = poses[p] * Pose2(along_m, 0.0, 0.0);
  }
};

inline DoorwayDrive DriveAlongDoors(const std::vector<double>& frames_x) {
  SyntheticScene scene;
  scene.faces = Rectangle({-15.0, -1.0}, {15.0, 1.0});
  for (const double x : frames_x) {
    for (const double side : {-1.0, 1.0}) {
      scene.faces.push_back({{x, side}, {x, 0.75 * side}});
      scene.faces.push_back({{x, 0.75 * side}, {x + 0.2, 0.75 * side}});
      scene.faces.push_back({{x + 0.2, 0.75 * side}, {x + 0.2, side}});
    }
  }
  scene.laser.max_range_m = 5.0;
  scene.range_sigma_m = 0.01;
  for (int i = 0; i < DoorwayDrive::kNumPoses; ++i) {
    const int there = i < DoorwayDrive::kNumPoses / 2 ? i : DoorwayDrive::kNumPoses - 1 - i;
    scene.poses.emplace_back(0.15 * there - 4.5, 0.0, i < DoorwayDrive::kNumPoses / 2 ? 0.0 : kPi);
  }
  DoorwayDrive drive;
  drive.graph = MakeGraph(scene);
  drive.poses = scene.poses;
  drive.odometry.emplace_back();
  for (int i = 1; i < DoorwayDrive::kNumPoses; ++i) {
    drive.odometry.push_back(Between(scene.poses[i - 1], scene.poses[i]));
  }
  return drive;
}

/// Along doors at irregular distances.
inline DoorwayDrive DriveAlongDoors() {
  return DriveAlongDoors({-8.1, -5.2, -3.4, -0.3, 1.9, 3.1, 6.2, 8.3});
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_SOLVERS_DOORWAY_DRIVE_H_
