#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_MAP_HYPOTHESIS_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_MAP_HYPOTHESIS_H_

#include <cstddef>
#include <memory>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/hypotheses/tied_places.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// What a hypothesis assumes beyond its start and its broken steps.
struct Assumptions {
  int num_removed = 0;   ///< clusters of closures removed, one by one
  int num_added = 0;     ///< closures added, one by one
  int num_strained = 0;  ///< broken steps whose slip strained the pose graph
};

/// The parts of the negative log posterior of a hypothesis, up to a constant; see Posterior.
struct EnergyTerms {
  FreeSpaceConflict conflict;  ///< within and between passes
  double assumptions = 0.0;    ///< cost of assumptions and contradictions [units]
  double relocated_m = 0.0;    ///< total size of the slips and relocations that are assumed [m]
};

/// One explanation of a drive, and the map that it makes.
struct MapHypothesis {
  HypothesisKind kind = HypothesisKind::kMatching;
  std::shared_ptr<const SequentialTrajectory> start;  ///< never null
  KeyframeGraph keys;
  LoopClosingReport loops;
  std::vector<Pose2> world_from_robot;  ///< per pose of the graph
  MapConsistency consistency;
  EnergyTerms terms;
  Assumptions assumed;
  std::vector<TiedPlace> bent_places;  ///< between several sessions
  int relocated_step = -1;  ///< kJoinedParts: the sequential edge at which it was relocated
  /// Index of the hypothesis among all weighed ones, then of the hypotheses it was made from.
  std::vector<std::size_t> records;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_MAP_HYPOTHESIS_H_
