#ifndef PLUMBLINE_APPS_BENCHMARK_VARIATIONS_STUDY_H_
#define PLUMBLINE_APPS_BENCHMARK_VARIATIONS_STUDY_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/log_variations.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// Path of the relations of a log: in its folder, with its name up to the first ".clf" or ".log",
/// and ".relations" at the end.
std::string RelationsBeside(const std::string& log);

/// Reads CARMEN logs and their relations. Fails like ReadCarmenLog and ReadRelations; NotFound,
/// naming log and missing file, if a log has no relations beside it.
Status ReadKnownLogs(const std::vector<std::string>& paths, std::vector<KnownLog>* logs);

/// Variations from their names, separated by commas; "all" stands for all of them. InvalidArgument,
/// with a list of all names, if there is none of a name.
Status ParseVariations(const std::string& names, std::vector<const LogVariation*>* variations);

/// One run of the study.
struct VariationCase {
  std::size_t log = 0;                      ///< index
  const LogVariation* variation = nullptr;  ///< from LogVariations
  std::uint64_t seed = 1;
};

/// For each log first "same", then the other given variations: random ones with num_seeds seeds
/// from first_seed on, the others once.
std::vector<VariationCase> VariationCases(std::size_t num_logs,
                                          const std::vector<const LogVariation*>& variations,
                                          int num_seeds, std::uint64_t first_seed);

/// Result of a run. Errors are means over the relations that the variation keeps, see
/// MeasureRelations; NaN if no pose has their times.
struct VariationOutcome {
  /// Limits of a right map's error: kMaxErrorRatio times the error of the map of the unvaried log,
  /// plus kMaxExcessM. Fewer or noisier readings cost up to half of the accuracy; a missed or wrong
  /// loop closure multiplies the error. The summand is twice the millimetre to which the data
  /// determine a pose (README.md, "How exact a result is"). Not tuned.
  static constexpr double kMaxErrorRatio = 1.5;
  static constexpr double kMaxExcessM = 0.002;  ///< [m], see kMaxErrorRatio

  std::string log;        ///< name
  std::string variation;  ///< name
  std::uint64_t seed = 1;
  int num_scans = 0;
  std::size_t num_relations = 0;
  double error_m = 0.0;            ///< of the map
  double seed_error_m = 0.0;       ///< of the initial estimate
  double reference_error_m = 0.0;  ///< of the map of the unvaried log, over the same relations
  bool has_alarm = false;          ///< of the whole run
  bool has_seed_alarm = false;     ///< of the seeding
  /// Wall time on one thread from the graph to the first search for loops: surfaces and matching.
  double matching_s = 0.0;
  double seeding_s = 0.0;  ///< wall time of the seeding, matching included
  double time_s = 0.0;     ///< wall time of the run, without reading and varying the log

  bool IsRight() const { return error_m <= kMaxErrorRatio * reference_error_m + kMaxExcessM; }
};

/// Maps every variation as MapLog does, and compares it with the map of the unvaried log. Applies
/// all variations once before it maps the first log, so that it fails early. Spreads whole runs
/// over the threads, one thread each; `outcomes` are in the order of the cases and, except for the
/// times, do not depend on the number of threads. `done`, which may be empty, gets each outcome in
/// this order, as soon as all outcomes before it are known; one call at a time, on any thread.
///
/// cases: as VariationCases has them, "same" first for each log. Fails with the first run that
/// fails.
Status RunVariationsStudy(const std::vector<KnownLog>& logs,
                          const std::vector<VariationCase>& cases, const MapLogOptions& options,
                          const std::function<void(const VariationOutcome&)>& done,
                          ThreadPool* pool, std::vector<VariationOutcome>* outcomes);

/// Header line and one line per outcome, for people.
std::string VariationHeader();
std::string VariationRow(const VariationOutcome& outcome);

/// Two tables for people, per variation and per log: how many maps are right or wrong, each quiet
/// or warned, and the sums of the times.
std::string VariationsTable(const std::vector<VariationOutcome>& outcomes);

/// One line per run below a header line. Unavailable if the file cannot be written.
Status WriteVariationsCsv(const std::string& path, const std::vector<VariationOutcome>& outcomes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_VARIATIONS_STUDY_H_
