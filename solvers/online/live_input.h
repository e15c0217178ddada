#ifndef PLUMBLINE_SOLVERS_ONLINE_LIVE_INPUT_H_
#define PLUMBLINE_SOLVERS_ONLINE_LIVE_INPUT_H_

#include <optional>
#include <vector>

#include "plumbline/core/laser_scan.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/online/live_matching.h"

namespace plumbline {

/// The scans and the odometry of a drive as a host gives them, one at a time.
class LiveInput {
 public:
  explicit LiveInput(const std::vector<LaserModel>& lasers) : lasers_(lasers) {}

  /// Checks a scan, and makes its measurements. The next one is checked against it once Accept was
  /// called. InvalidArgument as OnlineMapper::AddScan says, without the number of the scan.
  Status Take(const LaserScan& scan, const std::optional<Pose2>& odometry, int laser,
              LiveScan* live) const;
  void Accept(const LiveScan& live, const std::optional<Pose2>& odometry);

 private:
  const std::vector<LaserModel> lasers_;
  std::optional<Pose2> first_odometry_, last_odometry_;
  Pose2 last_initial_;
  std::optional<double> last_time_s_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ONLINE_LIVE_INPUT_H_
