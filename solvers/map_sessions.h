#ifndef PLUMBLINE_SOLVERS_MAP_SESSIONS_H_
#define PLUMBLINE_SOLVERS_MAP_SESSIONS_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/session_report.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

class ThreadPool;

/// The part of a map that one session is.
struct SessionOfMap {
  int session = 0;     ///< number of the session, from 0
  int first_pose = 0;  ///< pose id in the graph of the map; those of the session follow it
  int num_poses = 0;   ///< of the session
  int first_scan = 0;  ///< scan id, likewise
  int num_scans = 0;   ///< of the session
  /// What was found on the way to the session's own seed, by its own poses and scans.
  MappingReport report;
};

/// One map of the sessions that show the same place.
struct SessionMap {
  /// In the order of their poses; the first one has the lowest number.
  std::vector<SessionOfMap> sessions;
  /// As of one log that holds all of the sessions, one after the other, in the frame of the first
  /// one. No odometry leads from one to the next. The noise of its odometry is the largest of
  /// theirs, and so is that of its ranges.
  LogMapping mapping;
};

/// What became of several sessions.
struct SessionsMapping {
  std::vector<SessionMap> maps;  ///< each session is in one of them; in order of their first ones
  std::vector<SessionTie> ties;  ///< what was tied, and what was left apart and why
};

/// Maps several sessions (drives; logs) of one robot or of several, in any order, whose relative
/// poses are unknown: seeds each by itself, as MapLog does, ties those together that show the same
/// place, closes loops between them, and estimates poses and points of all that are tied jointly.
/// Sessions that cannot be tied get maps of their own. sessions: as MapLog wants its graph, at
/// least one, each with a scan. The result does not depend on the number of threads.
///
/// One session may be a finished map, all of whose poses are fixed (SlamGraph::FixPose): they stay
/// where they are, and what is tied to it is localised in its frame.
///
/// It is SeedSessions, and RefineLog for each map. InvalidArgument on what MapLog refuses, naming
/// the session, on a start other than the seed, a calibration, or a solver of pose graphs, and on a
/// session some of whose poses are fixed, or several with fixed poses.
Status MapSessions(const MapLogOptions& options, std::vector<SlamGraph> sessions,
                   const SeedingProgress& progress, SessionsMapping* mapping);

/// All of it up to where the joint estimation of each map starts. sessions: as TakeLog leaves them.
/// progress counts the scans or candidates of one session at a time. Processes that share the graph
/// of every session, as SeedLog wants it, tie them together (collective); then progress cannot stop
/// it, and InvalidArgument where SeedLog would give that.
Status SeedSessions(const MapLogOptions& options, std::vector<LogMapping> sessions,
                    const SeedingProgress& progress, ThreadPool* pool, SessionsMapping* mapping);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_MAP_SESSIONS_H_
