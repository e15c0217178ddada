#ifndef PLUMBLINE_SOLVERS_DRIVE_SEEDING_H_
#define PLUMBLINE_SOLVERS_DRIVE_SEEDING_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/alarm.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/online/live_matching.h"
#include "plumbline/solvers/seeding/seed_drive.h"

namespace plumbline {

/// A map of the drive so far.
struct DriveSeeding {
  SlamGraph log;  ///< the measurements; empty after SeedDriveSoFar
  /// world_from_robot of the map at hand, per pose of the log.
  std::vector<Pose2> poses_at_hand;
  SeededDrive drive;  ///< with the poses of the joint estimation
  SeedingReport report;
  std::vector<Alarm> alarms;
  /// Whether it replaces the map at hand: it has no alarm, or its scans contradict each other no
  /// more than in the map at hand.
  bool is_better = true;
};

/// Maps the log of a drive that goes on, by the stages of MapLog but the calibration: it would move
/// the frame of the robot. Own terms, edges that are named and the callback of the options are left
/// to the end of the drive. Fails like MapLog; Unavailable if progress stopped it.
Status SeedDriveSoFar(const MapLogOptions& options, const SeedingProgress& progress,
                      DriveSeeding* seeding);

/// What a seeding says of the odometry.
OdometryFaults FaultsOf(const SeedingReport& report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_DRIVE_SEEDING_H_
