#include "plumbline/apps/program/stop_signal.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <iterator>
#include <utility>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/temporary_files.h"

namespace plumbline {
namespace {

constexpr struct {
  int number;
  const char* name;
} kStopSignals[] = {{SIGINT, "SIGINT"}, {SIGTERM, "SIGTERM"}, {SIGHUP, "SIGHUP"}};
constexpr int kStoppedBySignal = 128;

// What the handler does with a signal. Made before the signal comes: a handler may not allocate.
struct Response {
  std::array<std::string, std::size(kStopSignals)> lines;  // for standard error, by signal
  bool ends_program = false;
  std::vector<std::string> folders;  // to be removed if they are empty
};

std::string program_name = "plumbline";
bool ends_on_every_signal = false;
std::atomic<int> stop_signal{0};
std::atomic<const Response*> response{nullptr};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not wait");
static_assert(std::atomic<const Response*>::is_always_lock_free, "a signal handler must not wait");

std::string NameOf(int number) {
  for (const auto& stop : kStopSignals) {
    if (stop.number == number) return stop.name;
  }
  return "";
}

// What handlers call, from here on, is nothing but what they may call.

// Signals that the caller has switched off stay off.
void HandleStopSignalsBy(void (*handler)(int)) {
  struct sigaction handle {};
  handle.sa_handler = handler;
  handle.sa_flags = SA_RESTART;
  sigemptyset(&handle.sa_mask);
  for (const auto& stop : kStopSignals) {
    struct sigaction present {};
    sigaction(stop.number, nullptr, &present);
    if (present.sa_handler != SIG_IGN) sigaction(stop.number, &handle, nullptr);
  }
}

void Respond(const Response& to_signal, int number) {
  for (std::size_t i = 0; i < to_signal.lines.size(); ++i) {
    if (kStopSignals[i].number != number) continue;
    const std::string& line = to_signal.lines[i];
    [[maybe_unused]] const ssize_t size = write(STDERR_FILENO, line.data(), line.size());
  }
  if (!to_signal.ends_program) return;
  TemporaryFiles::DeleteForGood();
  for (const std::string& folder : to_signal.folders) rmdir(folder.c_str());
  _exit(kStoppedBySignal + number);
}

void HandleSecondSignal(int number) {
  HandleStopSignalsBy(SIG_DFL);  // a third one
  TemporaryFiles::DeleteForGood();
  raise(number);
}

void HandleSignal(int number) {
  const int interrupted_errno = errno;
  stop_signal = number;
  // First: a second signal is to end a program whose standard error takes nothing.
  HandleStopSignalsBy(HandleSecondSignal);
  Respond(*response.load(), number);
  errno = interrupted_errno;
}

// Those of before stay, and none is ever destroyed: a handler may be at work with one of them, at
// the end of the program too.
void SetResponse(const std::string& problem, bool ends_program,
                 const std::vector<std::string>& folders) {
  static auto& responses = *new std::deque<Response>;
  Response next{{}, ends_program || ends_on_every_signal, folders};
  for (std::size_t i = 0; i < next.lines.size() && !ends_on_every_signal; ++i) {
    next.lines[i] = program_name + ": stopped by " + kStopSignals[i].name + problem + '\n';
  }
  response = &responses.emplace_back(std::move(next));
}

void SetEndingResponse(const std::string& problem, const std::vector<std::string>& folders) {
  SetResponse(problem, true, folders);
  const int number = StopSignal();
  if (number != 0) Respond(*response.load(), number);
}

}  // namespace

void CatchSignals(const std::string& program) {
  program_name = std::filesystem::path(program).filename().string();
  EndIfStoppedWhile("starting");
  HandleStopSignalsBy(HandleSignal);
  signal(SIGXFSZ, SIG_IGN);
}

void EndOnEveryStopSignal() {
  ends_on_every_signal = true;
  EndIfStoppedWhile("starting");
  HandleStopSignalsBy(HandleSignal);
}

void LeaveStopSignalsToParent() { HandleStopSignalsBy(SIG_DFL); }

void EndIfStoppedWhile(const std::string& activity, const std::vector<std::string>& folders) {
  SetEndingResponse(" while " + Legible(activity) + ": nothing is written", folders);
}

void EndIfStoppedWhileWriting(const std::vector<std::string>& folders) {
  SetEndingResponse(" while writing: no file is half-written", folders);
}

void KeepStopSignal() {
  SetResponse(", ending in order; another signal ends the program at once", false, {});
}

int StopSignal() { return stop_signal; }

std::string StopSignalName() { return NameOf(StopSignal()); }

std::string StopText(const std::string& signal_name) {
  if (signal_name.empty()) return "";
  return "Stopped by " + signal_name + ": the results are those of the best state so far.\n";
}

Status WriteWithStopSignal(const std::function<Status(const std::string& signal_name)>& write) {
  const std::string signal_name = StopSignalName();
  PLUMBLINE_RETURN_IF_ERROR(write(signal_name));
  if (!signal_name.empty()) return Status::Ok();
  HandleStopSignalsBy(SIG_IGN);
  return StopSignal() == 0 ? Status::Ok() : write(StopSignalName());
}

int ExitCodeAfterStop(int exit_code) {
  return StopSignal() == 0 ? exit_code : kStoppedBySignal + StopSignal();
}

}  // namespace plumbline
