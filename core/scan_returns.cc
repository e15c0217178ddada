#include "plumbline/core/scan_returns.h"

#include "plumbline/core/float_environment.h"

namespace plumbline {

LaserBeams::LaserBeams(const LaserModel& laser) : model(laser) {
  const DefaultFloatEnvironment float_environment;
  const PoseFrame mounting(laser.robot_from_laser);
  directions.reserve(laser.num_beams);
  directions_in_robot.reserve(laser.num_beams);
  for (int beam = 0; beam < laser.num_beams; ++beam) {
    directions.push_back(BeamEnd(1.0, laser.Bearing(beam)));
    directions_in_robot.push_back(mounting.Rotate(directions.back()));
  }
}

}  // namespace plumbline
