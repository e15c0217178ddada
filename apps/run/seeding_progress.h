#ifndef PLUMBLINE_APPS_RUN_SEEDING_PROGRESS_H_
#define PLUMBLINE_APPS_RUN_SEEDING_PROGRESS_H_

#include <optional>
#include <ostream>
#include <string>

#include "plumbline/apps/run/progress.h"
#include "plumbline/solvers/interface/seeding_options.h"

namespace plumbline {

/// Shows how far a seeding is: a bar for the matching of the scans, and one for each round of loop
/// closing, since nobody knows how many rounds there will be; of several sessions, for each of
/// them, and one for what they have in common.
class SeedingBars {
 public:
  /// on_terminal: whether `out` is one.
  SeedingBars(bool on_terminal, std::ostream* out);

  /// As SeedingProgress is called. A number that does not grow begins another round.
  void Update(SeedingPhase phase, int num_done, int num_total);
  /// Ends the last bar.
  void Finish();

 private:
  std::string Label(SeedingPhase phase) const;
  std::string Result() const;

  bool on_terminal_;
  std::ostream* out_;
  std::optional<ProgressBar> bar_;  // of the phase or round under way
  SeedingPhase phase_ = SeedingPhase::kMatchingScans;
  int num_done_ = 0;
  int num_total_ = 0;
  int num_rounds_ = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_SEEDING_PROGRESS_H_
