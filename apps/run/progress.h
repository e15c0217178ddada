#ifndef PLUMBLINE_APPS_RUN_PROGRESS_H_
#define PLUMBLINE_APPS_RUN_PROGRESS_H_

#include <chrono>
#include <ostream>
#include <string>

namespace plumbline {

/// Shows how far a task is: a bar that redraws itself on a terminal, a line at every tenth where
/// the output is redirected.
class ProgressBar {
 public:
  /// on_terminal: whether `out` is one.
  ProgressBar(std::string label, bool on_terminal, std::ostream* out);

  void Update(int num_done, int num_total);
  /// Ends the line with what was reached and the time it took.
  void Finish(const std::string& result);

 private:
  std::string label_;
  bool on_terminal_;
  std::ostream* out_;
  int tenths_shown_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Whether standard output is a terminal.
bool StandardOutputIsTerminal();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_PROGRESS_H_
