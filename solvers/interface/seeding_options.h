#ifndef PLUMBLINE_SOLVERS_INTERFACE_SEEDING_OPTIONS_H_
#define PLUMBLINE_SOLVERS_INTERFACE_SEEDING_OPTIONS_H_

#include <functional>
#include <string>

namespace plumbline {

/// Where the joint estimation starts.
enum class StartType {
  kOdometry,        ///< the odometry as it is
  kIcp,             ///< each scan matched to the one before it, point to point (Besl & McKay 1992)
  kIcpPointToLine,  ///< likewise, point to line (Chen & Medioni 1991)
  kIcpGlobal,       ///< after that every scan matched to all that see the same place, jointly
  kSeed,            ///< matching against local maps, and loop closure: SeedGraph
};
/// "odometry", "icp", "icp_point_to_line", "icp_global" or "seed".
const char* ToString(StartType type);
/// The inverse; false, with *type unchanged, for another name.
bool FromString(const std::string& name, StartType* type);

/// How SeedGraph goes about it: matching and loop closure from odometry and scans alone.
struct SeedingOptions {
  /// Scans are matched against a local map of keyframes. A scan becomes one when no keyframe of the
  /// local map is within this distance [m] and 20 degrees of it: a robot that turns on the spot
  /// does not flush its map. From 1e-3, below which every scan is one, to 100 m, beyond which the
  /// local map sees no walls of the last one.
  double keyframe_distance_m = 0.25;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

enum class SeedingPhase {
  kMatchingScans,  ///< in scans
  kClosingLoops,   ///< in candidates of a round
  kTyingSessions,  ///< in pairs of groups of sessions; sessions that are tied early need fewer
};

/// Called now and then with what has been done of a phase; false stops the seeding with an error.
/// num_total 0: nothing is counted, the call only asks whether to go on.
using SeedingProgress = std::function<bool(SeedingPhase phase, int num_done, int num_total)>;

/// Calls progress, which may be empty, but goes on whatever that says: for one of several processes
/// that work together, since the others would wait for it. Refers to progress.
inline SeedingProgress Unstoppable(const SeedingProgress& progress) {
  return [&progress](SeedingPhase phase, int num_done, int num_total) {
    if (progress) progress(phase, num_done, num_total);
    return true;
  };
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_SEEDING_OPTIONS_H_
