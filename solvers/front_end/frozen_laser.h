#ifndef PLUMBLINE_SOLVERS_FRONT_END_FROZEN_LASER_H_
#define PLUMBLINE_SOLVERS_FRONT_END_FROZEN_LASER_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// Finds all such stretches, each as long as it can be, in the order of their last scans. Needs
/// scans in the order of their poses and odometry from each pose to the next; where that is missing
/// nobody knows of a motion, and a stretch ends.
///
/// Equal scans are no fault by themselves: a robot at rest has them where the laser rounds. They
/// are if they have at least 20 returns and the motion must have changed at least 10 of these, each
/// by more than 6 cm: that is more than the coarsest rounding of a range (5 cm), so that no reading
/// can have stayed. How much a motion changes a return is how far it shifts the return's surface,
/// seen from the laser, across itself. Along the walls of a bare corridor that is nothing: equal
/// scans are right there, or do no harm. Steps of the odometry below 1 mm and 1 mrad are taken for
/// jitter at rest.
///
/// Not told apart: wheels that spin on the spot in front of a laser that rounds its noise away.
std::vector<FrozenStretch> FindFrozenStretches(const SlamGraph& graph);

/// Tells of each scan of the graph whether it is a repetition. stretches: of this graph.
std::vector<char> RepeatedScans(const SlamGraph& graph,
                                const std::vector<FrozenStretch>& stretches);

/// Takes the returns of all repetitions out of the graph, so that nothing is matched to them: of
/// these poses the odometry alone tells. Scans keep their ids; returns get new ones. frozen: the
/// stretches that were found. The graph is the same if there are none.
Status DropRepeatedScans(SlamGraph* graph, std::vector<FrozenStretch>* frozen);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_FROZEN_LASER_H_
