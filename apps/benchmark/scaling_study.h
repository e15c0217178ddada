#ifndef PLUMBLINE_APPS_BENCHMARK_SCALING_STUDY_H_
#define PLUMBLINE_APPS_BENCHMARK_SCALING_STUDY_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// What a solve of one size came to.
struct ScalingOutcome {
  int num_scans = 0;
  std::string failure;  ///< why there is nothing else; empty if there is
  std::size_t num_returns = 0;
  double building_length_m = 0.0;
  double simulation_time_s = 0.0;  ///< of building, drive and graph
  double time_s = 0.0;             ///< of Solve
  double cpu_time_s = 0.0;         ///< likewise, of all threads together
  double association_time_s = 0.0, minimization_time_s = 0.0;  ///< parts of it
  int num_rounds = 0;
  int num_steps = 0;
  int num_linear_iterations = 0;       ///< of conjugate gradients, over all steps
  std::size_t num_landmarks = 0;       ///< pieces of surface in the last round
  std::size_t num_observations = 0;    ///< pairs of a pose and a landmark likewise
  std::size_t graph_memory_bytes = 0;  ///< resident with the graph, before the solve
  std::size_t peak_memory_bytes = 0;   ///< resident in the solve, at most
  /// Mean over the poses, after the rigid motion that fits best. A drive of kilometres bends more
  /// than any local start is off: the truth is not the most likely map of noisy data.
  double pose_error_before_m = 0.0, pose_error_after_m = 0.0;
  double step_error_before_m = 0.0, step_error_after_m = 0.0;  ///< mean over steps of 10 m of path

  double TimePerMillionReturns() const { return 1e6 * time_s / num_returns; }
  double BytesPerReturn() const {
    return static_cast<double>(peak_memory_bytes) / static_cast<double>(num_returns);
  }
};

/// Measures the joint estimation alone, without seeding: drives through a large office floor, whose
/// length grows with the number of scans, with 300 beams over 180 deg and a scan every 0.11 m. The
/// odometry is noisy but has no systematic error, as after seeding; the start is the truth under a
/// smooth drift of a few centimetres and 0.2 deg. `num_scans` must be positive. The reduced solver,
/// whatever the options say.
ScalingOutcome RunScalingCase(int num_scans, const SolverOptions& options);

/// The same in a process of its own. One that comes to a bad end is a failure of this case.
ScalingOutcome RunScalingCaseInChild(int num_scans, const SolverOptions& options);

/// "1000,3000" as numbers. InvalidArgument on anything that is not positive numbers and commas.
Status ParseScanCounts(const std::string& text, std::vector<int>* counts);

/// The heading of a table for people, and the row of one outcome; both end with a line feed.
std::string ScalingHeader();
std::string ScalingRow(const ScalingOutcome& outcome);

/// One line per outcome; figures of a failed one are empty. Unavailable if the file
/// cannot be written.
Status WriteScalingCsv(const std::string& path, const std::vector<ScalingOutcome>& outcomes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SCALING_STUDY_H_
