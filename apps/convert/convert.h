#ifndef PLUMBLINE_APPS_CONVERT_CONVERT_H_
#define PLUMBLINE_APPS_CONVERT_CONVERT_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/convert/conversion_target.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Files in and files out.
struct ConvertOptions {
  std::string input;       ///< a log or a pose graph
  std::string trajectory;  ///< poses to use instead of the input's, see ReplacePoses; empty: none
  std::vector<ConversionTarget> targets;
  double map_resolution_m = RunOutputOptions().map_resolution_m;  ///< side of a ROS map's cell

  bool Check(std::string* error) const;
};

/// What came in, and what of it each target has no place for.
struct ConversionReport {
  std::size_t num_poses = 0;
  std::size_t num_edges = 0;  ///< odometry included
  std::size_t num_scans = 0;
  std::size_t num_returns = 0;
  LogCounts counts;
  std::optional<SweepOrder> sweep_order;  ///< of lasers that sweep, where returns are placed by it
  std::vector<std::string> left_out;      ///< of each target, see LeftOut
};

/// Reads the input and writes the targets, each of them whole or not at all. A pose graph that
/// becomes a pose graph keeps its numbers as they are written (WritePoseGraphFile); of a log come
/// the scans and the odometry from each to the next, with the noise that MotionOptions' defaults
/// give it (MakePoseGraphFile). Points of PLY and PCD are the measured ends of the beams. What
/// shows returns alone has them where the poses put the robot at their own times
/// (TakeOutSweepMotion); pose graphs keep the readings. Messages about the input go to standard
/// error, as ReadLogIntoGraph has them.
///
/// Before anything is written: InvalidArgument on options out of range and on an input without
/// returns for a target that shows nothing else; and all that readers and ReplacePoses fail on.
/// Then whatever a writer fails on; targets before it are there. That no target is an input or
/// another target is for the caller to see to.
Status Convert(const ConvertOptions& options, ConversionReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_CONVERT_CONVERT_H_
