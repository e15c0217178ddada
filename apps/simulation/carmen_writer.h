#ifndef PLUMBLINE_APPS_SIMULATION_CARMEN_WRITER_H_
#define PLUMBLINE_APPS_SIMULATION_CARMEN_WRITER_H_

#include <string>

#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Writes what the robot of a simulation reports as a log of the CARMEN toolkit, which
/// ReadCarmenLog describes: PARAM robot_frontlaser_offset and robot_front_laser_max, then an ODOM
/// and a laser record per scan. The laser record is FLASER if the beams lie as that record implies,
/// else ROBOTLASER1. Poses and times have 6 decimals, ranges 3.
///
/// Unavailable if the file cannot be written.
Status WriteCarmenLog(const std::string& path, const SimulatedLog& log);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_CARMEN_WRITER_H_
