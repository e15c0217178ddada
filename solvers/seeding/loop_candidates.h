#ifndef PLUMBLINE_SOLVERS_SEEDING_LOOP_CANDIDATES_H_
#define PLUMBLINE_SOLVERS_SEEDING_LOOP_CANDIDATES_H_

#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/seeding/sequential_seeding.h"

namespace plumbline {

/// Which pairs of key scans may show the same place.
struct LoopCandidateOptions {
  /// How far the relative pose of two key scans may be off: a floor [m] plus this share of the
  /// shortest way between them over sequential edges and closures found so far.
  double drift_floor_m = 0.4;
  double drift_per_path = 0.025;
  /// The same for their relative heading [rad], [rad per m].
  double drift_floor_rad = 0.15;
  double drift_rad_per_m = 0.002;
  /// Key scans this near to each other [m] see enough of the same surfaces.
  double reach_m = 2.0;
  /// A revisit begins after this much path [m]: what is nearer is tied by the sequential matching.
  double min_path_m = 6.0;
  /// Closures are looked for from one key scan per this stretch of path [m].
  double spacing_m = 0.5;

  bool Check(std::string* error) const;
};

/// Two key scans, by index, first < second, and how far their relative pose may be off.
struct LoopCandidate {
  int first = 0;
  int second = 0;
  double drift_m = 0.0;
  double drift_rad = 0.0;
};

/// For every key scan and every earlier visit to its surroundings the nearest key scan of that
/// visit, unless `closures` (edges between key scans) has one of the kind already.
std::vector<LoopCandidate> FindLoopCandidates(const LoopCandidateOptions& options,
                                              const std::vector<KeyScan>& key_scans,
                                              const std::vector<Pose2>& world_from_key,
                                              const std::vector<RelativePoseConstraint>& closures);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_LOOP_CANDIDATES_H_
