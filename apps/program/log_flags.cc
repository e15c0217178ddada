#include "plumbline/apps/program/log_flags.h"

#include <gflags/gflags.h>

#include <locale>
#include <sstream>

#include "plumbline/core/angle.h"

DEFINE_string(
    scan_topic, "",
    "ROS bag: topic of the laser (empty: the only sensor_msgs/LaserScan, or else the only "
    "MultiEchoLaserScan, or else the only PointCloud2)");
DEFINE_string(
    echo, "first",
    "ROS bag with a MultiEchoLaserScan: which echo of a beam to take, first or strongest");
DEFINE_string(slice_height_m, "",
              "ROS bag with a PointCloud2 of a 3D laser: LOW,HIGH, heights [m] in the frame of the "
              "cloud between which points are taken for a scan (empty: the laser is planar)");
DEFINE_string(
    odom_topic, "",
    "ROS bag: topic of the odometry (empty: the only nav_msgs/Odometry, or the transforms "
    "if there is none, or the scans alone; /tf: the transforms)");
DEFINE_string(odom_frame, plumbline::BagReadOptions().odom_frame,
              "ROS bag: frame of the odometry in the transforms");

DEFINE_string(laser_frame, "",
              "ROS bag: frame of the laser, where several share the topic (empty: the only one)");
DEFINE_string(clock, "auto",
              "ROS bag: times of the messages: header (their stamps), record (the times of "
              "recording), or auto (record where the stamps are useless)");
DEFINE_string(beam_direction, "stated",
              "Side from which the beams are counted: stated (as the log says), reversed (from the "
              "other end of the fan), or upside_down (mirrored about the laser's forward axis)");
DEFINE_double(fov_deg, 0.0,
              "CARMEN log: angle from the first beam of FLASER records to the last [deg]; 0: 270 "
              "for 541 and 1081 beams, 180 for others");

DEFINE_double(sweep_time_s, -1.0,
              "Time that the laser takes from the first beam of a sweep to the last [s]; 0: all "
              "beams at once; negative: what the scans of a bag say, 0 for other logs");

namespace {

bool IsEcho(const char* /*flag*/, const std::string& echo) {
  return echo == "first" || echo == "strongest";
}

// Empty if the text is not two numbers with a comma between them, the lower one first.
std::optional<plumbline::HeightBand> BandOf(const std::string& text) {
  std::istringstream numbers(text);
  numbers.imbue(std::locale::classic());
  plumbline::HeightBand band;
  char comma = 0;
  numbers >> band.low_m >> comma >> band.high_m;
  const bool is_whole = !numbers.fail() && comma == ',' && (numbers >> std::ws).eof();
  return is_whole && band.Check(nullptr) ? std::optional(band) : std::nullopt;
}

bool IsBand(const char* /*flag*/, const std::string& text) {
  return text.empty() || BandOf(text).has_value();
}

// A laser that takes longer is none that sweeps.
bool IsSweepTime(const char* /*flag*/, double sweep_time_s) { return sweep_time_s <= 60.0; }

bool IsFieldOfView(const char* /*flag*/, double fov_deg) {
  return fov_deg >= 0.0 && fov_deg <= 360.0;
}

bool IsClock(const char* /*flag*/, const std::string& name) {
  plumbline::RosClock clock;
  return plumbline::FromString(name, &clock);
}

bool IsBeamDirection(const char* /*flag*/, const std::string& name) {
  plumbline::BeamDirection direction;
  return plumbline::FromString(name, &direction);
}

}  // namespace

DEFINE_validator(echo, &IsEcho);
DEFINE_validator(slice_height_m, &IsBand);
DEFINE_validator(clock, &IsClock);
DEFINE_validator(beam_direction, &IsBeamDirection);
DEFINE_validator(fov_deg, &IsFieldOfView);
DEFINE_validator(sweep_time_s, &IsSweepTime);

namespace plumbline {

LogReadOptions LogReadOptionsFromFlags() {
  LogReadOptions options;
  options.bag.scan_topic = FLAGS_scan_topic;
  options.bag.echo = FLAGS_echo == "strongest" ? RosEcho::kStrongest : RosEcho::kFirst;
  if (!FLAGS_slice_height_m.empty()) options.bag.slice_height_m = BandOf(FLAGS_slice_height_m);
  options.bag.odom_topic = FLAGS_odom_topic;
  options.bag.odom_frame = FLAGS_odom_frame;
  options.bag.needs_odometry = !gflags::GetCommandLineFlagInfoOrDie("odom_frame").is_default;
  options.laser_frame = FLAGS_laser_frame;
  options.sweep_time_s = SweepTimeFromFlags();
  if (FLAGS_fov_deg > 0.0) options.flaser_fov_rad = DegToRad(FLAGS_fov_deg);
  FromString(FLAGS_clock, &options.clock);
  FromString(FLAGS_beam_direction, &options.beam_direction);
  return options;
}

std::optional<double> SweepTimeFromFlags() {
  return FLAGS_sweep_time_s < 0.0 ? std::nullopt : std::optional<double>(FLAGS_sweep_time_s);
}

}  // namespace plumbline
