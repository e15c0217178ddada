#ifndef PLUMBLINE_SOLVERS_REDUCED_FREE_ISLANDS_H_
#define PLUMBLINE_SOLVERS_REDUCED_FREE_ISLANDS_H_

#include <vector>

#include "plumbline/solvers/pose_terms.h"
#include "plumbline/solvers/reduced/patch_sightings.h"

namespace plumbline {

/// Poses hang together if a pose term joins them or they see the same patch. Gives the first pose
/// of every group without a constant one: nothing says where such a group is as a whole.
/// Ascending.
std::vector<int> FindFreeIslands(const PatchSightings& sightings, const PoseTerms& terms);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_FREE_ISLANDS_H_
