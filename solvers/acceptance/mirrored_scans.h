#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_MIRRORED_SCANS_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_MIRRORED_SCANS_H_

#include <optional>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How the scans of a graph go with the turns between its poses.
struct TurnVotes {
  int as_they_are = 0;  ///< pairs of scans that match by far better as they are
  int mirrored = 0;     ///< by far better as mirror images

  /// Whether there are enough votes, at least 8, to say anything.
  bool AreEnough() const { return as_they_are + mirrored >= 8; }
  bool SayRight() const { return AreEnough() && !SayMirrored(); }
  /// Whether they are enough, and 90 % say mirrored.
  bool SayMirrored() const { return AreEnough() && mirrored >= 0.9 * (as_they_are + mirrored); }
};

/// Lets pairs of scans vote on whether they are mirror images of what the laser saw: about the
/// middle of its fan, for beams counted from the wrong side, or about its forward axis, for one
/// that hangs upside down. poses: (x, y [m], yaw [rad]) of each pose of the graph.
///
/// Between the scans of a pair the laser, or one mounted alike, turned by 10 to 35 degrees and
/// moved by 2 m at most: a mirror image errs by twice the turn, which a room with corners forgives
/// at 45. Pairs that match about as well, or badly, both ways do not vote: round rooms, or poses
/// that are wrong. At most 48 pairs are looked at, whatever the size of the graph. Collective for a
/// shared graph: each process looks at its share of them, and all have the votes.
TurnVotes VoteOnTurns(const SlamGraph& graph, const std::vector<double>& poses);

/// Mean distance [m] of the returns of one scan of such a pair from the nearest ones of the other,
/// where a return without a counterpart counts as 0.5 m: low if the bearings of the beams go with
/// the poses. Empty if there are fewer than 8 pairs. Collective for a shared graph.
std::optional<double> TurnMismatch(const SlamGraph& graph, const std::vector<double>& poses);

/// InvalidArgument if the scans look mirrored to these poses, or to other ones that they may
/// start from, and right to neither. Mirrored scans still agree with each other where the poses
/// give way, so that no energy tells.
Status CheckScansAreNotMirrored(const SlamGraph& graph, const std::vector<double>& poses,
                                const std::optional<std::vector<double>>& other_poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_MIRRORED_SCANS_H_
