#ifndef PLUMBLINE_APPS_IO_ROS_RECORDING_H_
#define PLUMBLINE_APPS_IO_ROS_RECORDING_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/io/transform_tree.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What a sensor_msgs/LaserScan says: see its definition for units and conventions.
struct RosScan {
  double stamp_s = 0.0;
  std::string frame;
  double angle_min_rad = 0.0;
  double angle_increment_rad = 0.0;
  double time_increment_s = 0.0;
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  std::vector<double> ranges;
  /// Directions of the ranges, for returns in any order, as in a point cloud. angle_min_rad and
  /// angle_increment_rad then define a full circle of beams that tells which returns are
  /// neighbours. Empty: range i is that of beam i.
  std::vector<double> bearings_rad;
};

/// What a robot with ROS recorded of a drive, without any dependence on ROS. Frames have no leading
/// slash; messages are in the order of the recording.
struct RosRecording {
  std::string path;        ///< to name in errors
  std::string omission;    ///< of a part that could not be read, for people; empty: none
  std::string scan_topic;  ///< to name in errors
  std::vector<RosScan> scans;

  std::string odom_topic;  ///< empty: the transforms tell the odometry
  /// The frame that odometry moves in: of the messages, or to look for in the transforms.
  std::string odom_frame = "odom";
  std::string robot_frame;          ///< of the odometry messages; empty where they do not say
  std::vector<TimedPose> odometry;  ///< world_from_robot: pose in the odometry's frame
  bool needs_odometry = false;      ///< somebody asked for this odometry: without it is an error

  TransformTree transforms;
};

/// How errors begin that concern a message: "/scan message 17 (1234.500000 s): ", counted from 0.
std::string RosMessageName(const std::string& topic, std::size_t index, double stamp_s);

struct RosGraphOptions {
  /// A scan takes its place from the odometry before and after it, if these are no further apart
  /// than this [s]. A clock that goes back by more than this is an error.
  double max_gap_s = 0.5;
  /// From the first beam of a sweep to the last [s]; empty: what the messages say.
  std::optional<double> sweep_time_s;

  bool Check(std::string* error) const;
};

/// What did not fit, in words for a user.
struct RosGraphNotes {
  std::vector<std::string> warnings;
  std::vector<std::string> skipped_scans;  ///< the first 10 of them
  std::size_t num_skipped_scans = 0;       ///< those without odometry around them
  std::size_t num_out_of_order = 0;        ///< scans and odometry older than the one before
};

/// Turns the first `max_scans` scans that have odometry (0 = all) into a graph: one pose per scan
/// at its stamp, placed by odometry with the first pose as the origin of the world; the scan; and
/// an odometry constraint from each pose to the next.
///
/// Without odometry, or with one that never changes, every scan becomes a pose at the origin, and
/// there are no odometry constraints. The robot is then the highest frame above the laser that the
/// laser does not move in, such as base_link, or else the laser itself.
///
/// Robot: the frame that the odometry moves, which is the one below `odom_frame` on the way to the
/// laser where the transforms tell the odometry. Mounting: the transform from the robot to the
/// laser; without one the laser is taken to sit at the robot's centre, with a warning. A laser
/// that hangs upside down is told by its transform: its bearings run the other way round.
///
/// Beams are time_increment apart, the first one at the stamp: the median over the scans, since
/// some drivers measure it anew each time. Where that makes no sweep of up to a second, the sweep
/// is taken as one instant. Readings that are not finite, below range_min (or 0.05 m), or at
/// range_max or above are no returns; range_max counts as one since many drivers clip there.
///
/// InvalidArgument, naming file, topic, message (from 0), stamp and field, on scans that are no
/// sweep of a laser, several laser frames, odometry that was asked for and is not there, a laser
/// that is tilted or moves on the robot, a clock that jumps back or is useless (see ClockFault),
/// negative max_scans; and if no scan has odometry around it. Outputs are replaced on success only.
Status BuildGraph(const RosRecording& recording, const RosGraphOptions& options, int max_scans,
                  RosGraphNotes* notes, SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROS_RECORDING_H_
