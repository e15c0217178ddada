#ifndef PLUMBLINE_SOLVERS_ONLINE_MAPPER_H_
#define PLUMBLINE_SOLVERS_ONLINE_MAPPER_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/core/laser_scan.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/alarm.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

struct SessionsMapping;

/// How a drive is mapped while it goes on.
struct OnlineMapperOptions {
  /// How Finish maps the whole drive. The background has the same options, but for calibration,
  /// edges that are named, and the callback.
  MapLogOptions map;
  /// Whether all scans are kept for Finish and MapNow. Without, a drive that is localised in a
  /// fixed map keeps the scans of its last 100 m at most, and of older ones the poses.
  bool keeps_scans = true;
  /// Step [m] from one scan to the next that become poses of the map, at least, or a turn of as
  /// many radians; other scans are matched, and have poses, but the map knows nothing of them. From
  /// 0 to 1; 0: all scans become poses. Anything more leaves out scans of a robot that stands.
  double min_step_m = 0.0;

  /// False if a field is out of range; *error, if not null, then says which and why.
  bool Check(std::string* error) const;
};

/// A finished map that a drive begins in.
struct SavedMap {
  /// As MapSessions takes a session. If all of its poses are fixed (SlamGraph::FixPose), the drive
  /// is localised in it. If none is, the drive continues the map: its initial guesses are its poses
  /// while the robot drives, and Finish estimates them anew.
  SlamGraph graph;
  /// Where the robot is at the first scan, give or take 0.5 m and 0.15 rad; none: nobody knows.
  std::optional<Pose2> map_from_robot;
};

/// Where the robot is. The frame of the map is that of the saved map, or else that of the robot at
/// its first scan.
struct OnlinePose {
  int scan = 0;  ///< index among all scans that were added
  /// Whether the place in the saved map is known, and the scan matches earlier ones; true
  /// without a saved map. If the place is not known yet, the pose is in the frame of the robot at
  /// its first scan. If it is not known any more, the pose follows the last known one.
  bool is_in_map = true;
  Pose2 map_from_robot;     ///< at the time of the scan
  Pose2 map_from_odometry;  ///< frame of the odometry; as before if the scan has no odometry
  /// Number of scans in which loops have not been sought yet.
  int num_pending = 0;
};

/// The map of a drive that goes on, by all loops that were closed so far.
struct OnlineMap {
  bool is_in_map = true;                ///< whether the place in the saved map is known
  std::vector<Pose2> map_from_robot;    ///< per scan that was added
  std::vector<Eigen::Vector2d> points;  ///< of the keyframes' surfaces, thinned to 3 cm [m]
  Pose2 map_from_odometry;              ///< as in OnlinePose, at the newest scan
  int num_closures = 0;                 ///< in force
  int num_remappings = 0;               ///< of the drive so far, in the background
  /// Of the last one. Scans are counted without those that min_step_m leaves out.
  std::vector<Alarm> alarms;
};

/// Maps a drive while it goes on. Scans come in one at a time; AddScan matches each of them to the
/// scans before it and gives its pose at once. A background thread closes loops from the newest
/// keyframes. A second one maps the drive so far from its start, as MapLog does but without
/// calibration, each time that the drive has grown by a quarter, or by a tenth while the map is in
/// doubt (a loop has moved it by more than 0.5 m, a scan matched nothing, or the last such map has
/// an alarm). That recognises odometry without sign or scale, slips and relocations, and takes
/// false loops back. Such a map is taken over unless it has an alarm and its scans contradict each
/// other more than in the map at hand. Corrections are in the poses from then on. Finish
/// gives what MapLog gives of the same measurements.
///
/// In a saved map the background seeks the place of the drive, unless it is given, by the search of
/// MapSessions and with its rules of when a place is certain. It then closes loops with the saved
/// map, whose poses stay where they are while the robot drives. In a fixed map the place counts as
/// lost after a scan that matches nothing and after 10 m of path in which nothing of the map is
/// recognised; it is then sought by the scans that follow. Drives are mapped anew in the background
/// for the alarms and the faults of the odometry alone if they continue a map, and not at all in a
/// fixed one.
///
/// The motion within the sweeps of a laser (LaserModel::beam_period_s) is taken out by Finish and
/// by the maps of the background, not by the live matching.
///
/// All functions may be called from any thread. The order of concurrent calls of AddScan is that of
/// the scans.
class OnlineMapper {
 public:
  /// Bad options and lasers are reported by the first scan.
  explicit OnlineMapper(const std::vector<LaserModel>& lasers,
                        const OnlineMapperOptions& options = OnlineMapperOptions());
  /// A map whose poses are fixed in part, or that has no scans, is reported by the first scan, too.
  OnlineMapper(const std::vector<LaserModel>& lasers, const OnlineMapperOptions& options,
               SavedMap map);
  /// Stops the background.
  ~OnlineMapper();
  OnlineMapper(const OnlineMapper&) = delete;
  OnlineMapper& operator=(const OnlineMapper&) = delete;

  /// Matches a scan, and gives its pose in the map. scan: ranges [m], one per beam. odometry: pose
  /// of the robot at that time by its wheels, in any fixed frame; none if it is not known. Without
  /// it the step is predicted from the steps before it. laser: index of the laser that measured the
  /// scan. now: may be null.
  ///
  /// InvalidArgument, naming the scan, on bad options, an unknown laser, a number of ranges other
  /// than its beams, values that are not finite or beyond input_limits.h (ranges excepted: these
  /// are no returns), a time before that of the scan before, and odometry that jumps: by more than
  /// 5 m and 20 m/s. Nothing has changed then; a scan after a jump, or a reset of the odometry, is
  /// to be added without odometry once. InvalidArgument after Finish. Unavailable if the background
  /// has failed.
  Status AddScan(const LaserScan& scan, const std::optional<Pose2>& odometry, OnlinePose* now,
                 int laser = 0);

  /// The map as it is known now. InvalidArgument on null.
  Status GetMap(OnlineMap* map) const;

  /// Waits until the background has caught up with all scans. If it is called after each scan,
  /// poses and maps are the same each time. Unavailable if the background has failed.
  Status Wait();

  /// Maps the measurements so far by MapLog, in the calling thread: what Finish would give now. The
  /// drive goes on meanwhile, and nothing of it changes. Fails like Finish.
  Status MapNow(LogMapping* mapping) const;
  /// The same with the saved map, by MapSessions (map_sessions.h).
  Status MapNow(SessionsMapping* mapping) const;

  /// Ends the drive: stops the background and maps all scans that became poses (min_step_m)
  /// by MapLog, with the same result for the same scans, whatever the background had found. Fails
  /// like MapLog; InvalidArgument without scans, if it was called before, and if scans were not
  /// kept. A saved map has no part in it.
  Status Finish(LogMapping* mapping);
  /// Ends the drive, and maps the saved map and the drive, in this order, by MapSessions.
  /// InvalidArgument also without a saved map.
  Status Finish(SessionsMapping* mapping);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ONLINE_MAPPER_H_
