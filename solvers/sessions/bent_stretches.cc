#include "plumbline/solvers/sessions/bent_stretches.h"

#include <cstddef>

namespace plumbline {
namespace {

constexpr double kStretchM = 1.0;  // of path
constexpr double kMinBendM = 0.2;  // a fifth of it: neither odometry nor matching errs so much

}  // namespace

std::vector<BentStretch> FindBentStretches(const std::vector<Pose2>& own_seed,
                                           const std::vector<Pose2>& in_map, int first_pose) {
  std::vector<double> path_m(own_seed.size(), 0.0);
  for (std::size_t i = 1; i < own_seed.size(); ++i) {
    path_m[i] = path_m[i - 1] + Between(own_seed[i - 1], own_seed[i]).translation().norm();
  }
  std::vector<BentStretch> bent;
  std::size_t from = 0;
  for (std::size_t to = 1; to < own_seed.size(); ++to) {
    while (from + 1 < to && path_m[to] - path_m[from + 1] >= kStretchM) ++from;
    const double bend_m = (Between(own_seed[from], own_seed[to]).translation() -
                           Between(in_map[from], in_map[to]).translation())
                              .norm();
    if (bend_m < kMinBendM) continue;
    const BentStretch stretch{first_pose + static_cast<int>(from),
                              first_pose + static_cast<int>(to), bend_m};
    if (bent.empty() || bent.back().last_pose < stretch.first_pose) {
      bent.push_back(stretch);
    } else if (bent.back().bend_m < bend_m) {
      bent.back() = stretch;
    }
  }
  return bent;
}

}  // namespace plumbline
