#ifndef PLUMBLINE_SOLVERS_FULL_JOINT_RUN_H_
#define PLUMBLINE_SOLVERS_FULL_JOINT_RUN_H_

#include <chrono>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/acceptance/candidate.h"
#include "plumbline/solvers/acceptance/contradicted_steps.h"
#include "plumbline/solvers/association/tangent_lines.h"
#include "plumbline/solvers/full/energy.h"
#include "plumbline/solvers/interface/inner_result.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"

namespace plumbline {

/// One solve of poses and map, from the choice of the start to the summary. What lies between, the
/// minimisation, is that of the derived class.
class JointRun {
 public:
  /// Keeps references to all that the problem holds, and to the seed.
  JointRun(const char* solver_name, const SolverProblem& problem, const MapState& seed);
  virtual ~JointRun() = default;
  JointRun(const JointRun&) = delete;
  JointRun& operator=(const JointRun&) = delete;

  /// Puts the best state into *result, which may be the seed; unless it is the seed.
  SolverSummary Run(MapState* result);

 protected:
  /// Goes from state_.poses, the start, to the result in state_, by way of the acceptance test, and
  /// sets best_energy_ and best_round_.
  virtual void Refine() = 0;
  /// Whether state_ is to be the result: it passes the acceptance test, unless the derived class
  /// only reports that.
  virtual bool IsAccepted() const { return summary_.acceptance.IsBetter(); }

  CandidateEvaluator Evaluator() {
    return {graph_, *surface_, factors_, {seed_.poses, seed_landmarks_}, &pool_};
  }
  /// The last minimisation was stopped or failed.
  bool Ended() const { return last_inner_.stopped || !last_inner_.usable; }
  /// Steps of the odometry to begin again without; none if the run has ended. Notes whether they
  /// refute what was found.
  std::vector<DownweightedStep> StepsAgainst(Candidate* found) const;
  void DownweightSteps(const std::vector<DownweightedStep>& steps);
  void RestoreSteps();
  /// The parts that are clearly worse than the seed's are put back, and then the whole has to be
  /// better. Only the whole counts if false edges have bent the seed: its parts are straight where
  /// these pull alike.
  void RunAcceptanceTest(Candidate* found);

  /// The surfaces as these poses place them, without what is held out.
  LineLandmarks CutSurfaces(const std::vector<double>& poses);
  /// The lines that the current poses give.
  TangentLines CurrentLines();
  double MarginalEnergyUnder(const TangentLines& lines);
  PointDisplacements Displacements();
  /// The initial cost first, and then the final one. Terms that are not chosen cost nothing.
  void RecordTerms(const Energy& energy, const MapState& state, double TermSummary::*cost,
                   const TermChoice& choice = nullptr);
  /// Keeps every iteration, numbered through, and hands it on.
  ProgressCallback ReportCallback();

  const SolverOptions& options_;
  FactorOptions factors_;  ///< the options', and steps of the odometry that turned out to be wrong
  const SlamGraph& graph_;
  const MapState& seed_;
  const double fine_radius_m_;
  ThreadPool pool_;
  const MeasuredSurface* surface_;  ///< what the caller has measured, or own_surface_
  LineLandmarks seed_landmarks_;    ///< the surfaces as the seed places them
  SolverSummary summary_;
  InnerResult last_inner_;
  bool converged_ = false;  ///< another round would gain next to nothing
  double best_energy_ = 0.0;
  int best_round_ = 0;     ///< 0: the start
  int rounds_before_ = 0;  ///< over landmarks: of earlier minimisations
  /// What the solvers move. Over landmarks its points are empty until the poses are found.
  MapState state_;

 private:
  void FindStart();
  void Conclude();
  TerminationType Termination() const;

  const std::optional<std::vector<double>>& suggested_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  MeasuredSurface own_surface_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_JOINT_RUN_H_
