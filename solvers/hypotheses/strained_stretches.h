#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_STRAINED_STRETCHES_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_STRAINED_STRETCHES_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"

namespace plumbline {

/// Squared error of the sequential edges from keyframe `first` to keyframe `end` that are not
/// broken.
double StepsChi2(const KeyframeGraph& keys, int first, int end);

/// Squared error of all of them and of the closures.
double GraphChi2(const KeyframeGraph& keys);

/// What a stretch of sequential edges may be off by, in squared errors, in a graph with so many
/// closures whose other edges and closures are off by chi2_of_others. Scans match better than their
/// covariances say: on sound drives the graph is off by a hundredth of what they allow. Closures
/// that end inside the stretch strain it as well, as much as closures do elsewhere.
double MostStrain(double chi2_of_others, std::size_t num_closures, int num_closures_inside);

/// Sequential edges from keyframe `first` to keyframe `end`.
struct StretchOfSteps {
  int first = 0, end = 0;
  int num_closures_inside = 0;  ///< that end in between
};

/// Those between the ends of neighbouring closures that are known to a decimetre. Others, along a
/// corridor, give way like the steps do.
std::vector<StretchOfSteps> StretchesBetweenClosures(const KeyframeGraph& keys);

/// Of each stretch between closures that strain it by more than it may be off, the step whose sides
/// agree worst. It is marked in `marked` (MarkWorstEdge). Steps that are off alone bend no other,
/// and are left out.
/// world_from_robot: per pose, as the sequential matching left it.
std::vector<int> MostStrainedSteps(const ScanSurfaces& surfaces,
                                   const std::vector<Pose2>& world_from_robot,
                                   const KeyframeGraph& keys, KeyframeGraph* marked);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_STRAINED_STRETCHES_H_
