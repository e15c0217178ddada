#include "plumbline/apps/io/temporary_files.h"

#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <set>

namespace plumbline {
namespace {

// A mutex is not for signal handlers. This lock is: a thread that holds it handles no signals, so
// that a handler never waits for the thread that it interrupts.
enum Lock { kFree, kHeld, kProgramEnds };
std::atomic<int> lock{kFree};
static_assert(std::atomic<int>::is_always_lock_free, "for signal handlers");

// Never destroyed: a signal may come at the very end of the program.
std::set<std::string>& paths = *new std::set<std::string>;

// False if the program ends.
bool Take(Lock wanted) {
  int present = kFree;
  while (!lock.compare_exchange_weak(present, wanted)) {
    if (present == kProgramEnds) return false;
    present = kFree;
    sched_yield();
  }
  return true;
}

}  // namespace

TemporaryFiles::TemporaryFiles() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &signals_);
  while (!Take(kHeld)) pause();
}

TemporaryFiles::~TemporaryFiles() {
  lock = kFree;
  pthread_sigmask(SIG_SETMASK, &signals_, nullptr);
}

void TemporaryFiles::Add(const std::string& path) { paths.insert(path); }

void TemporaryFiles::Remove(const std::string& path) { paths.erase(path); }

void TemporaryFiles::DeleteForGood() {
  Take(kProgramEnds);
  for (const std::string& path : paths) unlink(path.c_str());
}

}  // namespace plumbline
