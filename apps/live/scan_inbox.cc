#include "plumbline/apps/live/scan_inbox.h"

#include <cmath>
#include <string>
#include <utility>

#include "plumbline/apps/io/ros_scans.h"
#include "plumbline/core/input_limits.h"

namespace plumbline {
namespace {

constexpr std::size_t kMaxWaitingScans = 200;
// A scan that is older than the one before by more than this tells of a clock that was set [s].
constexpr double kMaxLateS = 0.5;
// A pause in the scans that is worth telling [s].
constexpr double kLongGapS = 5.0;
// Time from the scan before a jump of the clock to the one after it [s].
constexpr double kStepAfterJumpS = 0.1;

}  // namespace

bool ScanInbox::IsOfUse(const RosScan& scan, FaultLog* faults) const {
  std::string fault = scan.fault.empty() ? ScanFault(scan, scan.range_max_m > 0.0) : scan.fault;
  if (fault.empty() && !(std::abs(scan.stamp_s) <= kMaxTimeS)) {
    fault = "field 'header.stamp' is no time";
  }
  if (!fault.empty()) {
    faults->Add("scans that are no sweep of a laser", fault);
    return false;
  }
  if (!has_last_) return true;
  const double step_s = scan.stamp_s - last_stamp_s_;
  if (step_s < -kMaxLateS) return true;
  if (step_s < 0.0) {
    faults->Add("scans older than the one before",
                "by " + std::to_string(-step_s) + " s; they are left out");
    return false;
  }
  if (step_s < min_interval_s_) {
    faults->Add("scans too soon after the one before",
                "after " + std::to_string(step_s) + " s; they are left out");
    return false;
  }
  return true;
}

bool ScanInbox::Add(RosScan scan, double now_s, FaultLog* faults) {
  if (!IsOfUse(scan, faults)) return false;
  const double step_s = has_last_ ? scan.stamp_s - last_stamp_s_ : 0.0;
  const bool has_jumped = step_s < 0.0;
  if (has_jumped) {
    faults->Add("jumps of the clock", "the stamps of the scans go back by " +
                                          std::to_string(-step_s) + " s; the drive goes on");
    drive_time_offset_s_ += kStepAfterJumpS - step_s;
  } else if (step_s > kLongGapS) {
    faults->Add("gaps in the scans", "of " + std::to_string(step_s) + " s");
  }
  has_last_ = true;
  last_stamp_s_ = scan.stamp_s;
  if (scans_.size() == kMaxWaitingScans) {
    faults->Add("scans that came faster than they were mapped", "the oldest ones are left out");
    scans_.pop_front();
  }
  const double drive_time_s = scan.stamp_s + drive_time_offset_s_;
  scans_.push_back({std::move(scan), now_s, drive_time_s, has_jumped});
  return has_jumped;
}

WaitingScan ScanInbox::Take() {
  WaitingScan scan = std::move(scans_.front());
  scans_.pop_front();
  return scan;
}

}  // namespace plumbline
