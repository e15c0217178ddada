#include "plumbline/apps/mpi/refused_flags.h"

#include <gflags/gflags.h>

#include <string>
#include <vector>

#include "plumbline/apps/program/log_list.h"

namespace plumbline {

Status CheckGoesWithPeers(const LogRunOptions& options) {
  const SolverOptions& solver = options.mapping.solver;
  if (solver.type != SolverType::kReduced) {
    return Status::InvalidArgument("--solver=" + std::string(ToString(solver.type)) +
                                   " runs in one process only (plumbline_slam)");
  }
  std::vector<std::string> logs;
  const gflags::CommandLineFlagInfo fixed_map = gflags::GetCommandLineFlagInfoOrDie("fixed_map");
  if (!fixed_map.is_default || (ParseLogList(options.log, &logs).ok() && logs.size() > 1)) {
    return Status::InvalidArgument(
        "--log: several processes map one log; for several, and for "
        "--fixed_map, there is plumbline_slam");
  }
  const struct {
    const char* flag;
    bool is_set;
  } refused[] = {{"shape", solver.factors.shape.enabled},
                 {"reduced_polish_sweeps", solver.reduced.polish_sweeps > 0},
                 {"calibrate", options.mapping.calibration.IsOn()},
                 {"hits", !options.hits.empty()},
                 {"save_map", options.outputs.save_map}};
  for (const auto& [flag, is_set] : refused) {
    if (!is_set) continue;
    return Status::InvalidArgument("--" + std::string(flag) +
                                   " goes with one process only (plumbline_slam)");
  }
  return Status::Ok();
}

}  // namespace plumbline
