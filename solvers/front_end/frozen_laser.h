#ifndef PLUMBLINE_SOLVERS_FRONT_END_FROZEN_LASER_H_
#define PLUMBLINE_SOLVERS_FRONT_END_FROZEN_LASER_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// Finds the stretches in which a laser repeated one scan although the robot moved, each as long as
/// it can be, in the order of their last scans. Needs scans in the order of their poses; a stretch
/// ends where odometry from pose to pose is missing.
///
/// Equal scans are a fault if they have at least 20 returns and the motion must have changed at
/// least 10 of these by more than 6 cm each, above the coarsest rounding of a range (5 cm). A
/// motion changes a return by how far it shifts the return's surface across itself: along the walls
/// of a bare corridor by nothing, and equal scans are right there. Steps of the odometry below 1 mm
/// and 1 mrad count as rest.
///
/// Not told apart: wheels that spin on the spot in front of a laser that rounds its noise away.
std::vector<FrozenStretch> FindFrozenStretches(const SlamGraph& graph);

/// Takes the returns of all repetitions out of the graph: their poses follow the odometry alone.
/// Scans keep their ids; returns get new ones. frozen: the stretches that were found.
void DropRepeatedScans(SlamGraph* graph, std::vector<FrozenStretch>* frozen);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_FROZEN_LASER_H_
