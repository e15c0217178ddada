#ifndef PLUMBLINE_APPS_IO_LOG_TO_GRAPH_H_
#define PLUMBLINE_APPS_IO_LOG_TO_GRAPH_H_

#include <functional>
#include <string>

#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Where the laser sits on the robot, as the two poses of each scan record tell.
struct LaserMounting {
  Pose2 robot_from_laser;  ///< component-wise median over the scans
  /// Largest deviation of a single scan from the median: rounding in a sane log. A log whose laser
  /// poses were replaced by another mapper's shows here.
  double max_deviation_m = 0.0;
  double max_deviation_rad = 0.0;

  /// What is wrong, in words, if scans deviate by more than the rounding of any logger (0.05 m or
  /// 0.05 rad); else empty.
  std::string Disagreement() const;
};

/// Needs at least one scan.
LaserMounting EstimateLaserMounting(const CarmenLog& log);

/// Turns the first `max_scans` scans of a log (0 = all) into a graph: one pose per scan at its
/// ipc_timestamp, placed by odometry with the first pose as the origin of the world; the scan;
/// and an odometry constraint from each pose to the next. One LaserModel per distinct geometry, all
/// mounted as EstimateLaserMounting says of the whole log.
///
/// Odometry that is the same for all scans of the log is none: the graph has no odometry
/// constraints then. If the two poses of the scans are the same as well, the laser sits as far
/// ahead as PARAM robot_frontlaser_offset says.
///
/// InvalidArgument if the log has no scans, max_scans is negative, or a scan is refused by the
/// graph (the message gives its line); `graph` is replaced on success only.
Status BuildGraph(const CarmenLog& log, int max_scans, SlamGraph* graph);

/// The same for a log that is of no more use: its readings are freed as the graph takes them over,
/// and `freed` is called now and then, when many have been.
Status BuildGraph(CarmenLog&& log, int max_scans, const std::function<void()>& freed,
                  SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_LOG_TO_GRAPH_H_
