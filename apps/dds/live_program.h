#ifndef PLUMBLINE_APPS_DDS_LIVE_PROGRAM_H_
#define PLUMBLINE_APPS_DDS_LIVE_PROGRAM_H_

#include <functional>
#include <string>

#include "plumbline/apps/live/live_session.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Where a live program finds a robot.
struct LiveConnection {
  int domain = 0;                 ///< of DDS, 0 to 232
  std::string network_interface;  ///< see DdsNode::Join
  std::string ros_namespace;      ///< of topics and services whose name has no leading slash

  bool Check(std::string* error) const;
  /// The absolute name of a topic or service.
  std::string Absolute(const std::string& name) const;
};

struct LiveProgramOptions {
  LiveConnection connection;
  LiveSessionOptions session;
  std::string scan_topic = "scan";
  std::string odom_topic;        ///< of nav_msgs/Odometry; empty: the transforms tell the odometry
  std::string tf_topic = "/tf";  ///< that of static transforms has "_static" behind it
  std::string map_frame = "map";
  double transform_tolerance_s = 0.2;  ///< how long a transform stays valid after its scan [s]
  bool use_sim_time = false;           ///< the time is that of /clock

  bool Check(std::string* error) const;
};

/// Maps a live drive until `is_stopped`: reads scans, odometry and transforms from DDS, and writes
/// the transform from map to odom, the pose, the map, the path and diagnostics. Prints faults when
/// they first occur on standard error. Fails like ReadSavedMap; Unavailable if DDS refuses.
Status RunLive(const LiveProgramOptions& options, const std::function<bool()>& is_stopped);

/// InvalidArgument if a call, "save_map=FOLDER" or "clear", names no service or lacks its value.
Status CheckCall(const std::string& call);

/// Calls a service of a live program and prints its answer. timeout_s: for the program to be found,
/// and ten times as long for its answer [s]. Fails like CheckCall; Unavailable if there is no
/// answer or the service has failed.
Status CallLive(const LiveConnection& connection, const std::string& call, double timeout_s);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_DDS_LIVE_PROGRAM_H_
