#ifndef PLUMBLINE_APPS_SIMULATION_SPECIAL_FLOORS_H_
#define PLUMBLINE_APPS_SIMULATION_SPECIAL_FLOORS_H_

#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/apps/simulation/world.h"

namespace plumbline {

/// An empty hall of 40 x 30 m with pillars and tables; the drive goes around it, 5 to 9 m off the
/// walls, and once more half of the way. Without a name.
Building MakeHall(NoiseSource* source);

/// A corridor around a closed core, and rooms around the corridor.
struct RingStyle {
  int num_sides = 32;
  /// From 0: a regular polygon, to 1: corners at any angle and distance from the middle.
  double irregularity = 0.0;
};

/// Draws such a floor; the drive goes around it one and a half times. Without a name.
Building MakeRing(const RingStyle& style, NoiseSource* source);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_SPECIAL_FLOORS_H_
