#ifndef PLUMBLINE_APPS_RUN_SLAM_PROGRAM_H_
#define PLUMBLINE_APPS_RUN_SLAM_PROGRAM_H_

#include <vector>

#include "plumbline/apps/program/file_flags.h"
#include "plumbline/apps/run/log_run.h"
#include "plumbline/core/status.h"

namespace plumbline {

// What plumbline_slam is made of, for the main files that run it: its flags, which come with this
// file, and what they ask for.

/// The flags that mean files.
const std::vector<FileFlag>& SlamFiles();

/// What the flags ask of a run over a log. InvalidArgument names the flag or the option that makes
/// no sense.
Status SlamOptionsFromFlags(LogRunOptions* options);

/// Maps a log or several, or refines a pose graph, whatever --log names.
Status RunSlam(LogRunOptions options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_SLAM_PROGRAM_H_
