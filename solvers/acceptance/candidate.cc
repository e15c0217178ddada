#include "plumbline/solvers/acceptance/candidate.h"

#include <utility>

#include "plumbline/solvers/acceptance/local_acceptance.h"

namespace plumbline {

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
