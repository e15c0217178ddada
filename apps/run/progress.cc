#include "plumbline/apps/run/progress.h"

#include <unistd.h>

#include <iomanip>
#include <utility>

namespace plumbline {
namespace {

constexpr int kBarWidth = 40;
constexpr const char* kClearLine = "\r\033[K";

}  // namespace

ProgressBar::ProgressBar(std::string label, bool on_terminal, std::ostream* out)
    : label_(std::move(label)), on_terminal_(on_terminal), out_(out) {}

void ProgressBar::Update(int num_done, int num_total) {
  if (num_total <= 0) return;
  const double share = static_cast<double>(num_done) / num_total;
  const int percent = static_cast<int>(100.0 * share);
  if (on_terminal_) {
    const int filled = static_cast<int>(kBarWidth * share);
    *out_ << '\r' << label_ << " [" << std::string(filled, '#')
          << std::string(kBarWidth - filled, '.') << "] " << std::setw(3) << percent << " %"
          << std::flush;
  } else if (percent / 10 > tenths_shown_) {
    tenths_shown_ = percent / 10;
    *out_ << label_ << ": " << 10 * tenths_shown_ << " %\n" << std::flush;
  }
}

void ProgressBar::Finish(const std::string& result) {
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (on_terminal_) *out_ << kClearLine;
  *out_ << label_ << ": " << result << " (" << std::fixed << std::setprecision(2) << seconds
        << " s)\n"
        << std::flush;
}

bool StandardOutputIsTerminal() { return isatty(STDOUT_FILENO) != 0; }

}  // namespace plumbline
