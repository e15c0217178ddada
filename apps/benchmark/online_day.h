#ifndef PLUMBLINE_APPS_BENCHMARK_ONLINE_DAY_H_
#define PLUMBLINE_APPS_BENCHMARK_ONLINE_DAY_H_

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// A day of a robot that drives through a simulated building and back, and stands at both ends for
/// as long as it drove.
struct OnlineDayOptions {
  double hours = 8.0;
  /// The drive is localised in the map of its first way, and forgets old scans; else it makes a map
  /// with steps of 0.1 m (OnlineMapperOptions::min_step_m).
  bool is_localised = false;
};

/// What OnlineMapper did over the day.
struct OnlineDay {
  int num_scans = 0;
  double recorded_s = 0.0, wall_s = 0.0;
  std::vector<double> error_m;  ///< of the live pose, per scan in the map
  std::vector<double> add_ms;   ///< wall time of AddScan, per scan
  std::vector<double> lag_s;    ///< wall time since the oldest pending scan arrived, per scan
  std::vector<double> drift_m;  ///< per stand: of the live pose, from its first second to its end
  std::size_t start_memory_bytes = 0, peak_memory_bytes = 0, end_memory_bytes = 0;
  int num_closures = 0, num_remappings = 0;
};

/// Feeds the day to OnlineMapper at 10 Hz, as fast as it takes the scans, but never more than 10
/// scans ahead of the background. done: called for every 10,000 scans. Fails like the mapper.
Status RunOnlineDay(const MapLogOptions& mapping, const OnlineDayOptions& options,
                    const std::function<void(int num_scans)>& done, OnlineDay* day);

/// For people.
std::string OnlineDayTable(const OnlineDay& day);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_ONLINE_DAY_H_
