#ifndef PLUMBLINE_APPS_IO_ROS_RECORDING_H_
#define PLUMBLINE_APPS_IO_ROS_RECORDING_H_

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/io/bad_records.h"
#include "plumbline/apps/io/beam_direction.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/io/transform_tree.h"
#include "plumbline/apps/io/warning.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What a sensor_msgs/LaserScan says: see its definition for units and conventions.
struct RosScan {
  double stamp_s = 0.0;
  std::string frame;
  double angle_min_rad = 0.0;
  double angle_max_rad = std::numeric_limits<double>::quiet_NaN();
  double angle_increment_rad = 0.0;
  double time_increment_s = 0.0;
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  std::vector<double> ranges;
  /// Directions of the ranges, for returns in any order, as in a point cloud. angle_min_rad and
  /// angle_increment_rad then define a full circle of beams that tells which returns are
  /// neighbours. Empty: range i is that of beam i.
  std::vector<double> bearings_rad;
  double received_s = 0.0;  ///< by the clock of the recorder [s]; 0: unknown
  std::string fault;        ///< why the message cannot be decoded; empty if it can be
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
  std::string robot_frame;                  ///< of the odometry messages; empty where unstated
  std::vector<TimedPose> odometry;          ///< world_from_robot: pose in the odometry's frame
  std::vector<double> odometry_received_s;  ///< as RosScan::received_s, per pose; may be empty
  bool needs_odometry = false;  ///< somebody asked for this odometry: without it is an error

  TransformTree transforms;

  BadRecords bad_odometry;    ///< messages on odom_topic that are no odometry
  BadRecords bad_transforms;  ///< messages of transforms that cannot be decoded
  std::size_t num_transform_messages = 0;
};

/// How errors begin that concern a message: "/scan message 17 (1234.500000 s): ", counted from 0.
std::string RosMessageName(const std::string& topic, std::size_t index, double stamp_s);

/// The times by which messages are related to each other.
enum class RosClock {
  kAuto,    ///< kHeader, or kRecord where the stamps of the headers are useless
  kHeader,  ///< the stamps of the messages' headers
  kRecord,  ///< the times at which the messages were recorded
};
bool FromString(const std::string& name, RosClock* clock);

/// The source of the beams' bearings in a scan whose fields contradict each other.
enum class BeamAngleSource { kAngleMax, kIncrement };

struct RosGraphOptions {
  /// A scan takes its place from the odometry before and after it, if these are no further apart
  /// than this [s]. A clock that goes back by more than this is an error.
  double max_gap_s = 0.5;
  /// From the first beam of a sweep to the last [s]; empty: what the messages say.
  std::optional<double> sweep_time_s;
  /// The laser to use where several share the topic; empty: the only one.
  std::string laser_frame;
  RosClock clock = RosClock::kAuto;
  BeamAngleSource angle_source = BeamAngleSource::kAngleMax;
  BeamDirection beam_direction = BeamDirection::kStated;

  bool Check(std::string* error) const;
};

/// Messages about a recording.
struct RosGraphNotes {
  std::vector<Warning> warnings;
  std::vector<std::string> skipped_scans;  ///< the first 10 of them
  std::size_t num_skipped_scans = 0;
  std::size_t num_out_of_order = 0;  ///< scans and odometry older than the one before
  /// The fields of the scans contradict each other about the beams' bearings.
  bool angles_contradict = false;
  std::optional<double> no_return_level_m;  ///< see FindNoReturnLevel
};

/// Turns the first `max_scans` scans of a recording (0 = all) into a graph: one pose per scan at
/// its stamp, placed by odometry with the first pose as the origin of the world; the scan; and an
/// odometry constraint from each pose to the next.
///
/// Odometry: interpolated between messages up to max_gap_s apart. Scans without are skipped if they
/// are at most 2 % of all. If they are more, messages may be up to 5 s apart as long as the robot
/// moves by less than 2 m and 60 deg from one to the other; all other scans keep the pose of the
/// message nearest in time, and the steps to and from them count as not measured. A warning gives
/// the share. Without odometry, or with one that never changes, every scan becomes a pose at the
/// origin, and there are no odometry constraints. The robot is then the highest frame above the
/// laser that the laser does not move in, such as base_link, or else the laser itself.
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
/// Readings from FindNoReturnLevel on are no returns, either. A range_max that is 0 or NaN in all
/// scans is not stated. Bearings: from angle_min in steps of angle_increment. Where that does not
/// lead to angle_max, options.angle_source decides, with a warning.
///
/// Single bad messages are skipped and counted by kind, up to the number that BadRecordLimits allow
/// and half of all: scans that are no sweep of a laser, that another laser has sent, whose stamp
/// does not fit, or in which the laser is tilted or has moved on the robot; odometry that is no
/// pose. A scan with the stamp and the readings of the one before is dropped.
///
/// InvalidArgument, naming file, topic, message (from 0), stamp and field, on more bad messages,
/// on several laser frames, odometry that was asked for and is not there, a clock that jumps back
/// or is useless (see ClockFault), negative max_scans; and if no scan lies within the time of the
/// odometry. Outputs are replaced on success only.
Status BuildGraph(const RosRecording& recording, const RosGraphOptions& options, int max_scans,
                  RosGraphNotes* notes, SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROS_RECORDING_H_
