#ifndef PLUMBLINE_APPS_SIMULATION_FAULTY_DRIVE_H_
#define PLUMBLINE_APPS_SIMULATION_FAULTY_DRIVE_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/apps/simulation/world.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What goes wrong with a drive or with its recording, unknown to the mapper.
enum class FaultKind {
  kNone,
  /// The robot is carried along its path between two scans, and its odometry does not notice.
  kCarried,
  /// Not of the log, which is sound: the sequential matching is made to say that the robot has gone
  /// further ahead, together with its odometry, and as sure as ever. For the seeding study alone.
  kInjected,
  kCarriedInGap,  ///< it is carried while nothing is recorded
  kSlip,          ///< over some time the wheels report a motion that the robot does not make
  kDroppedScans,  ///< for some time there are no scans; the odometry goes on and is right
  kClockOffset,   ///< each scan comes with the odometry of another time
  kRepeated,      ///< a stretch of the log is recorded once more behind itself, later in time
  kFrozen,        ///< for some time the laser gives the same ranges again and again
  kFrozenToEnd,   ///< likewise, from some time on
  kMounting,      ///< the laser is turned against the mounting that the log tells of
  kTwoBuildings,  ///< the log of another building follows, with odometry that goes on
};
/// All of them.
constexpr FaultKind kFaultKinds[] = {
    FaultKind::kNone,         FaultKind::kCarried,  FaultKind::kInjected,
    FaultKind::kCarriedInGap, FaultKind::kSlip,     FaultKind::kDroppedScans,
    FaultKind::kClockOffset,  FaultKind::kRepeated, FaultKind::kFrozen,
    FaultKind::kFrozenToEnd,  FaultKind::kMounting, FaultKind::kTwoBuildings};

/// "carried_in_gap", say.
const char* ToString(FaultKind kind);
/// Returns whether the name is known.
bool FromString(const std::string& name, FaultKind* kind);

/// A fault; a field that its kind has no use for is 0, and all are up to 1e5.
struct Fault {
  FaultKind kind = FaultKind::kNone;
  /// Of the path, driven before it happens: between 0 and 1. All but clock offset, mounting and two
  /// buildings have it.
  double at_share = 0.0;
  /// By how much the robot is carried, or matching is made to err [m]. Slip: by how much the wheels
  /// report too much motion ahead or, if negative, too little.
  double distance_m = 0.0;
  /// How long the gap, the slip, the hole, the repeated stretch or the frozen laser lasts [s].
  /// Clock offset: by how much the odometry is too old or, if negative, too new.
  double time_s = 0.0;
  /// Mounting: by how much the laser is turned, counter-clockwise [rad].
  double angle_rad = 0.0;

  /// Usual values for all that a kind needs.
  static Fault Default(FaultKind kind);
  bool Check(std::string* error) const;
};

/// Of the building that comes second, and of its noise, for one and its noise from `seed`.
std::uint64_t SecondSeed(std::uint64_t seed);

/// Simulate, with a fault. second_world: the other one of two buildings; may be null for all other
/// kinds. first_scan: the first scan after the fault, or after its begin if it lasts: behind the
/// leap or the hole, the first frozen one or copy, the first in the second building; 0 if the fault
/// is there from the start, the number of scans if the log is sound.
/// InvalidArgument as Simulate and where the fault, or a second world, is missing or bad, or the
/// options carry the robot or let its odometry leap already; the outputs are then untouched.
Status SimulateWithFault(const World& world, const World* second_world,
                         const SimulationOptions& options, const Fault& fault, SimulatedLog* log,
                         std::size_t* first_scan);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_FAULTY_DRIVE_H_
