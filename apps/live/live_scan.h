#ifndef PLUMBLINE_APPS_LIVE_LIVE_SCAN_H_
#define PLUMBLINE_APPS_LIVE_LIVE_SCAN_H_

#include <vector>

#include "plumbline/apps/io/ros_mounting.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/core/laser_scan.h"

namespace plumbline {

/// The laser of a scan without a ScanFault, mounted at `place`. A laser that hangs upside down has
/// its bearings the other way round. Readings from range_max on are no returns.
LaserModel LaserOf(const RosScan& scan, const LaserPlace& place);

/// The ranges [m] of a scan, one per beam of `laser`, which is that of an earlier scan. A scan with
/// other beams gives each of the laser's beams its nearest reading, if that is at most half a step
/// away; the others are infinite. Empty if fewer than half of the scan's readings find a beam.
/// is_resampled: becomes true if the beams differ.
std::vector<double> RangesFor(const LaserModel& laser, const LaserPlace& place, const RosScan& scan,
                              bool* is_resampled);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_LIVE_SCAN_H_
