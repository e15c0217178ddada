#ifndef PLUMBLINE_APPS_EVALUATION_EVALUATION_H_
#define PLUMBLINE_APPS_EVALUATION_EVALUATION_H_

#include <cstddef>
#include <optional>
#include <string>

#include "plumbline/apps/evaluation/map_sharpness.h"
#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/apps/evaluation/trajectory_metrics.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// What to measure: a trajectory against what is known of it, and maps by themselves. An empty path
/// leaves out what it would give.
struct EvaluationInputs {
  std::string trajectory;  ///< TUM file
  std::string relations;   ///< file of true relative poses, see ReadRelations
  std::string truth;       ///< TUM file
  std::string log;         ///< CARMEN log, its ranges mapped at the poses of the trajectory
  std::string points;      ///< PLY file of map points, see ReadPointsPly
  RelationsOptions relations_options;
  TrajectoryMetricsOptions trajectory_options;
};

struct Evaluation {
  std::optional<RelationsMetric> relations;
  std::optional<TrajectoryMetrics> trajectory;
  /// Poses and true poses were paired by order, as their clock is useless.
  bool truth_by_order = false;
  /// Of the log's ranges at the trajectory's poses; scans without a pose are left out.
  std::optional<MapSharpness> raw_ranges;
  std::optional<MapConsistency> consistency;
  std::size_t num_scans_without_pose = 0;
  bool log_by_order = false;  ///< likewise: scans and poses
  std::optional<MapSharpness> points;
};

/// InvalidArgument if the inputs name nothing to measure or an option is out of range. Opens no
/// file.
Status CheckInputs(const EvaluationInputs& inputs);

/// Reads and measures everything that the inputs name. Fails like CheckInputs, with InvalidArgument
/// if a trajectory shares no time with what it is measured against or if useless clocks leave open
/// what belongs together, else as the readers say of a file.
Status Evaluate(const EvaluationInputs& inputs, Evaluation* evaluation);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_EVALUATION_H_
