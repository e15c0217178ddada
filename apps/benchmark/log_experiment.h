#ifndef PLUMBLINE_APPS_BENCHMARK_LOG_EXPERIMENT_H_
#define PLUMBLINE_APPS_BENCHMARK_LOG_EXPERIMENT_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/published_figures.h"
#include "plumbline/apps/evaluation/map_sharpness.h"
#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/apps/figures/map_figure.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/front_end/pairwise_icp.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

struct LogExperimentInputs {
  std::string log;            ///< raw CARMEN log
  std::string relations;      ///< its true relative poses, see ReadRelations; empty: none
  std::string corrected_log;  ///< the drive as another mapper corrected it; empty: none
  SeedingOptions seeding;
  SolverOptions solver;
  PairwiseIcpOptions icp;  ///< its metric does not count: both are run
};

/// One method's result.
struct LogStage {
  std::string name;
  double time_s = 0.0;  ///< wall time [s] of what leads here from the stages before
  std::optional<RelationsMetric> relations;
  MapSharpness raw_ranges;             ///< of the measured ends of the beams at the poses
  std::optional<MapSharpness> points;  ///< of the optimised points, where there are such
};

/// Stages that follow from one start.
struct LogStart {
  std::string name;
  int num_scans = 0;
  std::size_t num_returns = 0;
  std::vector<LogStage> stages;
};

struct LogExperiment {
  std::string log;  ///< name of the file
  std::vector<LogStart> starts;
  std::vector<PublishedFigure> published;  ///< for the relations
  MapFigure maps;                          ///< of the baselines and of the result
};

/// Maps the log by the baselines (pairwise ICP, with both metrics; stochastic gradient descent on
/// the seed's pose graph, from the sequential matching), by the published method, which starts from
/// one ICP over all scans, as a seed and refined. With a corrected log, also refines its scans from
/// the corrected poses, which then stand for the odometry, and maps them from the raw odometry as
/// the whole log. `done` is called after each stage.
///
/// The figure has the maps of ICP (point to line), SGD, the published method and the refined one;
/// with a corrected log, of its scans from the raw odometry. They lie upon the refined map by their
/// trajectories; its two details are where SGD and the refined map differ most. Everything but the
/// times is the same for any number of threads.
///
/// Fails like the readers, SeedGraph, ChainPairs, Solve and PairCorrectedLog.
Status RunLogExperiment(const LogExperimentInputs& inputs,
                        const std::function<void(const LogStart&, const LogStage&)>& done,
                        LogExperiment* experiment);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_LOG_EXPERIMENT_H_
