#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_COMPARE_WITH_SEED_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_COMPARE_WITH_SEED_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/acceptance/pose_change.h"
#include "plumbline/solvers/interface/acceptance.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"

namespace plumbline {

/// Poses, (x, y, yaw) each, and the surfaces as they place them: as CutIntoLandmarks gives them
/// with hold_out.
struct ComparedState {
  const std::vector<double>& poses;
  const LineLandmarks& landmarks;
};

/// Compares a state with the seed. Returns without a normal have no say: which landmark they are on
/// depends on the state, which they would speak for. The result does not depend on the number of
/// threads. changes: if given, what the held-out returns of each pose say.
AcceptanceTest CompareWithSeed(const SlamGraph& graph, const MeasuredSurface& surface,
                               const FactorOptions& factors, const ComparedState& seed,
                               const ComparedState& state, ThreadPool* pool,
                               std::vector<PoseChange>* changes = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_COMPARE_WITH_SEED_H_
