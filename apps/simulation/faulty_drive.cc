#include "plumbline/apps/simulation/faulty_drive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plumbline/apps/simulation/drive.h"
#include "plumbline/apps/simulation/log_faults.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

bool IsThereFromTheStart(FaultKind kind) {
  return kind == FaultKind::kClockOffset || kind == FaultKind::kMounting;
}

// What the drive itself has of the fault. at_m: where on the path.
void AddToDrive(const Fault& fault, double at_m, SimulationOptions* options) {
  switch (fault.kind) {
    case FaultKind::kCarriedInGap:
      options->carry_duration_s = fault.time_s;
      [[fallthrough]];
    case FaultKind::kCarried:
      options->carry = {at_m, fault.distance_m};
      return;
    case FaultKind::kSlip:
      options->odometry_leap = {at_m, std::abs(fault.distance_m)};
      options->odometry_leap_direction_rad = fault.distance_m > 0.0 ? 0.0 : kPi;
      options->odometry_leap_duration_s = fault.time_s;
      return;
    case FaultKind::kClockOffset:
      options->odometry_delay_s = fault.time_s;
      return;
    case FaultKind::kMounting:
      options->mounting_error = Pose2(0.0, 0.0, fault.angle_rad);
      return;
    default:
      return;
  }
}

// What the recording has of the fault, which begins at_s after the start. Returns the first scan
// after that.
std::size_t AddToRecording(const Fault& fault, double at_s, SimulatedLog* log) {
  switch (fault.kind) {
    case FaultKind::kDroppedScans:
      return DropScans(at_s, fault.time_s, log);
    case FaultKind::kRepeated:
      return RepeatStretch(at_s, fault.time_s, log);
    case FaultKind::kFrozen:
      return FreezeLaser(at_s, fault.time_s, log);
    case FaultKind::kFrozenToEnd:
      return FreezeLaser(at_s, std::numeric_limits<double>::infinity(), log);
    case FaultKind::kCarried:
    case FaultKind::kCarriedInGap:
    case FaultKind::kSlip: {
      const auto after =
          std::find_if(log->scans.begin(), log->scans.end(),
                       [&](const SimulatedScan& scan) { return scan.scan.timestamp_s > at_s; });
      return after - log->scans.begin();
    }
    default:
      return IsThereFromTheStart(fault.kind) ? 0 : log->scans.size();
  }
}

// usual: 0 if the kind of fault does not have the field.
bool CheckField(const char* name, double value, double usual, bool is_signed, std::string* error) {
  if (usual == 0.0) return value == 0.0 || internal::FailOption(name, value, "0", error);
  constexpr double kMost = 1e5;  // as far as a building reaches [m], longer than a drive [s]
  const bool is_right = std::abs(value) <= kMost && (is_signed ? value != 0.0 : value > 0.0);
  return is_right ||
         internal::FailOption(name, value,
                              is_signed ? "!= 0 and at most 1e5 from it" : "> 0 and <= 1e5", error);
}

bool CheckAll(const SimulationOptions& options, const Fault& fault, bool has_second_world,
              std::string* error) {
  if (!fault.Check(error)) return false;
  if (fault.kind == FaultKind::kNone) return true;
  if (fault.kind == FaultKind::kTwoBuildings && !has_second_world) {
    *error = "a log of two buildings needs the second one";
    return false;
  }
  const double carry_distance_m = options.carry.distance_m;
  const double odometry_leap_distance_m = options.odometry_leap.distance_m;
  PLUMBLINE_CHECK_OPTION(carry_distance_m, ==, 0.0);
  PLUMBLINE_CHECK_OPTION(odometry_leap_distance_m, ==, 0.0);
  return true;
}

}  // namespace

const char* ToString(FaultKind kind) {
  switch (kind) {
    case FaultKind::kNone:
      return "none";
    case FaultKind::kCarried:
      return "carried";
    case FaultKind::kInjected:
      return "injected";
    case FaultKind::kCarriedInGap:
      return "carried_in_gap";
    case FaultKind::kSlip:
      return "slip";
    case FaultKind::kDroppedScans:
      return "dropped_scans";
    case FaultKind::kClockOffset:
      return "clock_offset";
    case FaultKind::kRepeated:
      return "repeated";
    case FaultKind::kFrozen:
      return "frozen";
    case FaultKind::kFrozenToEnd:
      return "frozen_to_end";
    case FaultKind::kMounting:
      return "mounting";
    case FaultKind::kTwoBuildings:
      return "two_buildings";
  }
  return "?";
}

bool FromString(const std::string& name, FaultKind* kind) {
  for (const FaultKind candidate : kFaultKinds) {
    if (name != ToString(candidate)) continue;
    *kind = candidate;
    return true;
  }
  return false;
}

Fault Fault::Default(FaultKind kind) {
  switch (kind) {
    case FaultKind::kCarried:
    case FaultKind::kInjected:
      return {kind, 0.5, 2.0, 0.0, 0.0};
    case FaultKind::kCarriedInGap:
      return {kind, 0.5, 2.0, 5.0, 0.0};
    case FaultKind::kSlip:
      return {kind, 0.5, 1.5, 6.0, 0.0};
    case FaultKind::kDroppedScans:
      return {kind, 0.5, 0.0, 3.0, 0.0};
    case FaultKind::kClockOffset:
      return {kind, 0.0, 0.0, 0.2, 0.0};
    case FaultKind::kRepeated:
      return {kind, 0.5, 0.0, 10.0, 0.0};
    case FaultKind::kFrozen:
      return {kind, 0.5, 0.0, 12.0, 0.0};
    case FaultKind::kFrozenToEnd:
      return {kind, 0.75, 0.0, 0.0, 0.0};
    case FaultKind::kMounting:
      return {kind, 0.0, 0.0, 0.0, DegToRad(5.0)};
    case FaultKind::kNone:
    case FaultKind::kTwoBuildings:
      break;
  }
  return {kind, 0.0, 0.0, 0.0, 0.0};
}

bool Fault::Check(std::string* error) const {
  const Fault usual = Default(kind);
  const bool slips = kind == FaultKind::kSlip, is_offset = kind == FaultKind::kClockOffset;
  if (!CheckField("at_share", at_share, usual.at_share, false, error)) return false;
  PLUMBLINE_CHECK_OPTION(at_share, <, 1.0);
  return CheckField("distance_m", distance_m, usual.distance_m, slips, error) &&
         CheckField("time_s", time_s, usual.time_s, is_offset, error) &&
         CheckField("angle_rad", angle_rad, usual.angle_rad, true, error);
}

std::uint64_t SecondSeed(std::uint64_t seed) {
  constexpr std::uint64_t kFarFromAllOthers = 1000000007;
  return seed + kFarFromAllOthers;
}

Status SimulateWithFault(const World& world, const World* second_world,
                         const SimulationOptions& options, const Fault& fault, SimulatedLog* log,
                         std::size_t* first_scan) {
  std::string error;
  if (!CheckAll(options, fault, second_world != nullptr, &error)) {
    return Status::InvalidArgument(std::string("fault ") + ToString(fault.kind) + ": " + error);
  }
  if (!options.Check(&error)) return Status::InvalidArgument("simulation: " + error);
  Drive plan;
  PLUMBLINE_RETURN_IF_ERROR(Drive::Plan(world, options.drive, &plan));
  const double at_m = fault.at_share * plan.length_m();
  SimulationOptions faulty = options;
  AddToDrive(fault, at_m, &faulty);
  SimulatedLog result;
  PLUMBLINE_RETURN_IF_ERROR(Simulate(world, faulty, &result));
  std::size_t first = AddToRecording(fault, plan.TimeAt(at_m), &result);
  if (fault.kind == FaultKind::kTwoBuildings) {
    SimulatedLog second;
    faulty.seed = SecondSeed(options.seed);
    PLUMBLINE_RETURN_IF_ERROR(Simulate(*second_world, faulty, &second));
    PLUMBLINE_RETURN_IF_ERROR(AppendLog(second, &result, &first));
  }
  *log = std::move(result);
  *first_scan = first;
  return Status::Ok();
}

}  // namespace plumbline
