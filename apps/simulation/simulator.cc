#include "plumbline/apps/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr double kReadingsPerMetre = 1000.0;
// Of a drive that fits into memory.
constexpr double kMaxReadings = 4e8;
// Streams of random numbers.
constexpr std::uint32_t kLaserStream = 0, kOdometryStream = 1;

struct Reading {
  double range_m;
  Eigen::Vector2d hit;
};

// Whether a surface throws a beam of this direction back at all.
bool Reflects(const RayHit& hit, double world_bearing_rad) {
  constexpr double kHeadOnRad = 0.26;
  if (hit.face == nullptr || !hit.face->is_glass) return true;
  const Eigen::Vector2d along = (hit.face->b - hit.face->a).normalized();
  return std::abs(along.dot(BeamEnd(1.0, world_bearing_rad))) < std::sin(kHeadOnRad);
}

// moving: what is in the building, but not of it; may be null.
Reading TakeReading(const World& world, const World* moving, const Pose2& world_from_laser,
                    double bearing_rad, const LaserModel& laser, const LaserNoise& noise,
                    NoiseSource* source) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  Reading no_return{laser.max_range_m, {kNaN, kNaN}};
  // Every beam draws the same numbers, whatever it meets.
  const double bearing_error = noise.sigma_bearing_rad * source->Gaussian();
  const double range_error = noise.sigma_range_m * source->Gaussian();
  const double fate = source->Uniform(), shortening = source->Uniform();

  const Eigen::Vector2d origin = world_from_laser.translation();
  const double world_bearing = world_from_laser.yaw + bearing_rad + bearing_error;
  const RayHit hit = world.TraceRay(origin, world_bearing);
  const double to_moving = moving != nullptr ? moving->CastRay(origin, world_bearing)
                                             : std::numeric_limits<double>::infinity();
  const bool meets_moving = to_moving < hit.distance_m;
  const double distance = std::min(hit.distance_m, to_moving);
  if (!(distance < laser.max_range_m) || fate < noise.no_return_probability) return no_return;
  if (!meets_moving && !Reflects(hit, world_bearing)) return no_return;
  const bool shortened = fate < noise.no_return_probability + noise.short_reading_probability;
  const bool obstructed = shortened || meets_moving;
  const double measured = (shortened ? shortening * distance : distance) + range_error;
  const double range = std::round(measured * kReadingsPerMetre) / kReadingsPerMetre;
  if (!laser.IsReturn(range)) return no_return;
  return {range, obstructed ? no_return.hit : origin + BeamEnd(distance, world_bearing)};
}

// What the wheels report of a true step.
Pose2 DisturbStep(const Pose2& step, const OdometryNoise& noise, NoiseSource* source) {
  const double trans = std::hypot(step.x, step.y);
  // A turn on the spot moves the robot by a rounding error, which has no direction.
  const double rot1 = trans > 1e-9 ? std::atan2(step.y, step.x) : 0.0;
  const double rot2 = NormalizeAngle(step.yaw - rot1);
  const double sigma_rot1 =
      noise.rotation_per_rotation * std::abs(rot1) + noise.rotation_per_translation_rad_m * trans;
  const double sigma_trans =
      noise.translation_per_translation * trans +
      noise.translation_per_rotation_m_rad * (std::abs(rot1) + std::abs(rot2));
  const double sigma_rot2 =
      noise.rotation_per_rotation * std::abs(rot2) + noise.rotation_per_translation_rad_m * trans;
  const double drift = noise.heading_drift_rad_m * trans;
  const double noisy_rot1 = rot1 + 0.5 * drift + sigma_rot1 * source->Gaussian();
  const double noisy_trans = (1.0 + noise.scale_error) * trans + sigma_trans * source->Gaussian();
  const double noisy_rot2 = rot2 + 0.5 * drift + sigma_rot2 * source->Gaussian();
  return Pose2(0.0, 0.0, noisy_rot1) * Pose2(noisy_trans, 0.0, noisy_rot2);
}

// The planned drive as it happens: the robot does not drive the stretch over which it is carried.
class ActualDrive {
 public:
  ActualDrive(const Drive& plan, const DriveFault& carry, double carry_duration_s)
      : plan_(plan),
        carried_at_s_(plan.TimeAt(carry.at_path_m)),
        skipped_s_(plan.TimeAt(carry.at_path_m + carry.distance_m) - carried_at_s_),
        skipped_m_(std::clamp(plan.length_m() - carry.at_path_m, 0.0, carry.distance_m)),
        pause_s_(skipped_s_ > 0.0 ? carry_duration_s : 0.0) {}

  double duration_s() const { return plan_.duration_s() - skipped_s_ + pause_s_; }
  double length_m() const { return plan_.length_m() - skipped_m_; }

  // Not while it is carried.
  Pose2 WorldFromRobot(double time_s) const {
    return plan_.WorldFromRobot(time_s > carried_at_s_ ? time_s - pause_s_ + skipped_s_ : time_s);
  }

  // Both ends excluded.
  bool IsCarried(double time_s) const {
    return carried_at_s_ < time_s && time_s < carried_at_s_ + pause_s_;
  }

  // The motion from one time to a later one, as the wheels roll.
  Pose2 RolledMotion(double from_s, double to_s) const {
    // They rest while it is carried.
    if (IsCarried(from_s)) from_s = carried_at_s_;
    if (IsCarried(to_s)) to_s = carried_at_s_;
    const Pose2 from = WorldFromRobot(from_s), to = WorldFromRobot(to_s);
    if (from_s > carried_at_s_ || to_s <= carried_at_s_) return Between(from, to);
    return Between(from, plan_.WorldFromRobot(carried_at_s_)) *
           Between(plan_.WorldFromRobot(carried_at_s_ + skipped_s_), to);
  }

  // When the robot passes this point of its path; for one that it is carried over, when it is
  // picked up.
  double TimeAt(double path_m) const {
    const double planned_s = plan_.TimeAt(path_m);
    if (planned_s < carried_at_s_) return planned_s;
    return std::max(carried_at_s_, planned_s - skipped_s_ + pause_s_);
  }

 private:
  const Drive& plan_;
  const double carried_at_s_, skipped_s_, skipped_m_, pause_s_;
};

// How much of the odometry's leap falls between two times: from 0 to 1.
double ShareOfLeap(const ActualDrive& drive, double from_s, double to_s,
                   const SimulationOptions& options) {
  const double start_s = drive.TimeAt(options.odometry_leap.at_path_m);
  const double duration_s = options.odometry_leap_duration_s;
  if (duration_s == 0.0) return from_s <= start_s && start_s < to_s ? 1.0 : 0.0;
  const double overlap_s = std::min(to_s, start_s + duration_s) - std::max(from_s, start_s);
  return std::max(0.0, overlap_s / duration_s);
}

// What the odometry reports of the way from one time to a later one.
Pose2 OdometryStep(const ActualDrive& drive, double from_s, double to_s,
                   const SimulationOptions& options, NoiseSource* source) {
  const Pose2 step = DisturbStep(drive.RolledMotion(from_s, to_s), options.odometry_noise, source);
  const double share = ShareOfLeap(drive, from_s, to_s, options);
  if (share == 0.0) return step;
  const Eigen::Vector2d shift =
      BeamEnd(share * options.odometry_leap.distance_m, options.odometry_leap_direction_rad);
  return Pose2(shift.x(), shift.y(), 0.0) * step;
}

// Each beam at its own time.
void TakeScan(const World& world, const World* moving, const ActualDrive& drive,
              const SimulationOptions& options, NoiseSource* source, SimulatedScan* scan) {
  const Pose2 robot_from_laser = options.laser.robot_from_laser * options.mounting_error;
  Pose2 world_from_laser = scan->world_from_robot * robot_from_laser;
  for (int beam = 0; beam < options.laser.num_beams; ++beam) {
    if (options.laser.beam_period_s > 0.0) {
      const double time_s = scan->scan.timestamp_s + beam * options.laser.beam_period_s;
      world_from_laser =
          drive.WorldFromRobot(std::min(time_s, drive.duration_s())) * robot_from_laser;
    }
    const Reading reading =
        TakeReading(world, moving, world_from_laser, options.laser.Bearing(beam), options.laser,
                    options.laser_noise, source);
    scan->scan.ranges.push_back(reading.range_m);
    scan->hits.push_back(reading.hit);
  }
}

Pose2 WithWrappedYaw(Pose2 pose) {
  pose.yaw = NormalizeAngle(pose.yaw);
  return pose;
}

// Times and poses of all scans; what they see comes later.
std::vector<SimulatedScan> PlaceScans(const ActualDrive& drive, const SimulationOptions& options) {
  std::vector<SimulatedScan> scans;
  NoiseSource source(options.seed, kOdometryStream);
  double odometry_s = 0.0;
  const int num_periods = static_cast<int>(drive.duration_s() / options.scan_period_s);
  for (int i = 0; i <= num_periods; ++i) {
    SimulatedScan scan;
    scan.scan.timestamp_s = i * options.scan_period_s;
    if (drive.IsCarried(scan.scan.timestamp_s)) continue;
    scan.world_from_robot = WithWrappedYaw(drive.WorldFromRobot(scan.scan.timestamp_s));
    const double last_odometry_s = odometry_s;
    odometry_s =
        std::clamp(scan.scan.timestamp_s - options.odometry_delay_s, 0.0, drive.duration_s());
    scan.odom_from_robot = WithWrappedYaw(
        scans.empty() ? drive.WorldFromRobot(odometry_s)
                      : scans.back().odom_from_robot *
                            OdometryStep(drive, last_odometry_s, odometry_s, options, &source));
    scans.push_back(std::move(scan));
  }
  return scans;
}

}  // namespace

bool LaserNoise::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(sigma_range_m, 0.0, 10.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(sigma_bearing_rad, 0.0, 1.0);
  PLUMBLINE_CHECK_OPTION(no_return_probability, >=, 0.0);
  PLUMBLINE_CHECK_OPTION(no_return_probability, <=, 1.0);
  PLUMBLINE_CHECK_OPTION(short_reading_probability, >=, 0.0);
  PLUMBLINE_CHECK_OPTION(short_reading_probability, <=, 1.0 - no_return_probability);
  return true;
}

bool OdometryNoise::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(rotation_per_rotation, 0.0, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(rotation_per_translation_rad_m, 0.0, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(translation_per_translation, 0.0, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(translation_per_rotation_m_rad, 0.0, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(std::abs(heading_drift_rad_m), 0.0, 100.0);
  PLUMBLINE_CHECK_OPTION(scale_error, >, -1.0);
  PLUMBLINE_CHECK_OPTION(scale_error, <=, 100.0);
  return true;
}

OdometryNoise Scaled(const OdometryNoise& noise, double factor) {
  OdometryNoise scaled = noise;
  for (double* error : {&scaled.rotation_per_rotation, &scaled.rotation_per_translation_rad_m,
                        &scaled.translation_per_translation, &scaled.translation_per_rotation_m_rad,
                        &scaled.heading_drift_rad_m, &scaled.scale_error}) {
    *error *= factor;
  }
  return scaled;
}

bool DriveFault::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(at_path_m, 0.0, 1e5);
  PLUMBLINE_CHECK_OPTION_WITHIN(distance_m, 0.0, 1e5);
  return true;
}

SimulationOptions::SimulationOptions() {
  laser.num_beams = 360;
  laser.first_bearing_rad = DegToRad(-90.0);
  laser.bearing_step_rad = DegToRad(0.5);
}

bool SimulationOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(scan_period_s, 1e-3, 3600.0);
  PLUMBLINE_CHECK_NESTED_OPTIONS(carry);
  PLUMBLINE_CHECK_NESTED_OPTIONS(odometry_leap);
  PLUMBLINE_CHECK_OPTION_WITHIN(carry_duration_s, 0.0, 1e5);
  PLUMBLINE_CHECK_OPTION_WITHIN(std::abs(odometry_leap_direction_rad), 0.0, 2.0 * kPi);
  PLUMBLINE_CHECK_OPTION_WITHIN(odometry_leap_duration_s, 0.0, 1e5);
  PLUMBLINE_CHECK_OPTION_WITHIN(std::abs(odometry_delay_s), 0.0, 1e5);
  PLUMBLINE_CHECK_OPTION_WITHIN(std::abs(mounting_error.x), 0.0, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(std::abs(mounting_error.y), 0.0, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(std::abs(mounting_error.yaw), 0.0, 2.0 * kPi);
  PLUMBLINE_CHECK_NESTED_OPTIONS(traffic);
  return laser.Check(error) && drive.Check(error) && laser_noise.Check(error) &&
         odometry_noise.Check(error);
}

Status Simulate(const World& world, const SimulationOptions& options, SimulatedLog* log) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("simulation: " + error);
  Drive plan;
  PLUMBLINE_RETURN_IF_ERROR(Drive::Plan(world, options.drive, &plan));

  const ActualDrive drive(plan, options.carry, options.carry_duration_s);
  const double num_readings = drive.duration_s() / options.scan_period_s * options.laser.num_beams;
  if (!(num_readings <= kMaxReadings)) {
    return Status::InvalidArgument(world.building().name +
                                   ": path: so long that the drive takes more than 4e8 "
                                   "readings of the laser");
  }
  const Traffic traffic(world.building(), plan, options.traffic, options.seed);
  SimulatedLog result;
  result.laser = options.laser;
  result.path_length_m = drive.length_m();
  result.scans = PlaceScans(drive, options);
  NoiseSource laser_source(options.seed, kLaserStream);
  for (SimulatedScan& scan : result.scans) {
    std::optional<World> moving;
    if (options.traffic.IsOn()) {
      moving = traffic.At(scan.scan.timestamp_s, scan.world_from_robot.translation());
    }
    TakeScan(world, moving ? &*moving : nullptr, drive, options, &laser_source, &scan);
  }
  *log = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
