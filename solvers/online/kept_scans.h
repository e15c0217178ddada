#ifndef PLUMBLINE_SOLVERS_ONLINE_KEPT_SCANS_H_
#define PLUMBLINE_SOLVERS_ONLINE_KEPT_SCANS_H_

#include <optional>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/online/live_matching.h"

namespace plumbline {

/// Chooses the scans of a drive that become poses of its map.
class KeptScans {
 public:
  /// min_step_m: see OnlineMapperOptions.
  explicit KeptScans(double min_step_m) : min_step_m_(min_step_m) {}

  /// Whether the next scan of the drive, which was matched, is kept. The steps of a kept one then
  /// lead to it from the kept one before.
  bool Keep(LiveScan* scan);

 private:
  const double min_step_m_;
  bool has_any_ = false;
  Pose2 last_;                 // the kept scan's pose, as matched
  std::optional<Pose2> step_;  // odometry since then; none if a part of it is not known
  Pose2 as_driven_;            // likewise, as LiveScan::step_as_driven
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ONLINE_KEPT_SCANS_H_
