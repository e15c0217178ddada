#ifndef PLUMBLINE_SOLVERS_SESSIONS_BENT_STRETCHES_H_
#define PLUMBLINE_SOLVERS_SESSIONS_BENT_STRETCHES_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// Where a session lies otherwise in a map of several than by its own seed: a metre of its path
/// that ends 0.2 m and more elsewhere. Its own scans follow each other more exactly than that; so
/// it was tied to what had moved since, or its own matching was wrong there. Of stretches that
/// overlap the one that is bent most. first_pose: id of its first pose in the map.
std::vector<BentStretch> FindBentStretches(const std::vector<Pose2>& own_seed,
                                           const std::vector<Pose2>& in_map, int first_pose);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SESSIONS_BENT_STRETCHES_H_
