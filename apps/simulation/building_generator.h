#ifndef PLUMBLINE_APPS_SIMULATION_BUILDING_GENERATOR_H_
#define PLUMBLINE_APPS_SIMULATION_BUILDING_GENERATOR_H_

#include <cstdint>
#include <string>

#include "plumbline/apps/simulation/world.h"

namespace plumbline {

/// What kind of building, and how hard it is to map.
enum class BuildingKind {
  /// An office floor: rooms of many sizes, some slanted walls, furniture and pillars.
  kRandom,
  /// The same kind of floor, but all its rooms and doors are alike and at a constant pitch.
  kRepetitive,
  /// Corridors of 250 m with nothing but a niche every 4 m; the loops are hundreds of metres long.
  kLongCorridor,
  /// A hall of 40 x 30 m with pillars and tables: most of the time all is out of a small scanner's
  /// reach.
  kHall,
  /// A round corridor with rooms around it, where no two walls are parallel.
  kRound,
  /// The same with a handful of corners of any angle.
  kSlanted,
};
/// All of them.
constexpr BuildingKind kBuildingKinds[] = {BuildingKind::kRandom,       BuildingKind::kRepetitive,
                                           BuildingKind::kLongCorridor, BuildingKind::kHall,
                                           BuildingKind::kRound,        BuildingKind::kSlanted};

const char* ToString(BuildingKind kind);
/// Returns whether the name is known.
bool FromString(const std::string& name, BuildingKind* kind);

/// Makes a building with a drive that comes back to where it was: 60-150 m, or about 2 km through
/// the long corridor. A robot with the default DriveOptions touches nothing. The same seed gives
/// the same building.
Building GenerateBuilding(BuildingKind kind, std::uint64_t seed);

/// The same building on another day, if `visit` is not 0; see FloorStyle::visit. Those of kinds
/// without furniture to move, kHall, kRound and kSlanted, are the same on all days.
Building GenerateVisit(BuildingKind kind, std::uint64_t seed, std::uint64_t visit);

/// Makes an office floor like kRandom, with as many blocks as a drive of at least this length goes
/// around once; the area grows in proportion to the length, from one block on. What is left of the
/// drive goes around again. For measuring how cost grows with size.
Building GenerateLargeBuilding(double drive_length_m, std::uint64_t seed);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_BUILDING_GENERATOR_H_
