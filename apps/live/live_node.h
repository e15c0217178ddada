#ifndef PLUMBLINE_APPS_LIVE_LIVE_NODE_H_
#define PLUMBLINE_APPS_LIVE_LIVE_NODE_H_

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/apps/live/live_map.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/online_mapper.h"

namespace plumbline {

/// How a live node maps.
struct LiveOptions {
  std::string odom_frame = "odom";       ///< as odometry messages name it, if there are any
  std::string base_frame = "base_link";  ///< whose pose is given
  /// Odometry messages tell how the robot moves; otherwise the transforms from odom_frame do.
  bool odometry_by_messages = false;
  double resolution_m = 0.05;  ///< of the occupancy grid
  /// Scans that come sooner after the one before are left out [s].
  double min_interval_s = 0.015;
  /// After each scan, Work waits until the background has caught up. The same messages then give
  /// the same maps, but poses may come late: for recorded drives.
  bool wait_for_background = false;
  OnlineMapperOptions mapper;

  /// False if a field is out of range; *error, if not null, then says which and why.
  bool Check(std::string* error) const;
};

/// What a scan says about the pose of the robot.
struct LiveUpdate {
  double stamp_s = 0.0;     ///< of the scan
  std::string child_frame;  ///< the odometry's frame, or the robot's frame if there is no odometry
  Pose2 map_from_child;
  Pose2 map_from_base;  ///< of LiveOptions::base_frame, if its place on the robot is known
};

/// What a live node has to report of itself.
struct LiveReport {
  std::string state;                          ///< "waiting for scans", "mapping", "paused", ...
  std::size_t num_received = 0;               ///< scans, whether or not they were of use
  std::size_t num_mapped = 0;                 ///< since the map was begun
  std::size_t num_resting = 0;                ///< left out since the robot stood still
  std::map<std::string, std::size_t> faults;  ///< by kind
};

/// The map of a drive as plumbline_slam makes it.
struct MappedDrive {
  LogMapping mapping;
  bool continues_map = false;  ///< the scans of a saved map come first
};

/// A live drive without any transport: takes the messages of a robot, and gives its poses and map.
///
/// Scans wait for the transforms of the laser (3 s at the start), and for odometry of their time
/// (0.2 s). Without odometry the scans alone tell the motion. While the odometry says that the
/// robot stands still, one scan per second is mapped. At most 200 scans wait; the oldest is then
/// left out. Messages of no use are left out, told once per kind, and counted:
/// - scans that are no sweep (ScanFault), of another frame than the first one, older than the one
///   before by up to 0.5 s, or sooner than min_interval_s after it;
/// - transforms and odometry that are no pose.
/// A clock that goes back by more than 0.5 s is told; the next scan goes without odometry. A scan
/// with other beams than the first one is resampled to those.
///
/// Messages and commands may come from any thread, Work and BuildMap from one thread each.
class LiveNode {
 public:
  explicit LiveNode(const LiveOptions& options);
  ~LiveNode();
  LiveNode(const LiveNode&) = delete;
  LiveNode& operator=(const LiveNode&) = delete;

  /// Each takes a message. now_s: by any clock that never goes back [s], as in Work.
  void AddScan(RosScan scan, double now_s);
  void AddOdometry(const RosOdometry& odometry);
  void AddTransforms(const std::vector<RosTransform>& transforms);
  /// Counts a fault of the transport; see FaultLog::Add.
  void AddFault(const std::string& kind, const std::string& detail);

  /// Maps the scans that can be mapped now, and appends an update for each, also for a scan that
  /// is left out because the robot stands still.
  void Work(double now_s, std::vector<LiveUpdate>* updates);

  /// Builds the map of all scans so far; the drive goes on meanwhile. InvalidArgument without
  /// scans.
  Status BuildMap(LiveMap* map);

  /// Maps all scans so far as plumbline_slam does, in the calling thread; the drive goes on
  /// meanwhile. A drive that continues a saved map is mapped with it, if the two could be tied to
  /// each other. Fails like OnlineMapper::MapNow; InvalidArgument without scans and in a fixed map.
  Status MapNow(MappedDrive* drive);

  /// Forgets the map. The next scan begins a new one.
  void Clear();
  /// Forgets the map. The next scan begins a drive in a saved map: it continues it, or is localised
  /// in it if all of its poses are fixed. Updates begin when the place in the map is known.
  void UseMap(SlamGraph map);
  /// Leaves all scans out until it is resumed.
  void Pause(bool paused);

  LiveReport Report() const;
  /// Lines for people that are new since the last call: faults when they first occur, and notes.
  std::vector<std::string> TakeNews();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_LIVE_NODE_H_
