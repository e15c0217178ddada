#ifndef PLUMBLINE_APPS_READERS_IMPLAUSIBLE_READINGS_H_
#define PLUMBLINE_APPS_READERS_IMPLAUSIBLE_READINGS_H_

#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// What makes it likely that the scans of a graph were misread, in words for people, each with its
/// likely cause:
///
/// - More than half of the scans have a return on less than 1 % of their beams. Walls, floors and
///   shelves return most beams, and who stands in the open sees at least that. With a maximum range
///   below 1 m, less than any 2D laser reaches, that is the cause; otherwise it is the unit.
/// - The median range is above 100 m, beyond the reach of 2D lasers. In millimetres it is some
///   thousand in any room, in centimetres some hundred.
std::vector<std::string> ImplausibleReadings(const SlamGraph& graph);

/// What makes it likely that the odometry of a graph has another unit, in words for people: half of
/// the steps that move are faster than 40 m/s or longer than 20 m. Empty if it is plausible.
std::string ImplausibleOdometry(const SlamGraph& graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_READERS_IMPLAUSIBLE_READINGS_H_
