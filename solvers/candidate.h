#ifndef PLUMBLINE_SOLVERS_CANDIDATE_H_
#define PLUMBLINE_SOLVERS_CANDIDATE_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/pose_change.h"
#include "plumbline/solvers/reduced/surface_patches.h"
#include "plumbline/solvers/verdict.h"

namespace plumbline {

/// A state that may become the result of a solve, and what is said of it as a whole and of its
/// parts.
struct Candidate {
  std::vector<double> poses;        ///< (x, y, yaw) each
  SurfacePatches cut;               ///< the surfaces as these place them, as JudgedState wants them
  Verdict verdict;                  ///< against the seed
  std::vector<WorseStretch> worse;  ///< where the seed is clearly better; see FindWorseStretches
};

/// Compares candidates with the seed and with each other. Bitwise the same for any number of
/// threads.
class CandidateJudge {
 public:
  /// Keeps references to all its arguments.
  CandidateJudge(const SlamGraph& graph, const MeasuredSurface& surface,
                 const FactorOptions& factors, const JudgedState& seed, ThreadPool* pool)
      : graph_(graph), surface_(surface), factors_(factors), seed_(seed), pool_(pool) {}

  /// Takes poses and cut over, and passes the verdict.
  Candidate Weigh(std::vector<double> poses, SurfacePatches cut) const;

  /// Whether to take the second candidate, found with some steps doubted, for the first, found with
  /// all of them. factors: those of the second. By the others the error of a doubted step would
  /// outweigh the map.
  bool IsPreferable(const Candidate& trusting, const Candidate& doubting) const;

  /// Puts back what is clearly worse than the seed, with more around it each time that this does
  /// not do, and passes the verdict anew. Gives what was put back; the verdict says how many
  /// stretches are worse all the same. Nothing changes without such stretches.
  std::vector<WorseStretch> PutBackWorse(Candidate* candidate) const;

 private:
  void Reweigh(Candidate* candidate) const;

  const SlamGraph& graph_;
  const MeasuredSurface& surface_;
  const FactorOptions& factors_;
  const JudgedState seed_;
  ThreadPool* pool_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_CANDIDATE_H_
