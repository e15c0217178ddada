#include "plumbline/apps/mpi/mpi_program.h"

#include <fcntl.h>
#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <streambuf>
#include <thread>

#include "plumbline/apps/io/temporary_files.h"
#include "plumbline/apps/program/stop_signal.h"

namespace plumbline {
namespace {

// Takes all that is printed, and forgets it.
class NullBuffer : public std::streambuf {
 protected:
  int_type overflow(int_type character) override { return traits_type::not_eof(character); }
  std::streamsize xsputn(const char*, std::streamsize size) override { return size; }
};

void EndMpi() {
  int is_over = 0;
  MPI_Finalized(&is_over);
  if (is_over == 0) MPI_Finalize();
}

// What goes to the standard error of this process is lost while this exists.
class SilentErrors {
 public:
  explicit SilentErrors(bool are_silent) : copy_(are_silent ? dup(STDERR_FILENO) : -1) {
    if (copy_ < 0) return;
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nothing < 0) return;
    dup2(nothing, STDERR_FILENO);
    close(nothing);
  }
  ~SilentErrors() {
    if (copy_ < 0) return;
    dup2(copy_, STDERR_FILENO);
    close(copy_);
  }
  SilentErrors(const SilentErrors&) = delete;
  SilentErrors& operator=(const SilentErrors&) = delete;

 private:
  int copy_;
};

// Open MPI takes a fifth of a second to look for fast networks. Where it says that all processes
// are on one machine they need none; what the user has chosen stays.
void LookForNoNetworkOnOneMachine() {
  // NOLINTBEGIN(concurrency-mt-unsafe): the program has one thread yet
  const char* const num_here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  const char* const num_all = std::getenv("OMPI_COMM_WORLD_SIZE");
  if (num_here == nullptr || num_all == nullptr || std::strcmp(num_here, num_all) != 0) return;
  setenv("OMPI_MCA_pml", "ob1", 0);
  // NOLINTEND(concurrency-mt-unsafe)
}

}  // namespace

MpiProgram::MpiProgram(const std::string& usage, int* argc, char*** argv)
    : errors_(std::cerr.rdbuf()) {
  LookForNoNetworkOnOneMachine();
  int provided = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  std::atexit(EndMpi);  // a program that is asked for help exits on its way
  peers_ = std::make_unique<MpiPeers>(MPI_COMM_WORLD);
  ends_ = std::make_unique<MpiPeers>(MPI_COMM_WORLD);
  static NullBuffer nothing;
  const bool is_silent = peers_->rank() != 0;
  if (is_silent) {
    std::cout.rdbuf(&nothing);
    std::cerr.rdbuf(&nothing);
  }
  const SilentErrors silent(is_silent);  // what is wrong with the flags, all processes find out
  StartProgram(usage, *argc, *argv);
  EndOnEveryStopSignal();
}

MpiProgram::~MpiProgram() {
  peers_.reset();
  ends_.reset();
  EndMpi();
}

int MpiProgram::Run(const std::vector<FileFlag>& files, const std::function<Status()>& check_flags,
                    const std::function<Status()>& run) {
  const ProgramEnd end = RunQuietly(files, check_flags, run);
  const bool has_failed = !end.message.empty();
  std::cerr.rdbuf(errors_);
  const std::string with_rank = "rank " + std::to_string(peers_->rank()) + ": " + end.message;
  std::vector<int> failures;
  if (!AllComeToTheirEnds(has_failed, &failures)) {
    TemporaryFiles::DeleteForGood();
    PrintFailure(with_rank);
    MPI_Abort(MPI_COMM_WORLD, end.exit_code);
  }
  const auto first_failure = std::find(failures.begin(), failures.end(), 1);
  if (first_failure - failures.begin() == peers_->rank()) {
    const bool all_failed = std::count(failures.begin(), failures.end(), 1) == peers_->size();
    PrintFailure(all_failed ? end.message : with_rank);
  }
  return end.exit_code;
}

bool MpiProgram::AllComeToTheirEnds(bool has_failed, std::vector<int>* failures) const {
  // Processes that fail together do so within a moment. Of several that fail while others wait, the
  // first one ends the others before they speak.
  constexpr std::chrono::milliseconds kMoment{1500}, kTurn{100}, kSleep{5};
  const auto deadline = std::chrono::steady_clock::now() + kMoment + peers_->rank() * kTurn;
  const int own = has_failed ? 1 : 0;
  failures->resize(peers_->size());
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgather(&own, 1, MPI_INT, failures->data(), 1, MPI_INT, ends_->communicator(), &request);
  for (int all_are_here = 0;;) {
    MPI_Test(&request, &all_are_here, MPI_STATUS_IGNORE);
    if (all_are_here != 0) return true;
    if (has_failed && std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(kSleep);
  }
}

}  // namespace plumbline
