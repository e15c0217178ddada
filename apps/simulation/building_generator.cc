#include "plumbline/apps/simulation/building_generator.h"

#include <algorithm>
#include <cmath>

#include "plumbline/apps/simulation/floor.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/apps/simulation/special_floors.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kStyleStream = 2;  // the simulator has 0 and 1

// Two or three cross corridors; the wings at both ends are as wide as one room.
FloorStyle RandomStyle(NoiseSource* source) {
  FloorStyle style;
  const int num_cores = source->Uniform() < 0.5 ? 1 : 2;
  style.block_widths_m = {source->Uniform(3.0, 5.0), source->Uniform(3.0, 5.0)};
  for (int i = 0; i < num_cores; ++i) {
    const double width = source->Uniform(9.0, 14.0) / (num_cores == 1 ? 1.0 : 1.5);
    style.block_widths_m.insert(style.block_widths_m.begin() + 1, width);
  }
  for (double& depth : style.row_depths_m) depth = source->Uniform(2.8, 4.6);
  style.corridor_width_m = source->Uniform(2.0, 2.6);
  style.cross_corridor_width_m = source->Uniform(1.8, 2.6);
  style.room_width_m = source->Uniform(3.6, 5.0);
  style.irregularity = style.slant = 1.0;
  style.furniture_per_room = 6;
  style.furniture_per_corridor_m = 0.15;
  style.visit_probability = 0.5;
  style.drive_length_m = source->Uniform(65.0, 110.0);
  return style;
}

// Cross corridors are half a room wide, so that a floor with two of them keeps to the pitch of its
// rooms throughout. Half of the floors are not furnished at all.
FloorStyle RepetitiveStyle(NoiseSource* source) {
  FloorStyle style;
  const double pitch = source->Uniform(3.2, 4.4);
  const int num_cores = source->Uniform() < 0.5 ? 1 : 2;
  const int rooms_per_core = num_cores == 1 ? 3 + static_cast<int>(2.0 * source->Uniform()) : 2;
  style.block_widths_m.assign(num_cores + 2, pitch * rooms_per_core);
  style.block_widths_m.front() = style.block_widths_m.back() = pitch;
  const double depth = source->Uniform(3.0, 4.2);
  for (double& row_depth : style.row_depths_m) row_depth = depth;
  style.corridor_width_m = source->Uniform(2.0, 2.4);
  style.cross_corridor_width_m = 0.5 * pitch;
  style.room_width_m = pitch;
  style.furniture_per_room = source->Uniform() < 0.5 ? 0 : 4;
  style.visit_probability = 0.5;
  style.drive_length_m = source->Uniform(65.0, 110.0);
  return style;
}

// Niches cut into thick walls.
FloorStyle LongCorridorStyle(NoiseSource* source) {
  FloorStyle style;
  style.room_width_m = 4.0;
  style.block_widths_m = {4.0, 28 * 4.0, 31 * 4.0, 4.0};
  for (double& depth : style.row_depths_m) depth = 0.5;
  style.core_depth_m = source->Uniform(30.0, 45.0);
  style.corridor_wall_m = 0.4;
  style.corridor_width_m = style.cross_corridor_width_m = 2.4;
  style.door_width_m = 1.2;
  style.drive_length_m = 2000.0;
  return style;
}

}  // namespace

const char* ToString(BuildingKind kind) {
  switch (kind) {
    case BuildingKind::kRandom:
      return "random";
    case BuildingKind::kRepetitive:
      return "repetitive";
    case BuildingKind::kLongCorridor:
      return "long_corridor";
    case BuildingKind::kHall:
      return "hall";
    case BuildingKind::kRound:
      return "round";
    case BuildingKind::kSlanted:
      return "slanted";
  }
  return "?";
}

bool FromString(const std::string& name, BuildingKind* kind) {
  for (const BuildingKind candidate : kBuildingKinds) {
    if (name != ToString(candidate)) continue;
    *kind = candidate;
    return true;
  }
  return false;
}

Building GenerateLargeBuilding(double drive_length_m, std::uint64_t seed) {
  // Four times along a block, twice across it, and every other time into a room: about 100 m.
  constexpr double kDrivePerBlock = 100.0;
  NoiseSource source(seed, kStyleStream);
  FloorStyle style = RandomStyle(&source);
  const double wing_m = style.block_widths_m.front();
  const int num_blocks =
      std::max(1, static_cast<int>(std::lround(drive_length_m / kDrivePerBlock)));
  style.block_widths_m.assign(num_blocks + 2, wing_m);
  for (int i = 1; i <= num_blocks; ++i) style.block_widths_m[i] = source.Uniform(9.0, 14.0);
  style.route = RouteKind::kTour;
  style.drive_length_m = drive_length_m;
  Building building = MakeFloor(style, seed);
  building.name = "large building " + std::to_string(seed);
  return building;
}

Building GenerateVisit(BuildingKind kind, std::uint64_t seed, std::uint64_t visit) {
  NoiseSource source(seed, kStyleStream);
  const auto floor = [&](FloorStyle style) {
    style.visit = visit;
    return MakeFloor(style, seed);
  };
  Building building;
  switch (kind) {
    case BuildingKind::kRandom:
      building = floor(RandomStyle(&source));
      break;
    case BuildingKind::kRepetitive:
      building = floor(RepetitiveStyle(&source));
      break;
    case BuildingKind::kLongCorridor:
      building = floor(LongCorridorStyle(&source));
      break;
    case BuildingKind::kHall:
      building = MakeHall(&source);
      break;
    case BuildingKind::kRound:
      building = MakeRing({32, 0.0}, &source);
      break;
    case BuildingKind::kSlanted:
      building = MakeRing({7, 0.5}, &source);
      break;
  }
  building.name = std::string(ToString(kind)) + " building " + std::to_string(seed);
  if (visit != 0) building.name += ", visit " + std::to_string(visit);
  return building;
}

Building GenerateBuilding(BuildingKind kind, std::uint64_t seed) {
  return GenerateVisit(kind, seed, 0);
}

}  // namespace plumbline
