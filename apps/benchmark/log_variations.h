#ifndef PLUMBLINE_APPS_BENCHMARK_LOG_VARIATIONS_H_
#define PLUMBLINE_APPS_BENCHMARK_LOG_VARIATIONS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A log with true relative poses of its drive.
struct KnownLog {
  std::string name;
  CarmenLog log;
  std::vector<Relation> relations;
};

/// A change of a log after which its true relative poses are still known.
struct LogVariation {
  const char* name;
  bool is_random;  ///< the result depends on the seed
  /// Changes a log with at least two scans. The relations keep their number and order, and are
  /// transformed where the variation changes times or poses.
  void (*apply)(NoiseSource* source, KnownLog* known);
};

/// All variations; the first one, "same", changes nothing.
///
/// - late, early: 10 to 40 % of the scans are missing, at the start or at the end
/// - gaps: five gaps of 3 s
/// - thin2, thin5: every second or fifth scan
/// - backwards: the recording in reverse order
/// - mirror: the mirror image of building and drive
/// - turned: the laser mounted at another angle, with bearings that compensate for it
/// - fov120: readings outside the middle two thirds of the field of view become "no return"
/// - range8: readings of 8 m and more become "no return"
/// - beams2, beams4: all readings but every second or fourth become "no return"
/// - noise2cm: range noise with a standard deviation of 2 cm
/// - odo2, odoscale: odometry with more noise, or with scale errors of 5 and 7 %
/// - shift: odometry of up to 0.1 s earlier or later
/// - scale03, reversed: translations of the odometry multiplied by 0.3 or -1
/// - xy_constant: odometry with headings only
/// - no_odometry: odometry that never changes
const std::vector<LogVariation>& LogVariations();

/// Variation of this name; null if there is none.
const LogVariation* FindLogVariation(const std::string& name);

struct VariedLog {
  /// The relations are reduced to pairs of scans that the variation has kept.
  KnownLog known;
  /// The same relations, in the same order, for the log without the variation.
  std::vector<Relation> unvaried_relations;
};

/// Applies a variation. The result depends on the log, the name of the variation and the seed
/// alone. InvalidArgument, naming log and variation, if fewer than two scans or no relation is
/// left; `varied` is then untouched.
Status VaryLog(const LogVariation& variation, std::uint64_t seed, const KnownLog& known,
               VariedLog* varied);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_LOG_VARIATIONS_H_
