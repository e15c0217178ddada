#include "plumbline/apps/program/stop_signal.h"

#include <signal.h>

#include <atomic>

namespace plumbline {
namespace {

constexpr int kStopSignals[] = {SIGINT, SIGTERM};

std::atomic<int> stop_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not wait");

// Calls nothing but what a signal handler may call.
void KeepSignal(int number) {
  stop_signal = number;
  for (const int stop : kStopSignals) signal(stop, SIG_DFL);
}

}  // namespace

void CatchSignals() {
  struct sigaction keep {};
  keep.sa_handler = KeepSignal;
  keep.sa_flags = SA_RESTART;
  sigemptyset(&keep.sa_mask);
  for (const int stop : kStopSignals) {
    struct sigaction present {};
    sigaction(stop, nullptr, &present);
    if (present.sa_handler != SIG_IGN) sigaction(stop, &keep, nullptr);
  }
  signal(SIGXFSZ, SIG_IGN);
}

int StopSignal() { return stop_signal; }

std::string StopSignalName() {
  switch (StopSignal()) {
    case 0:
      return "";
    case SIGINT:
      return "SIGINT";
    default:
      return "SIGTERM";
  }
}

std::string StopText(const std::string& signal_name) {
  return "Stopped by " + signal_name + ": the results are those of the best state so far.\n";
}

Status StoppedDuring(const std::string& stage) {
  if (StopSignal() == 0) return Status::Ok();
  return Status::Unavailable("stopped by " + StopSignalName() + " during " + stage +
                             ": nothing to write");
}

int ExitCodeAfterStop(int exit_code) {
  constexpr int kStoppedBySignal = 128;
  return StopSignal() == 0 ? exit_code : kStoppedBySignal + StopSignal();
}

}  // namespace plumbline
