#ifndef PLUMBLINE_APPS_MPI_MPI_PROGRAM_H_
#define PLUMBLINE_APPS_MPI_MPI_PROGRAM_H_

#include <functional>
#include <memory>
#include <streambuf>
#include <string>
#include <vector>

#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/file_flags.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/mpi/mpi_peers.h"

namespace plumbline {

/// A program that mpirun starts several times, from its beginning to its end: begins MPI, ends it
/// when the program exits, however that happens. Of its processes the first one prints; a stop
/// signal ends each of them at once, without a word and with its temporary files deleted, for
/// mpirun tells the others.
class MpiProgram {
 public:
  /// To be made first of all, with the arguments of main. Then like StartProgram.
  MpiProgram(const std::string& usage, int* argc, char*** argv);
  ~MpiProgram();
  MpiProgram(const MpiProgram&) = delete;
  MpiProgram& operator=(const MpiProgram&) = delete;

  /// The processes; null if there is only one.
  const MpiPeers* peers() const { return peers_->size() > 1 ? peers_.get() : nullptr; }

  /// Like RunProgram in every process. A failure is one line on standard error: that of all, or of
  /// the first process that failed, with its rank. Where others wait for one that failed, they are
  /// ended.
  int Run(const std::vector<FileFlag>& files, const std::function<Status()>& check_flags,
          const std::function<Status()>& run);

 private:
  // Waits for that; false if it takes too long for one that failed. failures: 0 or 1 per process.
  bool AllComeToTheirEnds(bool has_failed, std::vector<int>* failures) const;

  std::streambuf* errors_;  // of std::cerr
  std::unique_ptr<MpiPeers> peers_;
  std::unique_ptr<MpiPeers> ends_;  // who is at its end, apart from all other talk
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_MPI_MPI_PROGRAM_H_
