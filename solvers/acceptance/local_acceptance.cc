#include "plumbline/solvers/acceptance/local_acceptance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/solvers/interface/acceptance.h"

namespace plumbline {
namespace {

// A rise that a map would show, and that chance does not bring about in a million stretches.
constexpr double kLeastRise = 1.0;  // [sigmas^2]
constexpr double kSigmas = 4.0;
// Fewer residuals say nothing.
constexpr int kFewestResiduals = 16;

bool IsClearlyWorse(const PoseChange& change) {
  if (change.num_residuals < kFewestResiduals) return false;
  const double rise = change.state_error - change.seed_error;
  return rise > kLeastRise * change.num_residuals && rise > change.seed_error &&
         rise > kSigmas * std::sqrt(change.squares);
}

WorseStretch StretchOf(int first, int last, const PoseChange& change) {
  return {first, last, change.seed_error / change.num_residuals,
          change.state_error / change.num_residuals};
}

// What took a pose from the seed to where it is: state = correction * seed.
Pose2 CorrectionOf(int pose, const std::vector<double>& seed, const std::vector<double>& poses) {
  return Pose2(&poses[3 * pose]) * Pose2(&seed[3 * pose]).Inverse();
}

// Both corrections of the same pose, mixed.
Pose2 Mix(const Pose2& a, const Pose2& b, double share_of_b) {
  return {a.x + share_of_b * (b.x - a.x), a.y + share_of_b * (b.y - a.y),
          a.yaw + share_of_b * NormalizeAngle(b.yaw - a.yaw)};
}

void PutBack(const WorseStretch& stretch, const std::vector<double>& seed,
             std::vector<double>* poses) {
  const int num_poses = static_cast<int>(seed.size() / 3);
  const bool has_before = stretch.first > 0, has_after = stretch.last + 1 < num_poses;
  Pose2 before, after;
  if (has_before) before = CorrectionOf(stretch.first - 1, seed, *poses);
  if (has_after) after = CorrectionOf(stretch.last + 1, seed, *poses);
  if (!has_before) before = after;
  if (!has_after) after = before;
  for (int pose = stretch.first; pose <= stretch.last; ++pose) {
    const double share = (pose - stretch.first + 1.0) / (stretch.last - stretch.first + 2.0);
    const Pose2 at_seed(&seed[3 * pose]);
    const Pose2 placed = Mix(before * at_seed, after * at_seed, share);
    (*poses)[3 * pose] = placed.x;
    (*poses)[3 * pose + 1] = placed.y;
    (*poses)[3 * pose + 2] = placed.yaw;
  }
}

}  // namespace

std::vector<WorseStretch> FindWorseStretches(const std::vector<PoseChange>& changes) {
  const int num_poses = static_cast<int>(changes.size());
  std::vector<WorseStretch> stretches;
  std::vector<PoseChange> sums = changes;         // of `length` poses from each on
  std::vector<char> is_worse(changes.size(), 0);  // by itself, or in a shorter stretch
  for (int length = 1; length <= num_poses; length *= 2) {
    const std::size_t num_shorter = stretches.size();
    int num_worse = static_cast<int>(std::count(is_worse.begin(), is_worse.begin() + length, 1));
    for (int first = 0; first + length <= num_poses; ++first) {
      if (num_worse == 0 && IsClearlyWorse(sums[first])) {
        stretches.push_back(StretchOf(first, first + length - 1, sums[first]));
      }
      if (first + length < num_poses) num_worse += is_worse[first + length] - is_worse[first];
    }
    for (std::size_t i = num_shorter; i < stretches.size(); ++i) {
      std::fill_n(is_worse.begin() + stretches[i].first, length, 1);
    }
    for (int first = 0; first + 2 * length <= num_poses; ++first) {
      sums[first] += sums[first + length];
    }
  }
  return MergeStretches(std::move(stretches), {});
}

std::vector<WorseStretch> MergeStretches(std::vector<WorseStretch> stretches,
                                         const std::vector<WorseStretch>& others) {
  stretches.insert(stretches.end(), others.begin(), others.end());
  std::sort(stretches.begin(), stretches.end(), [](const WorseStretch& a, const WorseStretch& b) {
    return a.first != b.first ? a.first < b.first : a.last < b.last;
  });
  std::vector<WorseStretch> merged;
  for (const WorseStretch& next : stretches) {
    if (merged.empty() || next.first > merged.back().last + 1) {
      merged.push_back(next);
      continue;
    }
    WorseStretch& stretch = merged.back();
    stretch.last = std::max(stretch.last, next.last);
    if (next.state_error - next.seed_error > stretch.state_error - stretch.seed_error) {
      stretch.seed_error = next.seed_error;
      stretch.state_error = next.state_error;
    }
  }
  return merged;
}

void WidenStretches(int num_poses, std::vector<WorseStretch>* stretches) {
  for (WorseStretch& stretch : *stretches) {
    const int length = stretch.last - stretch.first + 1;
    stretch.first = std::max(0, stretch.first - length);
    stretch.last = std::min(num_poses - 1, stretch.last + length);
  }
}

void PutBack(const std::vector<WorseStretch>& stretches, const std::vector<FixedPose>& fixed,
             const std::vector<double>& seed, std::vector<double>* poses) {
  const std::vector<double> before = *poses;
  for (const WorseStretch& stretch : stretches) PutBack(stretch, seed, poses);
  for (const FixedPose& pose : fixed) {
    const auto from = before.begin() + 3 * pose.pose;
    std::copy(from, from + 3, poses->begin() + 3 * pose.pose);
  }
}

}  // namespace plumbline
