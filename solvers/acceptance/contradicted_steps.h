#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_STEPS_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_STEPS_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/acceptance.h"

namespace plumbline {

/// Steps of the odometry that speak against a state.
struct StepsAgainstState {
  std::vector<DownweightedStep> steps;  ///< in order of the graph
  /// One of them at least is broken, and drew the state all the same: its energy says nothing for
  /// it.
  bool refute_state = false;
};

/// Steps of the odometry that the seed flatly contradicts, by more than six standard deviations and
/// 0.2 m or 0.2 rad, and that are broken or drew a state away from the seed. Broken is one that the
/// state contradicts as well, by more than 30 standard deviations and 0.2 m or 0.2 rad. The others
/// drew it away if within 16 poses lies one of the `worse` stretches, or a step that the seed keeps
/// to within three standard deviations and the state contradicts by more than six.
///
/// The motion terms are quadratic, the returns' robust: a step that is off by hundreds of standard
/// deviations tears the poses beside it from the map, or draws a stretch onto walls that look
/// alike. Each of these steps gets the factor that makes its error at the seed one standard
/// deviation. Where the state obeys the step and is no worse than the seed, the seed was wrong.
///
/// seed, state: (x, y, yaw) each. A step that `factors` downweights already is found again only if
/// it is contradicted even so.
StepsAgainstState FindStepsAgainst(const SlamGraph& graph, const FactorOptions& factors,
                                   const std::vector<double>& seed,
                                   const std::vector<double>& state,
                                   const std::vector<WorseStretch>& worse);

/// Steps within 16 poses of `first_poses_after`, poses right after a broken step, that the seed
/// flatly contradicts, with the factors as above. None for a seed of another size.
std::vector<DownweightedStep> FindBrokenSteps(const SlamGraph& graph, const FactorOptions& factors,
                                              const std::vector<double>& seed,
                                              const std::vector<int>& first_poses_after);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_STEPS_H_
