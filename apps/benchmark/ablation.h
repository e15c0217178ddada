#ifndef PLUMBLINE_APPS_BENCHMARK_ABLATION_H_
#define PLUMBLINE_APPS_BENCHMARK_ABLATION_H_

#include <limits>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/map_errors.h"
#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// The joint estimation with one part of it changed.
struct AblationVariant {
  std::string name;
  SolverOptions options;
};

/// The full form first, then one part at a time left out, put in or changed.
std::vector<AblationVariant> AblationVariants(const SolverOptions& full);

/// A graph with the seed that all variants start from, and what is known of the truth.
struct AblationInput {
  SlamGraph graph;
  MapState seed;
  MapEstimate truth;  ///< in the frame of the first pose; empty if not known
  std::vector<Relation> relations;
  /// The full form, told the noise of this input's laser.
  SolverOptions full;
};

/// What a variant made of an input; NaN for what cannot be known.
struct AblationOutcome {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  double pose_m = kUnknown;  ///< mean error
  /// The same after the best rigid fit: much less than pose_m where the first pose is off its map.
  double fitted_pose_m = kUnknown;
  double point_m = kUnknown;      ///< mean error
  double relations_m = kUnknown;  ///< mean error
  double thickness_m = kUnknown;
  double entropy = kUnknown;  ///< mean map entropy [nat]
  /// Marginal energy of its poses under the full form's options: the same yardstick for all.
  double energy = kUnknown;
};

/// The seed itself comes first, then the variants. InvalidArgument if a variant is refused.
Status RunAblation(const AblationInput& input, ThreadPool* pool,
                   std::vector<AblationOutcome>* outcomes);

/// Figures of all variants on inputs of one kind.
struct AblationTable {
  std::string inputs;                                  ///< what they are; for people
  std::vector<std::string> names;                      ///< "seed" and the variants
  std::vector<std::vector<AblationOutcome>> outcomes;  ///< per input, in order of the names
};

/// 16 scans each through the buildings 1 to num_seeds, 30 mm of range noise; see synthetic_drive.h.
Status AblateSyntheticDrives(int num_seeds, const SolverOptions& full, ThreadPool* pool,
                             AblationTable* table);

/// Drives through random buildings 1 to num_buildings with the noise of the simulator's defaults.
Status AblateBuildings(int num_buildings, const SolverOptions& full, ThreadPool* pool,
                       AblationTable* table);

/// One input without a seed, on all threads.
Status AblateLog(const std::string& name, AblationInput input, AblationTable* table);

/// Medians over the inputs, for people.
std::string AblationText(const AblationTable& table);

/// One line per kind of input, input and variant. Unavailable if the file cannot be
/// written; so does the other.
Status WriteAblationCsv(const std::string& path, const std::vector<AblationTable>& tables);

/// Medians over the inputs.
Status WriteAblationJson(const std::string& path, const std::vector<AblationTable>& tables);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_ABLATION_H_
