#ifndef PLUMBLINE_SOLVERS_SESSIONS_SESSION_SET_H_
#define PLUMBLINE_SOLVERS_SESSIONS_SESSION_SET_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/seeding/seed_drive.h"

namespace plumbline {

/// Sessions, side by side: drives that were seeded each by itself, one after the other in one
/// graph. No edge joins two of them. Processes that share the drives share the graph; each then has
/// all else, and what it does with a set is collective.
struct SessionSet {
  SessionSet() = default;
  SessionSet(const SessionSet&) = delete;  // the surfaces refer to the graph
  SessionSet& operator=(const SessionSet&) = delete;

  SlamGraph graph;  ///< of all sessions; its initial poses are the seeds
  /// Of the keyframes, by scans of the graph among all.
  ScanSurfaces surfaces{graph, std::vector<PackedSurface>()};
  std::vector<KeyframeGraph> keys;  ///< per session, by poses and scans of the graph
  /// Per session, by its own poses and scans.
  std::vector<SequentialTrajectory> matched;
  std::vector<int> first_pose{0};  ///< per session; then the number of poses
  std::vector<int> first_scan{0};  ///< likewise

  int size() const { return static_cast<int>(keys.size()); }
};

/// Appends a session: its graph, with measurements as the seeding corrected them, and its seed.
/// Fails where two graphs together exceed the limits of SlamGraph. FinishSet comes after the last.
Status AddSession(const SlamGraph& graph, SeededDrive drive, SessionSet* set);

/// Gives every process what the keyframes of all saw.
void FinishSet(ThreadPool* pool, SessionSet* set);

/// Sessions that are tied to each other.
struct SessionGroup {
  std::vector<int> sessions;   ///< in the order of their keyframes; the first one is the lowest
  std::vector<int> first_key;  ///< per session of the group; then the number of keyframes
  /// Of all of them, in the frame of the first session; those of the second session follow those of
  /// the first, and so on.
  KeyframeGraph keys;
  /// The two groups that were tied to make it; none for a single session.
  std::vector<SessionGroup> parts;
};

SessionGroup GroupOfOne(const SessionSet& set, int session);

/// The keyframes of b follow those of a, moved to where a_from_b puts them. No closure joins them
/// yet.
SessionGroup Concatenated(const SessionGroup& a, const SessionGroup& b, const Pose2& a_from_b);

/// A group of sessions as if it were one drive, to close its loops.
struct JoinedDrive {
  SlamGraph graph;                      ///< of the sessions, in the order of the group
  std::vector<PackedSurface> surfaces;  ///< of the keyframes, per scan (ScanSurfaces::kept)
  SequentialTrajectory matched;    ///< each session as rigid as it was before loops were closed
  KeyframeGraph ties;              ///< with the group's closures between sessions alone
  std::vector<int> first_pose{0};  ///< per session of the group; then the number of poses
  std::vector<int> first_scan{0};  ///< likewise
};

/// Joins the sessions of a group. motion: the noise of their odometry. Fails where they exceed the
/// limits of SlamGraph.
Status JoinDrives(const SessionSet& set, const SessionGroup& group, const MotionOptions& motion,
                  JoinedDrive* joined);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SESSIONS_SESSION_SET_H_
