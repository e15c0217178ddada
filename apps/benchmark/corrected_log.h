#ifndef PLUMBLINE_APPS_BENCHMARK_CORRECTED_LOG_H_
#define PLUMBLINE_APPS_BENCHMARK_CORRECTED_LOG_H_

#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// The scans that a raw log has in common with a log of the same drive in which another mapper has
/// replaced the odometry by its own result.
struct CorrectedLog {
  CarmenLog raw;        ///< these scans as the raw log has them
  CarmenLog corrected;  ///< the same, with times and laser of the raw log, at the corrected poses
};

/// Pairs the scans by their ranges, in order of time: the clocks of two such logs need not agree.
/// The corrected pose of a scan is its first one, that of the laser; the robot's follows from where
/// the raw log has the laser. InvalidArgument if less than half of the corrected scans are found in
/// the raw log, which must have scans.
Status PairCorrectedLog(const CarmenLog& raw, const CarmenLog& corrected, CorrectedLog* pair);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_CORRECTED_LOG_H_
