#ifndef PLUMBLINE_APPS_IO_ROBOT_LASER_RECORD_H_
#define PLUMBLINE_APPS_IO_ROBOT_LASER_RECORD_H_

#include <string>

#include "plumbline/apps/io/carmen_log.h"

namespace plumbline {

/// The scan as a ROBOTLASER1 record (carmen_log.h has the fields), without line end. Its numbers
/// give the same doubles when read. What a CarmenScan does not tell is 0: laser_type, accuracy,
/// remissions, velocities and safety distances. Needs beams with a step and a maximum range above
/// zero.
std::string RobotLaserRecord(const CarmenScan& scan);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROBOT_LASER_RECORD_H_
