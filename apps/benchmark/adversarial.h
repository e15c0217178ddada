#ifndef PLUMBLINE_APPS_BENCHMARK_ADVERSARIAL_H_
#define PLUMBLINE_APPS_BENCHMARK_ADVERSARIAL_H_

#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// What is done to a graph before it is solved. `level` of a case says how much.
enum class Attack {
  kNone,             ///< nothing: the start is the truth under a smooth drift of some centimetres
  kTruth,            ///< the start is the truth
  kDrift,            ///< times the usual drift
  kWrongClosures,    ///< this share of the relative poses is wrong by metres
  kGrossClosures,    ///< another mapper's graph, at its optimum; see FalseClosures::kGross
  kBiasedClosures,   ///< another mapper's graph, at its optimum; see FalseClosures::kBiased
  kJump,             ///< all poses from one on are displaced by this [m], and turned
  kShuffled,         ///< this share of the poses stand in each other's places
  kMirrored,         ///< this share of the scans has its beams in reverse order
  kPeople,           ///< this share of the returns is replaced by shorter readings
  kMissingOdometry,  ///< this share of the odometry is missing
  kNoise,            ///< the noise of the ranges is told as this times what it is
  kRepeatedScan,     ///< this share of the scans is that of another place
};

const char* ToString(Attack attack);

/// One run: on a simulated building, with its truth.
struct AdversarialCase {
  Attack attack = Attack::kNone;
  double level = 0.0;
  std::uint64_t seed = 1;  ///< of the building and of all noise
  /// The start comes from the seeding of the programs, on the falsified scans; the odometry leaps
  /// by `level` in case of a jump. Otherwise it is a host's: the truth, drifted and falsified.
  bool seeded = false;
};

/// How far a map is off, as poses place the measured ranges.
struct MapFigures {
  double pose_error_m = 0.0;  ///< mean, after the rigid motion that fits the trajectory best
  double pose_error_rad = 0.0;
  double wall_thickness_m = 0.0;
  double mean_map_entropy = 0.0;
};

struct AdversarialOutcome {
  AdversarialCase run;
  MapFigures before, after;
  /// Pose error that noise leaves of the same drive without any attack, started at the usual drift:
  /// what two results that are as good as each other may differ by.
  double floor_m = 0.0;
  bool alarm = false;               ///< the seeding warned that its map may be wrong
  int num_false_edges = 0;          ///< relative poses that are wrong on purpose
  int num_false_edges_ignored = 0;  ///< of these, the ones that the solver left out
  int num_sound_edges_ignored = 0;  ///< others that it left out
  SolverSummary summary;

  /// No worse against the truth than by what noise leaves, and no blurrier.
  bool PosesAreWorse() const { return after.pose_error_m > before.pose_error_m + floor_m; }
  bool MapIsBlurrier() const;
};

/// Every attack at its levels, each for seeds 1 to num_seeds, as a host's graph and, where it can
/// be done to a log, through the seeding.
std::vector<AdversarialCase> AdversarialCases(int num_seeds);

/// Solves one case. InvalidArgument if the options are refused.
Status RunAdversarialCase(const AdversarialCase& run, SolverOptions solver,
                          AdversarialOutcome* outcome);

/// Spreads whole runs over the threads; `outcomes` are in the order of the cases and, but for
/// times, do not depend on the number of threads. Fails with the first run that fails.
Status RunAdversarialStudy(const std::vector<AdversarialCase>& cases, const SolverOptions& solver,
                           ThreadPool* pool, std::vector<AdversarialOutcome>* outcomes);

/// A table for people: per attack and level, medians of the errors before and after, and how many
/// runs gave the seed back, ended with worse poses, with and without a warning of the seeding, or
/// with a blurrier map; and how many false edges there were, and how many false and sound ones were
/// ignored.
std::string AdversarialTable(const std::vector<AdversarialOutcome>& outcomes);

/// One line per run below a header line. NotFound or Unavailable if the file cannot be written.
Status WriteAdversarialCsv(const std::string& path,
                           const std::vector<AdversarialOutcome>& outcomes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_ADVERSARIAL_H_
