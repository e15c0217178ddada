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

/// A state that may become the result of a solve, and what is said of it as a whole and of its
/// parts.
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
  /// the seed. By the factors of the evaluator, in which these are downweighted: by the others
  /// their error would outweigh the map.
  bool IsPreferable(const Candidate& plain, const Candidate& downweighting) const;

  /// Puts back what is clearly worse than the seed, with more around it each time that this does
  /// not do, and runs the acceptance test anew. Gives what was put back; num_worse_stretches says
  /// how many stretches are worse all the same. Nothing changes without such stretches.
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
