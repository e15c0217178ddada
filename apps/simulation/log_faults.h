#ifndef PLUMBLINE_APPS_SIMULATION_LOG_FAULTS_H_
#define PLUMBLINE_APPS_SIMULATION_LOG_FAULTS_H_

#include <cstddef>

#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/status.h"

namespace plumbline {

// What a recorder makes wrong of a sound drive. Times count from the start of the log, which has a
// scan. Each returns the first scan that the fault concerns; the number of scans if there is none.

/// Leaves out all scans of a stretch of time: from `from_s` on, for less than `duration_s` [s]. The
/// first scan stays. What comes after them keeps its time and its odometry. Returns the first scan
/// behind the hole.
std::size_t DropScans(double from_s, double duration_s, SimulatedLog* log);

/// Gives the scans after `from_s`, for at most `duration_s` [s], the readings of the last one that
/// is not after it. Times, odometry and true poses go on; the true points are those of the
/// readings.
std::size_t FreezeLaser(double from_s, double duration_s, SimulatedLog* log);

/// Records a stretch of time once more, behind itself: scans, odometry and truth from `from_s` on,
/// for less than `duration_s` [s]. The times of the copies, and all that follow, are shifted so
/// that time goes on; the odometry is as recorded, and so leaps back and, after the copies, ahead.
/// Returns the first copy.
std::size_t RepeatStretch(double from_s, double duration_s, SimulatedLog* log);

/// Lets the log of another drive, with the same laser and at least one scan, begin one step of its
/// own time after the end of `log`. Odometry, true poses and true points of its first scan are
/// moved onto the last of `log`, which is as good as any place, as nothing ties the two. Returns
/// the first scan of `next`. InvalidArgument if the lasers differ or a log is empty; `log` is then
/// untouched.
Status AppendLog(const SimulatedLog& next, SimulatedLog* log, std::size_t* first_scan);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_LOG_FAULTS_H_
