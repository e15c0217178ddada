#include "plumbline/solvers/online/live_input.h"

#include <cstddef>
#include <string>

namespace plumbline {
namespace {

// Odometry jumps if a step exceeds this length [m] plus this speed [m/s] times its duration: no
// indoor robot drives as fast.
constexpr double kMaxStepM = 5.0, kMaxSpeedMS = 20.0;

// The status of a graph of one scan, without the name of the refused measurement: the mapper counts
// scans by itself.
Status WithoutName(const Status& status) {
  if (status.ok()) return status;
  constexpr std::size_t kColon = 2;  // and a blank
  return Status::InvalidArgument(status.message().substr(status.message().find(": ") + kColon));
}

}  // namespace

Status LiveInput::Take(const LaserScan& scan, const std::optional<Pose2>& odometry, int laser,
                       LiveScan* live) const {
  if (laser < 0 || laser >= static_cast<int>(lasers_.size())) {
    return Status::InvalidArgument("laser " + std::to_string(laser) + " is unknown, there are " +
                                   std::to_string(lasers_.size()));
  }
  const Pose2 initial =
      odometry && first_odometry_ ? Between(*first_odometry_, *odometry) : last_initial_;
  SlamGraph* measured = &live->measured;
  const int laser_id = measured->AddLaser(lasers_[laser]);
  const int pose_id = measured->AddPose(initial, scan.timestamp_s);
  measured->AddScan(pose_id, laser_id, scan.ranges);
  PLUMBLINE_RETURN_IF_ERROR(WithoutName(measured->status()));
  // The frame of the odometry has the same bounds as that of the map.
  if (odometry) {
    SlamGraph bounds;
    bounds.AddPose(*odometry, scan.timestamp_s);
    PLUMBLINE_RETURN_IF_ERROR(WithoutName(bounds.status()));
  }
  if (!last_time_s_) return Status::Ok();
  const double duration_s = scan.timestamp_s - *last_time_s_;
  if (duration_s < 0.0) {
    return Status::InvalidArgument("its time, " + std::to_string(scan.timestamp_s) +
                                   " s, is before that of the scan before it, " +
                                   std::to_string(*last_time_s_) + " s");
  }
  if (!odometry || !last_odometry_) return Status::Ok();
  live->step = Between(*last_odometry_, *odometry);
  const double length_m = live->step->translation().norm();
  if (length_m <= kMaxStepM + kMaxSpeedMS * duration_s) return Status::Ok();
  return Status::InvalidArgument("the odometry jumps by " + std::to_string(length_m) + " m in " +
                                 std::to_string(duration_s) + " s");
}

void LiveInput::Accept(const LiveScan& live, const std::optional<Pose2>& odometry) {
  last_initial_ = live.measured.InitialPose(0);
  last_time_s_ = live.measured.timestamp_s(0);
  last_odometry_ = odometry;
  if (odometry && !first_odometry_) first_odometry_ = odometry;
}

}  // namespace plumbline
