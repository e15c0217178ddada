#ifndef PLUMBLINE_SOLVERS_MIRRORED_SCANS_H_
#define PLUMBLINE_SOLVERS_MIRRORED_SCANS_H_

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How the scans of a graph go with the turns between their poses.
struct TurnVotes {
  int as_they_are = 0;  ///< pairs of scans that match by far better as they are
  int mirrored = 0;     ///< by far better with their beams in reverse order
};

/// Lets pairs of scans, between which the laser turned by 10 to 60 degrees, vote on whether its
/// beams are counted from the wrong side. Pairs that match about as well, or badly, both ways do
/// not vote: round rooms, or poses that are wrong. A sample of the graph at most: the cost does not
/// grow with it.
TurnVotes VoteOnTurns(const SlamGraph& graph);

/// InvalidArgument if next to all votes, and enough of them, say that the scans are mirrored. Such
/// scans still agree with each other where the poses give way to them, so that no energy tells.
Status CheckScansAreNotMirrored(const SlamGraph& graph);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_MIRRORED_SCANS_H_
