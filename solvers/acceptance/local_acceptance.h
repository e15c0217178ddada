#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_LOCAL_ACCEPTANCE_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_LOCAL_ACCEPTANCE_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/acceptance/pose_change.h"
#include "plumbline/solvers/interface/acceptance.h"

namespace plumbline {

/// Where a state of the poses fits its own drive clearly worse than the seed, although the whole
/// may fit better: stretches of 1, 2, 4 ... poses whose held-out error rises by more than
/// one sigma^2 in the mean, to more than twice the seed's, and by more than four standard
/// deviations of what chance does. A stretch that holds a shorter one does not count: what is worse
/// is only that. In order of the poses; they neither overlap nor touch. changes:
/// one per pose, see CompareWithSeed.
std::vector<WorseStretch> FindWorseStretches(const std::vector<PoseChange>& changes);

/// Puts stretches of a state back to the shape that the seed gave them, and lays them between the
/// poses on either side: what these have moved from the seed's is shared out along the stretch. At
/// an end of the drive a stretch goes along with its one neighbour; without any it is the seed's.
/// Fixed poses stay. seed, poses: (x, y, yaw) each.
void PutBack(const std::vector<WorseStretch>& stretches, const std::vector<FixedPose>& fixed,
             const std::vector<double>& seed, std::vector<double>* poses);

/// Both lists as one, in order of the poses: what overlaps or touches becomes one stretch, with the
/// errors of the one that has become worse by more.
std::vector<WorseStretch> MergeStretches(std::vector<WorseStretch> stretches,
                                         const std::vector<WorseStretch>& others);

/// Makes each stretch three times as long, with as much on either side as it had, within the drive.
void WidenStretches(int num_poses, std::vector<WorseStretch>* stretches);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_LOCAL_ACCEPTANCE_H_
