#ifndef PLUMBLINE_APPS_BENCHMARK_ONLINE_RUN_H_
#define PLUMBLINE_APPS_BENCHMARK_ONLINE_RUN_H_

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/replay.h"
#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// What OnlineMapper did with one scan.
struct OnlineScanRecord {
  double add_s = 0.0;  ///< wall time of AddScan [s]
  double cpu_s = 0.0;  ///< processor time of its thread [s]
  double lag_s = 0.0;  ///< since the arrival of the oldest scan whose loops were not sought yet [s]
  int num_pending = 0;
  std::size_t memory_bytes = 0;  ///< resident memory of the process
};

/// A drive that was fed to OnlineMapper scan by scan.
struct OnlineRun {
  std::vector<OnlineScanRecord> scans;
  std::vector<TimedPose> live;    ///< each pose as it was given with its scan
  std::vector<TimedPose> online;  ///< poses of the map at the end of the drive, before Finish
  std::vector<TimedPose> final_map;
  int num_jumps = 0;       ///< scans whose odometry was refused
  int num_remappings = 0;  ///< in the background
  int num_closures = 0;    ///< at the end of the drive
  int num_alarms = 0;      ///< at the end of the drive
  int num_final_alarms = 0;
  double drive_s = 0.0;     ///< wall time of the drive
  double recorded_s = 0.0;  ///< as it was recorded
  double wait_s = 0.0;      ///< until the background had caught up at the end
  double finish_s = 0.0;
  std::size_t start_memory_bytes = 0;
};

/// Feeds a drive to OnlineMapper, scan by scan in order of time, `speed` times as fast as it was
/// recorded; 0: as fast as the calling thread gets on. A scan whose odometry is refused is added
/// without it. done: called for every 1000 scans, and after the last one. Fails like OnlineMapper.
Status RunOnline(const MapLogOptions& options, double speed, const SlamGraph& drive,
                 const std::function<void(int num_scans)>& done, OnlineRun* run);

/// For people. relations: true relative poses; if there are none, relative poses of the final map
/// over up to 10 s take their place.
std::string OnlineTable(const OnlineRun& run, const std::vector<Relation>& relations);

/// One line per scan. Unavailable if the file cannot be written.
Status WriteOnlineCsv(const std::string& path, const OnlineRun& run);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_ONLINE_RUN_H_
