// The messages of a robot in; its pose and the map out, while it drives.

#include <gflags/gflags.h>

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "plumbline/apps/dds/live_program.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/stop_signal.h"

DEFINE_string(scan_topic, plumbline::LiveProgramOptions().scan_topic,
              "Topic of the scans, sensor_msgs/LaserScan");
DEFINE_string(odom_topic, "",
              "Topic of the odometry, nav_msgs/Odometry; empty: the transforms from --odom_frame "
              "tell it");
DEFINE_string(tf_topic, plumbline::LiveProgramOptions().tf_topic,
              "Topic of the transforms; those that are static have _static behind it");
DEFINE_string(map_frame, plumbline::LiveProgramOptions().map_frame, "Frame of the map");
DEFINE_string(odom_frame, plumbline::LiveOptions().odom_frame, "Frame of the odometry");
DEFINE_string(base_frame, plumbline::LiveOptions().base_frame,
              "Frame of the robot, whose pose is published");
DEFINE_double(resolution, plumbline::LiveOptions().resolution_m,
              "Side of a cell of the occupancy grid [m]");
DEFINE_double(map_update_interval_s, plumbline::LiveSessionOptions().map_update_interval_s,
              "Time from one map to the next [s]");
DEFINE_double(transform_tolerance_s, plumbline::LiveProgramOptions().transform_tolerance_s,
              "How long the transform from map to odom stays valid after its scan [s]");
DEFINE_string(namespace, "",
              "Name space of the topics and services whose names have no leading slash");
DEFINE_int32(domain, -1, "Domain of DDS, 0 to 232; -1: that of ROS_DOMAIN_ID, or else 0");
DEFINE_string(network_interface, "",
              "Name or address of the network interface; empty: DDS chooses one");
DEFINE_bool(use_sim_time, false, "Diagnostics have the time of /clock");
DEFINE_bool(
    wait_for_background, false,
    "Take the next scan when all loops of the last one are closed: the same recording gives "
    "the same maps");
DEFINE_string(map, "", "Saved map, map.g2o, that the drive continues; empty: a new map");
DEFINE_bool(localize, false, "Localise the robot in --map, which stays as it is");
DEFINE_string(call, "",
              "Call a service of a program that runs, and end: save_map=FOLDER, localize=FILE, "
              "clear, pause, resume");
DEFINE_double(call_timeout_s, 10.0,
              "How long a program is looked for [s]; its answer may take ten times as long");

namespace plumbline {
namespace {

// A text that is no number becomes -1, which LiveConnection::Check refuses.
int DomainFromFlags() {
  if (FLAGS_domain >= 0) return FLAGS_domain;
  const char* given = std::getenv("ROS_DOMAIN_ID");  // NOLINT(concurrency-mt-unsafe)
  if (given == nullptr || *given == '\0') return 0;
  int domain = -1;
  const char* end = given + std::strlen(given);
  const auto parsed = std::from_chars(given, end, domain);
  return parsed.ec == std::errc() && parsed.ptr == end ? domain : -1;
}

const std::vector<FileFlag>& FileFlags() {
  static const std::vector<FileFlag> flags = {{"map", &FLAGS_map, FileUse::kInput}};
  return flags;
}

LiveProgramOptions OptionsFromFlags() {
  LiveProgramOptions options;
  options.connection = {DomainFromFlags(), FLAGS_network_interface, FLAGS_namespace};
  options.scan_topic = FLAGS_scan_topic;
  options.odom_topic = FLAGS_odom_topic;
  options.tf_topic = FLAGS_tf_topic;
  options.map_frame = FLAGS_map_frame;
  options.session.node.odom_frame = FLAGS_odom_frame;
  options.session.node.base_frame = FLAGS_base_frame;
  options.session.node.odometry_by_messages = !FLAGS_odom_topic.empty();
  options.session.node.resolution_m = FLAGS_resolution;
  options.session.node.wait_for_background = FLAGS_wait_for_background;
  options.session.map_update_interval_s = FLAGS_map_update_interval_s;
  options.transform_tolerance_s = FLAGS_transform_tolerance_s;
  options.use_sim_time = FLAGS_use_sim_time;
  options.session.map_file = FLAGS_map;
  options.session.localize = FLAGS_localize;
  return options;
}

Status CheckFlags() {
  std::string error;
  if (!OptionsFromFlags().Check(&error)) return Status::InvalidArgument(error);
  if (!(FLAGS_call_timeout_s > 0.0 && FLAGS_call_timeout_s <= 3600.0)) {
    return Status::InvalidArgument("--call_timeout_s must be above 0 and at most 3600");
  }
  if (FLAGS_localize && FLAGS_map.empty()) {
    return Status::InvalidArgument("--localize needs a --map");
  }
  return FLAGS_call.empty() ? Status::Ok() : CheckCall(FLAGS_call);
}

// The program that is called may run in another folder.
std::string WithAbsolutePath(const std::string& call) {
  const std::size_t equals = call.find('=');
  if (equals == call.npos) return call;
  return call.substr(0, equals + 1) + std::filesystem::absolute(call.substr(equals + 1)).string();
}

Status Run() {
  const LiveProgramOptions options = OptionsFromFlags();
  if (!FLAGS_call.empty()) {
    return CallLive(options.connection, WithAbsolutePath(FLAGS_call), FLAGS_call_timeout_s);
  }
  KeepStopSignal();
  return RunLive(options, [] { return StopSignal() != 0; });
}

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  plumbline::StartProgram(
      "Maps a drive of a ROS 2 robot while it goes on. Needs no ROS: it reads scans and transforms "
      "from DDS.\n\n"
      "  plumbline_live --scan_topic=/scan --base_frame=base_footprint\n"
      "  plumbline_live --call=save_map=maps/monday\n\n"
      "apps/live/README.md lists topics, frames and services.",
      argc, argv);
  return plumbline::RunProgram(plumbline::FileFlags(), plumbline::CheckFlags, plumbline::Run);
}
