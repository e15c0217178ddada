#ifndef PLUMBLINE_SOLVERS_REDUCED_UNANCHORED_COMPONENTS_H_
#define PLUMBLINE_SOLVERS_REDUCED_UNANCHORED_COMPONENTS_H_

#include <vector>

#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

/// Poses hang together if a pose term joins them or they see the same landmark. Gives the first
/// pose of every group without a constant one, or one that a term ties to the world: nothing says
/// where such a group is as a whole. Ascending.
std::vector<int> FindUnanchoredComponents(const LineObservations& observations,
                                          const PoseTerms& terms);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_UNANCHORED_COMPONENTS_H_
