#ifndef PLUMBLINE_SOLVERS_REDUCED_REDUCED_SOLVER_H_
#define PLUMBLINE_SOLVERS_REDUCED_REDUCED_SOLVER_H_

#include <string>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/interface/solver_summary.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"

namespace plumbline {

/// How a minimisation by rounds of landmarks went.
struct ReducedResult {
  std::vector<LandmarkRoundSummary> rounds;
  LineLandmarks first_cut;  ///< of the first round: the surfaces as the given poses place them
  /// The poses (x, y, yaw) before the last round, what came of them without the held-out returns,
  /// and the surfaces of that round.
  std::vector<double> fitted_poses;
  LineLandmarks fitted_cut;
  std::vector<LineLandmark> last_landmarks;  ///< the same with the lines that suit the final poses
  bool converged = false;
  bool stopped = false;  ///< by the callback
  bool usable = true;    ///< false: Ceres failed, the poses are the best before that
  double cutting_time_s = 0.0;
  double setup_time_s = 0.0;         ///< building problems for Ceres
  double minimization_time_s = 0.0;  ///< without the two above
  std::string stop_reason;           ///< with the numbers
};

/// Minimises the joint energy over the poses, with every point and every tangent line at its
/// optimum. In rounds: the surfaces, as the poses place them, are cut into landmarks; all that a
/// pose saw of a landmark becomes a handful of moments, weighted by a robust loss; Gauss-Newton
/// steps move the poses, with the lines eliminated from the linear system and refitted exactly
/// after each. A step that does not lower the cost is shortened, or not taken. The first round is
/// over returns with a normal only.
///
/// The rounds do without the held-out returns, see held_out_returns.h, and end when the last step
/// of one lowers the cost, and the round moves the returns, by less than the tolerances. A last
/// step takes all returns in, so that none is lost to the result; it is left out if the callback
/// stopped the rounds. Starts from the poses given, (x, y, yaw) each, and updates them. Bitwise the
/// same for any number of threads.
///
/// A group of poses that no term ties to a fixed one keeps its first pose. The graph must have
/// returns.
///
/// With `ceres`, which must pass CheckCeresOptions, Ceres minimises over poses and lines instead of
/// each Gauss-Newton step; weights, rounds and their end are the same. The last digits may then
/// depend on the number of threads.
ReducedResult MinimizeOverLandmarks(const SlamGraph& graph, const MeasuredSurface& surface,
                                    const FactorOptions& factors, const ReducedOptions& options,
                                    const AssociationOptions& association,
                                    const ProgressCallback& report, ThreadPool* pool,
                                    std::vector<double>* poses,
                                    const CeresOptions* ceres = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_REDUCED_SOLVER_H_
