#ifndef PLUMBLINE_APPS_LIVE_SCAN_INBOX_H_
#define PLUMBLINE_APPS_LIVE_SCAN_INBOX_H_

#include <cstddef>
#include <deque>

#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/apps/live/fault_log.h"

namespace plumbline {

/// A scan that waits to be mapped.
struct WaitingScan {
  RosScan scan;
  double arrival_s = 0.0;     ///< by the clock of the node
  double drive_time_s = 0.0;  ///< like the stamps, but it never goes back
  bool after_jump = false;    ///< the clock has jumped back before it
};

/// The scans that wait to be mapped, in order of their stamps. Scans of no use are left out and
/// counted. Its memory is bounded.
class ScanInbox {
 public:
  /// min_interval_s: scans that come sooner after the one before are left out.
  explicit ScanInbox(double min_interval_s) : min_interval_s_(min_interval_s) {}

  /// Takes a scan if it is of use; see LiveNode. True if the clock has jumped back before it.
  bool Add(RosScan scan, double now_s, FaultLog* faults);

  bool empty() const { return scans_.empty(); }
  const WaitingScan& front() const { return scans_.front(); }
  WaitingScan Take();
  /// Leaves all waiting scans out.
  void Drop() { scans_.clear(); }

 private:
  bool IsOfUse(const RosScan& scan, FaultLog* faults) const;

  const double min_interval_s_;
  std::deque<WaitingScan> scans_;
  bool has_last_ = false;
  double last_stamp_s_ = 0.0;
  double drive_time_offset_s_ = 0.0;  // from the stamps to the times of the drive
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_SCAN_INBOX_H_
