#ifndef PLUMBLINE_SOLVERS_INTERFACE_SOLVER_OPTIONS_H_
#define PLUMBLINE_SOLVERS_INTERFACE_SOLVER_OPTIONS_H_

#include <functional>
#include <memory>
#include <string>

#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/association_options.h"
#include "plumbline/solvers/interface/built_in_solvers.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

class PoseSystemSolver;

// Numbers of rounds and iterations are up to 1e9, so that the sum of two is an int; tolerances are
// fractions, up to 1.

/// The reduced solver.
struct ReducedOptions {
  /// A round cuts the surfaces into landmarks anew, weighs the returns and takes a step. The first
  /// of several leaves out returns without a normal.
  int max_rounds = 20;
  /// Rounds end, but never with the first, when one lowers the cost by less than this fraction of
  /// it and hardly moves the returns. One step with all returns follows.
  double relative_tolerance = 2e-2;
  /// The lines follow the poses: refitted exactly after each step, which knows that they will be.
  /// Otherwise they are fixed within a round, as in the published alternation, and the poses creep.
  bool lines_follow = true;
  /// Of the engine of another library, see pose_system_solver.h; null: conjugate gradients of our
  /// own.
  std::shared_ptr<const PoseSystemSolver> linear_solver;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// Alternating conjugate gradients on one set of associations.
struct AlternatingCgOptions {
  /// A sweep moves the map with the poses fixed, then the poses with the map fixed, then the poses
  /// with each scan carrying its points along.
  int max_sweeps = 10;
  /// Iterations of the third part; 0: without it. The other two have one each. A pose that its
  /// beams hold to its points, but the map hardly holds (along a corridor), then takes many sweeps.
  int scan_iterations_per_sweep = 4;
  /// Ends when a sweep lowers the cost by less than this fraction.
  double relative_cost_tolerance = 1e-3;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// The method as it was published (published_method.cc says what is taken from where).
struct PublishedOptions {
  /// Passes, at most. Each finds the tangent lines and shape pairs of the map anew. Passes end once
  /// several in a row have not predicted held-out ranges better: more would only bend the map.
  int max_passes = 100;
  /// Takes sigma_M from the start: the root mean square distance of its points from their tangent
  /// lines, as the paper defines it, in place of ManifoldOptions::sigma_m.
  bool sigma_from_start = false;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

struct CeresOptions;

/// Holds a CeresOptions by value, so that only those who look into it, by `->` or `*`, have to
/// include ceres_options.h, and with it headers of Ceres.
class CeresOptionsValue {
 public:
  CeresOptionsValue();                                           ///< the defaults
  CeresOptionsValue(const CeresOptionsValue& other);             ///< with options of its own
  CeresOptionsValue& operator=(const CeresOptionsValue& other);  ///< likewise
  ~CeresOptionsValue();

  CeresOptions& operator*() { return *options_; }                    ///< the options
  const CeresOptions& operator*() const { return *options_; }        ///< the options
  CeresOptions* operator->() { return options_.get(); }              ///< the options
  const CeresOptions* operator->() const { return options_.get(); }  ///< the options

  /// CeresOptions::Check.
  bool Check(std::string* error) const;

 private:
  std::unique_ptr<CeresOptions> options_;  // never null
};

/// The outer loop. Each round rebuilds the associations and minimises the energy; a round that does
/// not lower the marginal energy is undone. Coarse rounds, with wide neighbourhoods and gates, pull
/// double walls together and end at the first one that does not help; fine rounds follow, until one
/// gains next to nothing. With a
/// noisy scanner all radii are at least five standard deviations of a return off its surface: over
/// less, noise looks like clutter.
struct RoundOptions {
  int max_coarse_rounds = 4;  ///< may be 0
  int max_fine_rounds = 8;    ///< at least 1
  /// Smallest neighbourhood radius [m] of the first coarse round: wide enough to reach across a
  /// double wall. Later coarse rounds go down to the fine radius in geometric steps. Radii are from
  /// a millimetre, less than any wall is thick, to 100 m, more than a scan sees.
  double coarse_radius_m = 0.3;
  /// Smallest neighbourhood radius [m] of the fine rounds: narrow enough not to blur a surface.
  double fine_radius_m = 0.1;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// Called after each iteration, on the thread that called the solver; false asks it to stop with
/// the best state so far, within one more iteration. What it throws ends the solve: kFailure with
/// the message of the exception, and the state unchanged.
using ProgressCallback = std::function<bool(const IterationSummary&)>;

/// What Solve goes by. The defaults suit buildings and a laser of the SICK class: set the noise of
/// your own in factors.beam.
struct SolverOptions {
  SolverType type = SolverType::kReduced;  ///< the minimiser
  /// A minimiser of the host instead of `type`, see rounds_solver.h; null: none.
  std::shared_ptr<const Solver> own_solver;
  FactorOptions factors;  ///< noise and gates of every term
  /// Whether Solve tests relative poses by the scans of their poses, and ignores those that these
  /// contradict; see contradicted_edges.h. Off: edges that know more than the scans.
  bool test_edges = true;
  AssociationOptions association;       ///< which returns share a surface
  RoundOptions rounds;                  ///< kAlternatingCg, and kCeres over points
  ReducedOptions reduced;               ///< kReduced, and kCeres over landmarks
  AlternatingCgOptions alternating_cg;  ///< kAlternatingCg
  PublishedOptions published;           ///< kPublished
  CeresOptionsValue ceres;              ///< kCeres; see ceres_options.h
  /// Threads, the calling one included, up to 1024. Results do not depend on it, but for the last
  /// digits of kCeres, since Ceres adds up as threads finish.
  int num_threads = 2;
  /// Fills in SolverSummary::round_energies once the solve is done, of graphs with returns. That
  /// takes as long as finding the lines of every return once per round.
  bool measure_rounds = false;
  ProgressCallback callback;  ///< may be empty

  /// Whether surfaces are cut into landmarks and points eliminated, by whichever solver.
  bool IsOverLandmarks() const;
  /// Whether the solver looks at relative poses only, so that points just ride along.
  bool MovesPosesOnly() const;

  /// False if a field is out of range, or if the fields do not go together; *error, if not null,
  /// then names them, and the bound or the reason.
  bool Check(std::string* error) const;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_SOLVER_OPTIONS_H_
