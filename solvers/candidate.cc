#include "plumbline/solvers/candidate.h"

#include <utility>

#include "plumbline/solvers/local_acceptance.h"

namespace plumbline {

Candidate CandidateJudge::Weigh(std::vector<double> poses, SurfacePatches cut) const {
  Candidate candidate;
  candidate.poses = std::move(poses);
  candidate.cut = std::move(cut);
  Reweigh(&candidate);
  return candidate;
}

void CandidateJudge::Reweigh(Candidate* candidate) const {
  std::vector<PoseChange> changes;
  candidate->verdict = CompareWithSeed(graph_, surface_, factors_, seed_,
                                       {candidate->poses, candidate->cut}, pool_, &changes);
  candidate->worse = FindWorseStretches(changes);
  candidate->verdict.num_worse_stretches = static_cast<int>(candidate->worse.size());
}

bool CandidateJudge::IsPreferable(const Candidate& trusting, const Candidate& doubting) const {
  if (!doubting.verdict.IsBetterAsAWhole()) return false;
  if (!trusting.verdict.IsBetterAsAWhole()) return true;
  return CompareWithSeed(graph_, surface_, factors_, {trusting.poses, trusting.cut},
                         {doubting.poses, doubting.cut}, pool_)
      .LowersEnergy();
}

std::vector<WorseStretch> CandidateJudge::PutBackWorse(Candidate* candidate) const {
  constexpr int kMaxAttempts = 4;
  const std::vector<double> poses = candidate->poses;
  std::vector<WorseStretch> stretches;
  for (int attempt = 0; attempt < kMaxAttempts && !candidate->worse.empty(); ++attempt) {
    if (attempt > 0) WidenStretches(graph_.num_poses(), &stretches);
    stretches = MergeStretches(std::move(stretches), candidate->worse);
    candidate->poses = poses;
    PutBack(stretches, graph_.fixed_poses(), seed_.poses, &candidate->poses);
    Reweigh(candidate);
  }
  return stretches;
}

}  // namespace plumbline
