#include "plumbline/apps/benchmark/child_process.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <system_error>
#include <utility>

#include "plumbline/apps/program/stop_signal.h"

namespace plumbline {
namespace {

Status SystemError(const char* call) {
  return Status::Unavailable(std::string(call) + ": " + std::generic_category().message(errno));
}

bool WriteAll(int descriptor, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t size = write(descriptor, text.data() + written, text.size() - written);
    if (size < 0 && errno != EINTR) return false;
    if (size > 0) written += static_cast<std::size_t>(size);
  }
  return true;
}

std::string ReadAll(int descriptor) {
  std::string text;
  char buffer[4096];
  while (true) {
    const ssize_t size = read(descriptor, buffer, sizeof(buffer));
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return text;
    text.append(buffer, static_cast<std::size_t>(size));
  }
}

Status StatusOfExit(int wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const int number = WTERMSIG(wait_status);
    // Unsafe in two threads at once, but children are run from one.
    const std::string name = strsignal(number);  // NOLINT(concurrency-mt-unsafe)
    return Status::Unavailable("ended by signal " + std::to_string(number) + " (" + name + ")");
  }
  const int code = WEXITSTATUS(wait_status);
  return code == 0 ? Status::Ok()
                   : Status::Unavailable("ended with exit code " + std::to_string(code));
}

// Puts signals off. Between fork and LeaveStopSignalsToParent one would reach the parent's handler
// in the child, which would delete the parent's files.
class DeferredSignals {
 public:
  DeferredSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~DeferredSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  DeferredSignals(const DeferredSignals&) = delete;
  DeferredSignals& operator=(const DeferredSignals&) = delete;

 private:
  sigset_t before_;  // that this thread had blocked
};

// In the child, stop signals have their default meaning by the time it gets any.
pid_t Fork() {
  const DeferredSignals deferred;
  const pid_t child = fork();
  if (child == 0) LeaveStopSignalsToParent();
  return child;
}

// A stop signal is for the parent to answer. The child ends with it.
void EndWithParent(pid_t parent) {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  if (getppid() != parent) _exit(1);
}

// Neither returns nor runs what the caller has registered for its own end.
[[noreturn]] void DoWork(const std::function<std::string()>& work, int descriptor) {
  const bool written = WriteAll(descriptor, work());
  std::cout.flush();
  _exit(written ? 0 : 1);
}

}  // namespace

Status RunInChild(const std::function<std::string()>& work, std::string* result) {
  int ends[2];
  if (pipe(ends) != 0) return SystemError("pipe");
  // What is still in a buffer would be written twice.
  std::cout.flush();
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t child = Fork();
  if (child < 0) {
    Status status = SystemError("fork");
    close(ends[0]);
    close(ends[1]);
    return status;
  }
  if (child == 0) {
    EndWithParent(parent);
    close(ends[0]);
    DoWork(work, ends[1]);
  }
  close(ends[1]);
  std::string text = ReadAll(ends[0]);
  close(ends[0]);
  int wait_status = 0;
  while (waitpid(child, &wait_status, 0) < 0) {
    if (errno != EINTR) return SystemError("waitpid");
  }
  PLUMBLINE_RETURN_IF_ERROR(StatusOfExit(wait_status));
  *result = std::move(text);
  return Status::Ok();
}

}  // namespace plumbline
