#include "plumbline/solvers/acceptance/candidate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"

namespace plumbline {
namespace {

// Least mean rise of the error of a worse stretch [sigmas^2], and least significance of its sum
// [standard deviations]: visible in a map, and not brought about by chance in a million stretches.
constexpr double kMinRise = 1.0;
constexpr double kMinSigmas = 4.0;
constexpr int kMinResiduals = 16;

bool IsClearlyWorse(const PoseChange& change) {
  if (change.num_residuals < kMinResiduals) return false;
  const double rise = change.state_error - change.seed_error;
  return rise > kMinRise * change.num_residuals && rise > change.seed_error &&
         rise > kMinSigmas * std::sqrt(change.squares);
}

WorseStretch StretchOf(int first, int last, const PoseChange& change) {
  return {first, last, change.seed_error / change.num_residuals,
          change.state_error / change.num_residuals};
}

// The correction of a pose: state = correction * seed.
Pose2 CorrectionOf(int pose, const std::vector<double>& seed, const std::vector<double>& poses) {
  return Pose2(&poses[3 * pose]) * Pose2(&seed[3 * pose]).Inverse();
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
    const Pose2 a = before * at_seed, b = after * at_seed;
    (*poses)[3 * pose] = a.x + share * (b.x - a.x);
    (*poses)[3 * pose + 1] = a.y + share * (b.y - a.y);
    (*poses)[3 * pose + 2] = a.yaw + share * NormalizeAngle(b.yaw - a.yaw);
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

Candidate CandidateEvaluator::Evaluate(std::vector<double> poses, LineLandmarks cut) const {
  Candidate candidate;
  candidate.poses = std::move(poses);
  candidate.cut = std::move(cut);
  Reevaluate(&candidate);
  return candidate;
}

void CandidateEvaluator::Reevaluate(Candidate* candidate) const {
  std::vector<PoseChange> changes;
  candidate->acceptance = CompareWithSeed(graph_, surface_, factors_, seed_,
                                          {candidate->poses, candidate->cut}, pool_, &changes);
  candidate->worse = FindWorseStretches(changes);
  candidate->acceptance.num_worse_stretches = static_cast<int>(candidate->worse.size());
}

bool CandidateEvaluator::IsPreferable(const Candidate& plain,
                                      const Candidate& downweighting) const {
  if (!downweighting.acceptance.IsBetterAsAWhole()) return false;
  if (plain.is_refuted || !plain.acceptance.IsBetterAsAWhole()) return true;
  return CompareWithSeed(graph_, surface_, factors_, {plain.poses, plain.cut},
                         {downweighting.poses, downweighting.cut}, pool_)
      .LowersEnergy();
}

std::vector<WorseStretch> CandidateEvaluator::PutBackWorse(Candidate* candidate) const {
  constexpr int kMaxAttempts = 4;
  const std::vector<double> poses = candidate->poses;
  std::vector<WorseStretch> stretches;
  for (int attempt = 0; attempt < kMaxAttempts && !candidate->worse.empty(); ++attempt) {
    if (attempt > 0) WidenStretches(graph_.num_poses(), &stretches);
    stretches = MergeStretches(std::move(stretches), candidate->worse);
    candidate->poses = poses;
    PutBack(stretches, graph_.fixed_poses(), seed_.poses, &candidate->poses);
    Reevaluate(candidate);
  }
  return stretches;
}

}  // namespace plumbline
