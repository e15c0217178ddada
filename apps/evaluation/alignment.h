#ifndef PLUMBLINE_APPS_EVALUATION_ALIGNMENT_H_
#define PLUMBLINE_APPS_EVALUATION_ALIGNMENT_H_

#include <vector>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// The motion truth_from_world that brings the estimated positions closest to the true ones, in the
/// least-squares sense (Umeyama 1991, without scale). The two are paired by index, and there is at
/// least one pair. A robot that never moves leaves the heading open: it then comes from the first
/// pair.
Pose2 AlignTrajectories(const std::vector<Pose2>& world_from_robot,
                        const std::vector<Pose2>& truth_from_robot);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_ALIGNMENT_H_
