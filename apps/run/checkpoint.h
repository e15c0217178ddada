#ifndef PLUMBLINE_APPS_RUN_CHECKPOINT_H_
#define PLUMBLINE_APPS_RUN_CHECKPOINT_H_

#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// All that a seed depends on, as pairs of a name for people and a value.
using RunFingerprint = std::vector<std::pair<std::string, std::string>>;

/// What the system says of the files of a log: which ones they are, their sizes and the times of
/// their last change, which nobody can set. Any write to one of them, and any other file in its
/// place, gives another stamp.
using LogStamp = std::string;

/// Size and checksum of the log, of all its files, and every flag of this program but those that
/// change neither poses nor points (folders, pictures, threads, truth). To be taken before the log
/// is read; stamp: of the log as it was then. Fails like a reader of the log if it cannot be read.
Status FingerprintOfRun(const std::string& log, RunFingerprint* fingerprint, LogStamp* stamp);

/// InvalidArgument if the log has changed since, and what was read may not be what was
/// fingerprinted.
Status CheckUnchanged(const std::string& log, const LogStamp& stamp);

/// Keeps the poses that the seeding left, (x, y, yaw) each, and what it reported, so that another
/// run can go on from there to the same results, bit for bit. The file is whole or not there.
/// NotFound or Unavailable if it cannot be written.
Status WriteCheckpoint(const std::string& path, const RunFingerprint& fingerprint,
                       const std::vector<double>& poses, const SeedingReport& seeding);

/// Reads the poses and the report of a seed of this graph, which is fresh from the log. NotFound or
/// Unavailable if the file cannot be read, DataLoss if it is damaged or cut off, InvalidArgument if
/// it is no checkpoint, no file (a folder, a pipe, a device), one of another version, or one of
/// another log or of other flags; the message names what differs. The poses and the report are then
/// as they were.
Status ReadCheckpoint(const std::string& path, const RunFingerprint& fingerprint,
                      const SlamGraph& graph, std::vector<double>* poses, SeedingReport* seeding);

/// The poses and the report as bytes, for another process of the same program.
std::string PackSeed(const std::vector<double>& poses, const SeedingReport& seeding);
/// Takes back what PackSeed gave.
void UnpackSeed(const std::string& bytes, std::vector<double>* poses, SeedingReport* seeding);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_CHECKPOINT_H_
