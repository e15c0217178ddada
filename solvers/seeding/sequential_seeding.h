#ifndef PLUMBLINE_SOLVERS_SEEDING_SEQUENTIAL_SEEDING_H_
#define PLUMBLINE_SOLVERS_SEEDING_SEQUENTIAL_SEEDING_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/seeding/odometry_sign.h"
#include "plumbline/solvers/seeding/scan_matcher.h"

namespace plumbline {

/// Sequential point-to-line ICP: each scan is matched against a local map of recent key scans.
struct SequentialSeedingOptions {
  ScanMatchOptions matching;
  /// A scan becomes a key scan after this much travel [m] or turning [rad] since the last one.
  double key_scan_distance_m = 0.25;
  double key_scan_angle_rad = 0.35;
  /// Number of key scans that make up the local map.
  int num_key_scans = 25;
  /// Points are thinned to one per this length of surface [m], in the scan and in the map.
  double point_spacing_m = 0.03;

  bool Check(std::string* error) const;
};

struct SequentialSeedingReport {
  OdometrySignReport odometry_sign;
  int num_key_scans = 0;
  int num_reversed_steps = 0;  ///< steps driven against the odometry's sign
  int num_unmatched = 0;       ///< scans that follow the odometry: their map neighbours are gone
};

/// Called now and then with the number of scans done; false stops the seeding with an error.
using SeedingProgress = std::function<bool(int num_done, int num_total)>;

/// Moves every pose of the graph to where scan matching puts it, starting from the first pose, and
/// the points with them. Expects poses in order of time, joined by odometry from each pose to the
/// next. Where the odometry is recognised to have lost its sign, its motions are corrected too.
/// normals: as EstimateReturnNormals gives them.
Status SeedSequentially(const SequentialSeedingOptions& options, const MotionOptions& motion,
                        const std::vector<Eigen::Vector2f>& normals,
                        const SeedingProgress& progress, ThreadPool* pool, SlamGraph* graph,
                        SequentialSeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_SEQUENTIAL_SEEDING_H_
