#ifndef PLUMBLINE_APPS_LIVE_ROS_VALUES_H_
#define PLUMBLINE_APPS_LIVE_ROS_VALUES_H_

#include <array>
#include <cstdint>

#include "plumbline/apps/io/occupancy_grid.h"

namespace plumbline {

/// The fields of a builtin_interfaces/Time.
struct RosTime {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};

/// A time [s], rounded to nanoseconds.
RosTime ToRosTime(double stamp_s);
double ToSeconds(const RosTime& time);

/// A cell of a nav_msgs/OccupancyGrid: 100 occupied, 0 free, -1 unknown.
std::int8_t ToRosCell(Occupancy occupancy);

/// The covariance of a geometry_msgs/PoseWithCovariance, row by row: of x, y, z [m^2] and roll,
/// pitch, yaw [rad^2]. It is not estimated: 0.05 m and 0.02 rad.
std::array<double, 36> RosPoseCovariance();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_ROS_VALUES_H_
