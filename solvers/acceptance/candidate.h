#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_CANDIDATE_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_CANDIDATE_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/acceptance/compare_with_seed.h"
#include "plumbline/solvers/interface/acceptance.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"

namespace plumbline {

/// Finds where a state fits clearly worse than the seed, although it may be better as a whole:
/// stretches of 1, 2, 4 ... poses whose held-out error rises by more than one sigma^2 in the mean,
/// to more than twice the seed's, and by more than four standard deviations. A stretch that holds a
/// shorter one does not count. In order of the poses; they neither overlap nor touch. changes: one
/// per pose, see CompareWithSeed.
std::vector<WorseStretch> FindWorseStretches(const std::vector<PoseChange>& changes);

/// Puts stretches of a state back to the shape that the seed gave them, between the poses on either
/// side: the correction of these is shared out along the stretch. At an end of the drive a stretch
/// goes along with its one neighbour; without any it is the seed's. Fixed poses stay. seed, poses:
/// (x, y, yaw) each.
void PutBack(const std::vector<WorseStretch>& stretches, const std::vector<FixedPose>& fixed,
             const std::vector<double>& seed, std::vector<double>* poses);

/// Merges both lists, in order of the poses: stretches that overlap or touch become one, with the
/// errors of the one that has become worse by more.
std::vector<WorseStretch> MergeStretches(std::vector<WorseStretch> stretches,
                                         const std::vector<WorseStretch>& others);

/// Makes each stretch three times as long, about its middle and within the drive.
void WidenStretches(int num_poses, std::vector<WorseStretch>* stretches);

/// A state that may become the result of a solve.
struct Candidate {
  std::vector<double> poses;  ///< (x, y, yaw) each
  LineLandmarks cut;          ///< the surfaces as these place them, as ComparedState wants them
  AcceptanceTest acceptance;  ///< against the seed
  std::vector<WorseStretch> worse;  ///< where the seed is clearly better; see FindWorseStretches
  bool is_refuted = false;          ///< drawn by broken steps; see StepsAgainstState

  /// For a seed that is no yardstick for parts of the drive.
  void ForgetWorseStretches() {
    worse.clear();
    acceptance.num_worse_stretches = 0;
  }
};

/// Compares candidates with the seed and with each other. Bitwise the same for any number of
/// threads.
class CandidateEvaluator {
 public:
  /// Keeps references to all its arguments.
  CandidateEvaluator(const SlamGraph& graph, const MeasuredSurface& surface,
                     const FactorOptions& factors, const ComparedState& seed, ThreadPool* pool)
      : graph_(graph), surface_(surface), factors_(factors), seed_(seed), pool_(pool) {}

  /// Takes poses and cut over, and runs the acceptance test.
  Candidate Evaluate(std::vector<double> poses, LineLandmarks cut) const;

  /// Whether to take the second candidate, found with some steps downweighted, for the first, found
  /// with all of them. If these refute the first one, it is enough that the second is better than
  /// the seed. Compares by the factors of the evaluator, in which these steps are downweighted.
  bool IsPreferable(const Candidate& plain, const Candidate& downweighting) const;

  /// Puts the stretches that are clearly worse than the seed back, wider at each attempt, and runs
  /// the acceptance test anew. Returns what was put back; num_worse_stretches says how many
  /// stretches are worse all the same.
  std::vector<WorseStretch> PutBackWorse(Candidate* candidate) const;

 private:
  void Reevaluate(Candidate* candidate) const;

  const SlamGraph& graph_;
  const MeasuredSurface& surface_;
  const FactorOptions& factors_;
  const ComparedState seed_;
  ThreadPool* pool_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_CANDIDATE_H_
