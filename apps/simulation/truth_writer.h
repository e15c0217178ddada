#ifndef PLUMBLINE_APPS_SIMULATION_TRUTH_WRITER_H_
#define PLUMBLINE_APPS_SIMULATION_TRUTH_WRITER_H_

#include <string>

#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Writes the true pose of the robot at each scan, as WriteTumTrajectory does.
/// Unavailable if the file cannot be written.
Status WriteTrueTrajectory(const std::string& path, const SimulatedLog& log);

/// Writes one line `t beam x y` per return: the scan's time [s] with 6 decimals, the index of the
/// beam from 0, and the point [m] that it measured, in the world frame of the true trajectory.
/// Beams whose hit is NaN have no line. Unavailable if the file cannot be written.
Status WriteTrueHits(const std::string& path, const SimulatedLog& log);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_TRUTH_WRITER_H_
