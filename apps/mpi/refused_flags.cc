#include "plumbline/apps/mpi/refused_flags.h"

#include <string>

namespace plumbline {

Status CheckGoesWithPeers(const LogRunOptions& options) {
  const SolverOptions& solver = options.mapping.solver;
  if (solver.type != SolverType::kReduced) {
    return Status::InvalidArgument("--solver=" + std::string(ToString(solver.type)) +
                                   " runs in one process only (plumbline_slam)");
  }
  const struct {
    const char* flag;
    bool is_set;
  } refused[] = {{"shape", solver.factors.shape.enabled},
                 {"reduced_polish_sweeps", solver.reduced.polish_sweeps > 0},
                 {"calibrate", options.mapping.calibration.IsOn()}};
  for (const auto& [flag, is_set] : refused) {
    if (!is_set) continue;
    return Status::InvalidArgument("--" + std::string(flag) +
                                   " goes with one process only (plumbline_slam)");
  }
  return Status::Ok();
}

}  // namespace plumbline
