#include "plumbline/apps/mpi/refused_flags.h"

#include <string>

namespace plumbline {

Status CheckGoesWithPeers(const LogRunOptions& options) {
  const SolverOptions& solver = options.mapping.solver;
  if (solver.type != SolverType::kReduced) {
    return Status::InvalidArgument("--solver=" + std::string(ToString(solver.type)) +
                                   " runs in one process only (plumbline_slam)");
  }
  return Status::Ok();
}

}  // namespace plumbline
