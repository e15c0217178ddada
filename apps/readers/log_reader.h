#ifndef PLUMBLINE_APPS_READERS_LOG_READER_H_
#define PLUMBLINE_APPS_READERS_LOG_READER_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/bags/bag_reader.h"
#include "plumbline/apps/io/beam_direction.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/apps/io/warning.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How a log of any format is read.
struct LogReadOptions {
  int max_scans = 0;                 ///< the first ones are read; 0: all
  BagReadOptions bag;                ///< topics of a bag of ROS; its max_bytes does not matter
  std::string laser_frame;           ///< of a bag, see RosGraphOptions
  RosClock clock = RosClock::kAuto;  ///< of a bag
  BeamDirection beam_direction = BeamDirection::kStated;
  /// Field of view of FLASER records [rad]; empty: see ReadCarmenLog.
  std::optional<double> flaser_fov_rad;
  /// From the first beam of a sweep to the last [s]; empty: what the scans of a bag say, 0 for
  /// other logs.
  std::optional<double> sweep_time_s;
  double max_bytes = 0.0;  ///< memory that reading may take; 0: no limit
};

/// What did not fit into the graph as it stood.
struct LogCounts {
  std::size_t num_skipped_records = 0;
  std::size_t num_out_of_order = 0;
};

/// Messages about a log.
struct LogNotes {
  LogCounts counts;
  std::vector<std::string> skipped;  ///< lines for people, one per record; the first records only
  std::vector<Warning> warnings;
  std::optional<double> no_return_level_m;  ///< see FindNoReturnLevel
};

/// The files that a log is made of, see FilesOfLog; of what cannot be read, the path itself.
std::vector<std::string> LogFiles(const std::string& path);

/// Reads a CARMEN log or a bag of ROS 1 or ROS 2 into a graph placed by odometry. A map that
/// slam_toolbox has saved is read as well, with its own poses and edges and all of its scans. Fails
/// like the reader of the format and its BuildGraph, and with InvalidArgument if no scan has a
/// return, or if reading takes more memory than allowed; *graph is then untouched, and *notes has
/// the messages up to there.
Status ReadLog(const std::string& path, const LogReadOptions& options, LogNotes* notes,
               SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_READERS_LOG_READER_H_
