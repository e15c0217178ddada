#ifndef PLUMBLINE_TEST_APPS_ROOM_AS_G2O_H_
#define PLUMBLINE_TEST_APPS_ROOM_AS_G2O_H_

#include <sstream>
#include <string>
#include <vector>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {

/// x y yaw, each after a blank.
inline std::string Text(const Pose2& pose) {
  std::ostringstream text;
  text.precision(12);
  text << ' ' << pose.x << ' ' << pose.y << ' ' << pose.yaw;
  return text.str();
}

/// The room as another system would save it: poses off by a few centimetres, edges from each to the
/// next and from the last to the first, and every scan at its vertex.
inline std::string AsG2o(const NoisyRoom& room) {
  std::ostringstream text;
  const SlamGraph& graph = room.graph;
  const LaserModel& laser = graph.LaserOfScan(0);
  RandomStates random(21);
  const auto noise = [&](double sigma) {
    // One after the other: compilers differ in the order of arguments.
    const double yaw = random.Gaussian(sigma), y = random.Gaussian(sigma);
    return Pose2(random.Gaussian(sigma), y, yaw);
  };
  for (int i = 0; i < graph.num_poses(); ++i) {
    text << "VERTEX_SE2 " << 10 * i << Text(i == 0 ? room.truth[0] : room.truth[i] * noise(0.05))
         << "\nROBOTLASER1 0 " << laser.first_bearing_rad << " 6.28 " << laser.bearing_step_rad
         << " 80 0.01 0 " << laser.num_beams;
    for (const double range_m : graph.RangesOfScan(i, 80.0)) text << ' ' << range_m;
    text << " 0" << Text(room.truth[i] * laser.robot_from_laser) << Text(room.truth[i])
         << " 0 0 0 0 0 " << 100 + i << " host 0\n";
  }
  for (int i = 0; i < graph.num_poses(); ++i) {
    const int to = (i + 1) % graph.num_poses();
    const Pose2 motion = Between(room.truth[i], room.truth[to]) * noise(0.02);
    text << "EDGE_SE2 " << 10 * i << ' ' << 10 * to << Text(motion) << " 2500 0 0 2500 0 2500\n";
  }
  return text.str();
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_ROOM_AS_G2O_H_
