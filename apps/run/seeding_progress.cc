#include "plumbline/apps/run/seeding_progress.h"

#include <string>

namespace plumbline {

SeedingBars::SeedingBars(bool on_terminal, std::ostream* out)
    : on_terminal_(on_terminal), out_(out) {}

void SeedingBars::Update(SeedingPhase phase, int num_done, int num_total) {
  if (num_total == 0) return;
  if (!bar_ || phase != phase_ || num_done <= num_done_) {
    Finish();
    const std::string label = phase == SeedingPhase::kMatchingScans
                                  ? "Matching scans"
                                  : "Closing loops, round " + std::to_string(++num_rounds_);
    bar_.emplace(label, on_terminal_, out_);
  }
  phase_ = phase;
  num_done_ = num_done;
  num_total_ = num_total;
  bar_->Update(num_done, num_total);
}

void SeedingBars::Finish() {
  if (!bar_) return;
  bar_->Finish(std::to_string(num_total_) +
               (phase_ == SeedingPhase::kMatchingScans ? " scans" : " places tried"));
  bar_.reset();
}

}  // namespace plumbline
