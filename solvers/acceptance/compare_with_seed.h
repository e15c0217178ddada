#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_COMPARE_WITH_SEED_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_COMPARE_WITH_SEED_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/acceptance.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"

namespace plumbline {

/// Poses, (x, y, yaw) each, and the surfaces as they place them: as CutIntoLandmarks gives them
/// with hold_out.
struct ComparedState {
  const std::vector<double>& poses;
  const LineLandmarks& landmarks;
};

/// What the held-out returns of one pose say of two states: sums over their residuals, one per
/// return and landmark, under the landmarks that the seed and the state give, of rho(d^2 / s^2);
/// see AcceptanceTest.
struct PoseChange {
  int num_residuals = 0;
  double seed_error = 0.0;   ///< [sigmas^2]
  double state_error = 0.0;  ///< [sigmas^2]
  /// Sum over the returns of the squared change of the error of each [sigmas^4].
  double squares = 0.0;

  PoseChange& operator+=(const PoseChange& other) {
    num_residuals += other.num_residuals;
    seed_error += other.seed_error;
    state_error += other.state_error;
    squares += other.squares;
    return *this;
  }
};

/// Compares a state with the seed. Returns without a normal do not count: which landmark they are
/// on depends on the state. The result does not depend on the number of threads. changes: one per
/// pose, or null.
AcceptanceTest CompareWithSeed(const SlamGraph& graph, const MeasuredSurface& surface,
                               const FactorOptions& factors, const ComparedState& seed,
                               const ComparedState& state, ThreadPool* pool,
                               std::vector<PoseChange>* changes = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_COMPARE_WITH_SEED_H_
