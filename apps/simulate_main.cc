// Simulates a robot with a laser scanner in a building: writes its log and the truth about it.

#include <gflags/gflags.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iomanip>
#include <iostream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/building_reader.h"
#include "plumbline/apps/simulation/carmen_writer.h"
#include "plumbline/apps/simulation/faulty_drive.h"
#include "plumbline/apps/simulation/floor.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/apps/simulation/truth_writer.h"

DEFINE_string(world, "", "Building to drive through; datasets/README.md describes the format");
DEFINE_string(
    building, "",
    "Makes up a building instead, out of --seed: random, repetitive, long_corridor, hall, "
    "round or slanted");
DEFINE_int32(people, 0, "People who walk around the robot");
DEFINE_bool(doors_move, false, "Doors of the building slide shut and open again");
DEFINE_string(log, "", "CARMEN log to write");
DEFINE_string(truth, "", "True trajectory to write, TUM format (empty: none)");
DEFINE_string(hits, "", "True point of every return to write, lines 't beam x y' (empty: none)");

namespace {

using plumbline::DegToRad;
using plumbline::RadToDeg;

// The library's defaults are those of the flags.
const plumbline::SimulationOptions& Defaults() {
  static const plumbline::SimulationOptions options;
  return options;
}

}  // namespace

DEFINE_uint64(seed, Defaults().seed, "Seed of all noise, and of a building that is made up");
DEFINE_uint64(visit, 0,
              "If not 0, a drive through the same --building on another day: the robot starts and "
              "goes elsewhere, and a third of the furniture has moved");

DEFINE_double(drive_length_m, 0.0,
              "If not 0, --building=random becomes as large as a drive of this length needs to go "
              "around each of its blocks once [m]");

DEFINE_int32(num_beams, Defaults().laser.num_beams, "Beams per scan");
DEFINE_double(first_bearing_deg, RadToDeg(Defaults().laser.first_bearing_rad),
              "Direction of the first beam [deg]");
DEFINE_double(bearing_step_deg, RadToDeg(Defaults().laser.bearing_step_rad),
              "From one beam to the next [deg]");
DEFINE_double(min_range_m, Defaults().laser.min_range_m, "Shortest reading [m]");
DEFINE_double(max_range_m, Defaults().laser.max_range_m, "Readings from here on are no return [m]");
DEFINE_double(laser_x_m, Defaults().laser.robot_from_laser.x, "Laser on the robot: forward [m]");
DEFINE_double(laser_y_m, Defaults().laser.robot_from_laser.y, "Laser on the robot: left [m]");
DEFINE_double(laser_yaw_deg, RadToDeg(Defaults().laser.robot_from_laser.yaw),
              "Laser on the robot: heading [deg]");
DEFINE_double(scan_period_s, Defaults().scan_period_s, "From one scan to the next [s]");
DEFINE_double(sweep_time_s, 0.0,
              "Time that a sweep takes from the first beam to the last, while the robot drives on "
              "[s]; 0: all beams at once");

DEFINE_double(speed_m_s, Defaults().drive.speed_m_s, "Driving speed [m/s]");
DEFINE_double(turn_rate_deg_s, RadToDeg(Defaults().drive.turn_rate_rad_s),
              "Turn rate on the spot, and at most on curves [deg/s]");
DEFINE_double(corner_radius_m, Defaults().drive.corner_radius_m, "Radius of curves [m]");
DEFINE_double(sharp_corner_deg, RadToDeg(Defaults().drive.sharp_corner_rad),
              "From this change of direction on, the robot turns on the spot [deg]");
DEFINE_double(robot_radius_m, Defaults().drive.robot_radius_m,
              "No surface may come closer to the robot's centre [m]");

DEFINE_double(sigma_range_m, Defaults().laser_noise.sigma_range_m, "Range noise [m]");
DEFINE_double(sigma_bearing_deg, RadToDeg(Defaults().laser_noise.sigma_bearing_rad),
              "Noise of a beam's direction [deg]");
DEFINE_double(no_return_probability, Defaults().laser_noise.no_return_probability,
              "Share of beams that are lost, as on glass");
DEFINE_double(short_reading_probability, Defaults().laser_noise.short_reading_probability,
              "Share of beams that meet something in the way, as people");

DEFINE_double(odom_rotation_per_rotation, Defaults().odometry_noise.rotation_per_rotation,
              "Odometry noise alpha_1 [rad per rad]");
DEFINE_double(odom_rotation_per_translation_rad_m,
              Defaults().odometry_noise.rotation_per_translation_rad_m,
              "Odometry noise alpha_2 [rad per m]");
DEFINE_double(odom_translation_per_translation,
              Defaults().odometry_noise.translation_per_translation,
              "Odometry noise alpha_3 [m per m]");
DEFINE_double(odom_translation_per_rotation_m_rad,
              Defaults().odometry_noise.translation_per_rotation_m_rad,
              "Odometry noise alpha_4 [m per rad]");
DEFINE_double(odom_heading_drift_rad_m, Defaults().odometry_noise.heading_drift_rad_m,
              "Odometry's systematic turn [rad per m]");
DEFINE_double(odom_scale_error, Defaults().odometry_noise.scale_error,
              "Odometry's systematic error in distance [m per m]");

DEFINE_double(carry_at_path_m, Defaults().carry.at_path_m,
              "Where on its path the robot is carried, unnoticed by the odometry [m]");
DEFINE_double(carry_distance_m, Defaults().carry.distance_m, "How far it is carried along it [m]");
DEFINE_double(odom_leap_at_path_m, Defaults().odometry_leap.at_path_m,
              "Where on the path the odometry leaps, although the robot does not [m]");
DEFINE_double(odom_leap_distance_m, Defaults().odometry_leap.distance_m, "How far it leaps [m]");
DEFINE_double(odom_leap_direction_deg, RadToDeg(Defaults().odometry_leap_direction_rad),
              "In which direction, seen from the robot [deg]");

DEFINE_string(fault, "none",
              "What goes wrong, which a mapper is not told: carried or carried_in_gap (the robot, "
              "along its path), slip (wheels report what the robot does not do), dropped_scans, "
              "clock_offset (odometry of another time), repeated (a stretch of the log comes once "
              "more), frozen or frozen_to_end (the laser), mounting (the laser is turned), "
              "two_buildings (the log of another one follows)");
DEFINE_double(fault_at_share, 0.0,
              "Share of the path driven before the fault, between 0 and 1 (0: as usual for it)");
DEFINE_double(fault_distance_m, 0.0,
              "How far the robot is carried, or how much too far the wheels report; if negative, "
              "too little (0: as usual) [m]");
DEFINE_double(fault_time_s, 0.0,
              "How long the fault lasts, or how much too old the odometry is; if negative, too new "
              "(0: as usual) [s]");
DEFINE_double(fault_angle_deg, 0.0,
              "By how much the laser is turned, counter-clockwise (0: as usual) [deg]");

namespace plumbline {
namespace {

const std::vector<FileFlag>& FileFlags() {
  static const std::vector<FileFlag> flags = {{"world", &FLAGS_world, FileUse::kInput},
                                              {"log", &FLAGS_log, FileUse::kOutput},
                                              {"truth", &FLAGS_truth, FileUse::kOutput},
                                              {"hits", &FLAGS_hits, FileUse::kOutput}};
  return flags;
}

SimulationOptions OptionsFromFlags() {
  SimulationOptions options;
  options.laser.num_beams = FLAGS_num_beams;
  options.laser.first_bearing_rad = DegToRad(FLAGS_first_bearing_deg);
  options.laser.bearing_step_rad = DegToRad(FLAGS_bearing_step_deg);
  options.laser.min_range_m = FLAGS_min_range_m;
  options.laser.max_range_m = FLAGS_max_range_m;
  options.laser.robot_from_laser = {FLAGS_laser_x_m, FLAGS_laser_y_m,
                                    DegToRad(FLAGS_laser_yaw_deg)};
  options.laser.beam_period_s = FLAGS_sweep_time_s / FLAGS_num_beams;
  options.scan_period_s = FLAGS_scan_period_s;
  options.drive.speed_m_s = FLAGS_speed_m_s;
  options.drive.turn_rate_rad_s = DegToRad(FLAGS_turn_rate_deg_s);
  options.drive.corner_radius_m = FLAGS_corner_radius_m;
  options.drive.sharp_corner_rad = DegToRad(FLAGS_sharp_corner_deg);
  options.drive.robot_radius_m = FLAGS_robot_radius_m;
  options.laser_noise.sigma_range_m = FLAGS_sigma_range_m;
  options.laser_noise.sigma_bearing_rad = DegToRad(FLAGS_sigma_bearing_deg);
  options.laser_noise.no_return_probability = FLAGS_no_return_probability;
  options.laser_noise.short_reading_probability = FLAGS_short_reading_probability;
  OdometryNoise& odometry = options.odometry_noise;
  odometry.rotation_per_rotation = FLAGS_odom_rotation_per_rotation;
  odometry.rotation_per_translation_rad_m = FLAGS_odom_rotation_per_translation_rad_m;
  odometry.translation_per_translation = FLAGS_odom_translation_per_translation;
  odometry.translation_per_rotation_m_rad = FLAGS_odom_translation_per_rotation_m_rad;
  odometry.heading_drift_rad_m = FLAGS_odom_heading_drift_rad_m;
  odometry.scale_error = FLAGS_odom_scale_error;
  options.carry = {FLAGS_carry_at_path_m, FLAGS_carry_distance_m};
  options.odometry_leap = {FLAGS_odom_leap_at_path_m, FLAGS_odom_leap_distance_m};
  options.odometry_leap_direction_rad = DegToRad(FLAGS_odom_leap_direction_deg);
  options.traffic = {FLAGS_people, FLAGS_doors_move};
  options.seed = SeedOfVisit(FLAGS_seed, FLAGS_visit);
  return options;
}

// A flag that says how a fault is: its name, without what they begin with, and what it sets, in
// units of the fault's field.
struct FaultFlag {
  const char* name;
  double value, units_per_flag_unit;
  double Fault::*field;
};

std::vector<FaultFlag> FaultFlags() {
  return {{"at_share", FLAGS_fault_at_share, 1.0, &Fault::at_share},
          {"distance_m", FLAGS_fault_distance_m, 1.0, &Fault::distance_m},
          {"time_s", FLAGS_fault_time_s, 1.0, &Fault::time_s},
          {"angle_deg", FLAGS_fault_angle_deg, DegToRad(1.0), &Fault::angle_rad}};
}

Status FaultFromFlags(Fault* fault) {
  FaultKind kind;
  if (!FromString(FLAGS_fault, &kind) || kind == FaultKind::kInjected) {
    return Status::InvalidArgument("--fault=" + FLAGS_fault + ": there is none; see --help");
  }
  *fault = Fault::Default(kind);
  for (const FaultFlag& flag : FaultFlags()) {
    if (flag.value == 0.0) continue;
    const std::string name = std::string("--fault_") + flag.name;
    if (fault->*flag.field == 0.0) {
      return Status::InvalidArgument(name + " does not belong to --fault=" + FLAGS_fault);
    }
    fault->*flag.field = flag.units_per_flag_unit * flag.value;
    std::string error;
    if (!fault->Check(&error)) return Status::InvalidArgument(name + ": the fault's " + error);
  }
  return Status::Ok();
}

Status CheckFault() {
  Fault fault;
  PLUMBLINE_RETURN_IF_ERROR(FaultFromFlags(&fault));
  if (fault.kind == FaultKind::kNone) return Status::Ok();
  if (FLAGS_carry_distance_m != 0.0) {
    return Status::InvalidArgument("--fault and --carry_distance_m exclude each other");
  }
  if (FLAGS_odom_leap_distance_m != 0.0) {
    return Status::InvalidArgument("--fault and --odom_leap_distance_m exclude each other");
  }
  if (fault.kind == FaultKind::kTwoBuildings && FLAGS_building.empty()) {
    return Status::InvalidArgument("--fault=two_buildings needs --building, which makes up both");
  }
  return Status::Ok();
}

// first_scan: as SimulateWithFault has it.
void PrintSummary(const SimulatedLog& log, const Fault& fault, std::size_t first_scan) {
  std::size_t num_returns = 0;
  for (const SimulatedScan& scan : log.scans) {
    for (const double range : scan.scan.ranges) num_returns += log.laser.IsReturn(range) ? 1 : 0;
  }
  const SimulatedScan& last = log.scans.back();
  const Pose2 error = Between(last.world_from_robot, last.odom_from_robot);
  std::cout << std::fixed << std::setprecision(2) << log.scans.size() << " scans, " << num_returns
            << " returns, " << log.path_length_m << " m driven in " << last.scan.timestamp_s
            << " s; odometry ends " << std::hypot(error.x, error.y) << " m and "
            << RadToDeg(std::abs(error.yaw)) << " deg off\n";
  if (fault.kind == FaultKind::kNone || first_scan >= log.scans.size()) return;
  std::cout << "fault " << ToString(fault.kind) << " from scan " << first_scan << " on, at "
            << log.scans[first_scan].scan.timestamp_s << " s\n";
}

Status CheckFlags() {
  if (FLAGS_world.empty() == FLAGS_building.empty()) {
    return Status::InvalidArgument(FLAGS_world.empty()
                                       ? "--world is missing, or --building; see --help"
                                       : "--world and --building exclude each other");
  }
  BuildingKind kind;
  if (!FLAGS_building.empty() && !FromString(FLAGS_building, &kind)) {
    return Status::InvalidArgument("--building=" + FLAGS_building + ": no such kind; see --help");
  }
  if (FLAGS_visit != 0 && FLAGS_building.empty()) {
    return Status::InvalidArgument("--visit needs --building, which makes up the furniture");
  }
  // Of a million scans or more.
  constexpr double kLongestDriveM = 1e5;
  if (!(FLAGS_drive_length_m >= 0.0 && FLAGS_drive_length_m <= kLongestDriveM)) {
    return Status::InvalidArgument("--drive_length_m must be from 0 to 100000");
  }
  if (FLAGS_drive_length_m > 0.0 && (FLAGS_building != "random" || FLAGS_visit != 0)) {
    return Status::InvalidArgument(
        "--drive_length_m goes with --building=random, and not with --visit");
  }
  if (FLAGS_log.empty()) return Status::InvalidArgument("--log is missing; see --help");
  std::string error;
  if (!OptionsFromFlags().Check(&error)) return Status::InvalidArgument("simulation: " + error);
  return CheckFault();
}

// The building that --world asks for, or one out of this seed that --building asks for.
Status MakeBuilding(std::uint64_t seed, Building* building) {
  if (!FLAGS_world.empty()) return ReadBuilding(FLAGS_world, building);
  BuildingKind kind = BuildingKind::kRandom;
  FromString(FLAGS_building, &kind);  // CheckFlags knows the name
  *building = FLAGS_drive_length_m > 0.0 ? GenerateLargeBuilding(FLAGS_drive_length_m, seed)
                                         : GenerateVisit(kind, seed, FLAGS_visit);
  return Status::Ok();
}

Status Run() {
  EndIfStoppedWhile("simulating");
  Fault fault;
  PLUMBLINE_RETURN_IF_ERROR(FaultFromFlags(&fault));
  Building building;
  PLUMBLINE_RETURN_IF_ERROR(MakeBuilding(FLAGS_seed, &building));
  std::optional<World> second;
  if (fault.kind == FaultKind::kTwoBuildings) {
    Building another;
    PLUMBLINE_RETURN_IF_ERROR(MakeBuilding(SecondSeed(FLAGS_seed), &another));
    second.emplace(std::move(another));
  }
  SimulatedLog log;
  std::size_t first_scan = 0;
  PLUMBLINE_RETURN_IF_ERROR(SimulateWithFault(World(std::move(building)),
                                              second ? &*second : nullptr, OptionsFromFlags(),
                                              fault, &log, &first_scan));
  EndIfStoppedWhileWriting();
  PLUMBLINE_RETURN_IF_ERROR(WriteCarmenLog(FLAGS_log, log));
  if (!FLAGS_truth.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteTrueTrajectory(FLAGS_truth, log));
  if (!FLAGS_hits.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteTrueHits(FLAGS_hits, log));
  PrintSummary(log, fault, first_scan);
  return Status::Ok();
}

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  plumbline::StartProgram(
      "Simulates a robot with a laser scanner in a building.\n\n"
      "  plumbline_simulate --world=datasets/small_building.world --log=small_building.clf "
      "--truth=small_building.tum --hits=small_building.hits\n"
      "  plumbline_simulate --building=random --seed=7 --log=random_7.clf --truth=random_7.tum\n"
      "  plumbline_simulate --building=random --seed=7 --fault=frozen --fault_at_share=0.5 "
      "--fault_time_s=12 --log=frozen.clf",
      argc, argv);
  return plumbline::RunProgram(plumbline::FileFlags(), plumbline::CheckFlags, plumbline::Run);
}
