#ifndef PLUMBLINE_APPS_BENCHMARK_STAGE_PROFILE_H_
#define PLUMBLINE_APPS_BENCHMARK_STAGE_PROFILE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/apps/program/output_folder.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// What the machine can do, measured.
struct MachineSpeed {
  double copied_bytes_per_s = 0.0;   ///< read and written, all threads together
  double multiply_adds_per_s = 0.0;  ///< in double precision, one core
};

/// Takes a quarter of a second.
MachineSpeed MeasureMachine(ThreadPool* pool);

/// What a stage of a run took.
struct StageProfile {
  std::string name;
  double time_s = 0.0;
  double cpu_time_s = 0.0;  ///< of all threads together
  double bytes = 0.0;       ///< that it has to read and write at least, each array once per pass
};

/// A run from raw log to all files, stage by stage.
struct LogProfile {
  MachineSpeed machine;
  std::size_t num_returns = 0;
  std::vector<StageProfile> stages;  ///< in order of the run
};

/// Maps a log and writes what MapWriteTasks writes. Fails like reading, mapping and writing.
Status ProfileLog(const std::string& path, const MapLogOptions& options, const OutputFolder& output,
                  ThreadPool* pool, LogProfile* profile);

/// A table for people, with the floor of each stage: the time to move its bytes.
std::string ProfileTable(const LogProfile& profile);

/// One line per stage. Unavailable if the file cannot be written.
Status WriteProfileCsv(const std::string& path, const LogProfile& profile);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_STAGE_PROFILE_H_
