#include "plumbline/apps/run/seeding_progress.h"

#include <string>

namespace plumbline {

SeedingBars::SeedingBars(bool on_terminal, std::ostream* out)
    : on_terminal_(on_terminal), out_(out) {}

void SeedingBars::Update(SeedingPhase phase, int num_done, int num_total) {
  if (num_total == 0) return;
  const bool is_round = phase == SeedingPhase::kClosingLoops;
  if (!bar_ || phase != phase_ ||
      (num_done <= num_done_ && phase != SeedingPhase::kTyingSessions)) {
    Finish();
    num_rounds_ = is_round ? num_rounds_ + 1 : 0;
    bar_.emplace(Label(phase), on_terminal_, out_);
  }
  phase_ = phase;
  num_done_ = num_done;
  num_total_ = num_total;
  bar_->Update(num_done, num_total);
}

std::string SeedingBars::Label(SeedingPhase phase) const {
  switch (phase) {
    case SeedingPhase::kMatchingScans:
      return "Matching scans";
    case SeedingPhase::kClosingLoops:
      return "Closing loops, round " + std::to_string(num_rounds_);
    case SeedingPhase::kTyingSessions:
      return "Comparing sessions";
  }
  return "";
}

std::string SeedingBars::Result() const {
  switch (phase_) {
    case SeedingPhase::kMatchingScans:
      return std::to_string(num_total_) + " scans";
    case SeedingPhase::kClosingLoops:
      return std::to_string(num_total_) + " places tried";
    case SeedingPhase::kTyingSessions:
      return "done";
  }
  return "";
}

void SeedingBars::Finish() {
  if (!bar_) return;
  bar_->Finish(Result());
  bar_.reset();
}

}  // namespace plumbline
