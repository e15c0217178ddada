#include "plumbline/core/sweep_motion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// A robot's velocity of a second ago says little of the present one.
constexpr double kMaxGapS = 1.0;

// sin(x) / x and (1 - cos(x)) / x.
double Sinc(double x) { return std::abs(x) < 1e-6 ? 1.0 : std::sin(x) / x; }
double Cosc(double x) { return std::abs(x) < 1e-6 ? 0.5 * x : (1.0 - std::cos(x)) / x; }

// How the robot moves from a pose on.
struct Velocity {
  Pose2 motion;
  double duration_s = 0.0;
};

std::optional<Velocity> VelocityBetween(const SlamGraph& graph, const std::vector<double>& poses,
                                        int from, int to) {
  if (from < 0 || to >= graph.num_poses()) return std::nullopt;
  const double duration_s = graph.timestamp_s(to) - graph.timestamp_s(from);
  if (!(duration_s > 0.0) || duration_s > kMaxGapS) return std::nullopt;
  return Velocity{Between(Pose2(&poses[3 * from]), Pose2(&poses[3 * to])), duration_s};
}

}  // namespace

Pose2 PartOfMotion(const Pose2& motion, double share) {
  // Of an arc that ends at (x, y), turned by yaw, the velocity (u, v) at its start solves
  // x = sinc u - cosc v, y = cosc u + sinc v.
  const double sinc = Sinc(motion.yaw), cosc = Cosc(motion.yaw);
  const double square = sinc * sinc + cosc * cosc;
  const double u = share * (sinc * motion.x + cosc * motion.y) / square;
  const double v = share * (sinc * motion.y - cosc * motion.x) / square;
  const double yaw = share * motion.yaw;
  return {Sinc(yaw) * u - Cosc(yaw) * v, Cosc(yaw) * u + Sinc(yaw) * v, yaw};
}

BeamReturn SeenFromBefore(const BeamReturn& measured, const Pose2& before_from_now) {
  const Eigen::Vector2d point = before_from_now * BeamEnd(measured.range_m, measured.bearing_rad);
  const double turn_rad = std::atan2(point.y(), point.x()) - measured.bearing_rad;
  return {point.norm(), measured.bearing_rad + NormalizeAngle(turn_rad)};
}

bool HasSweeps(const SlamGraph& graph) {
  for (int laser = 0; laser < graph.num_lasers(); ++laser) {
    if (graph.laser(laser).beam_period_s > 0.0) return true;
  }
  return false;
}

MeasurementCorrections TakeOutSweepMotion(const SlamGraph& measured, SweepOrder order,
                                          const std::vector<double>& poses) {
  const std::vector<float>& ranges_m = measured.returns().range_m;
  MeasurementCorrections corrections;
  corrections.range_m.assign(ranges_m.begin(), ranges_m.end());
  corrections.bearing_rad = measured.Bearings();
  if (order == SweepOrder::kAtOnce) return corrections;
  for (int s = 0; s < measured.num_scans(); ++s) {
    const ScanEntry& scan = measured.scan(s);
    const LaserModel& laser = measured.LaserOfScan(s);
    std::optional<Velocity> velocity = VelocityBetween(measured, poses, scan.pose, scan.pose + 1);
    if (!velocity) velocity = VelocityBetween(measured, poses, scan.pose - 1, scan.pose);
    if (!velocity || laser.beam_period_s <= 0.0) continue;
    const Pose2 laser_from_robot = laser.robot_from_laser.Inverse();
    const ScanReturns returns = measured.ReturnsOfScan(s);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const int beam = order == SweepOrder::kFirstBeamFirst ? returns.Beam(r)
                                                            : laser.num_beams - 1 - returns.Beam(r);
      const double share = beam * laser.beam_period_s / velocity->duration_s;
      const Pose2 moved =
          laser_from_robot * PartOfMotion(velocity->motion, share) * laser.robot_from_laser;
      const BeamReturn before = SeenFromBefore({ranges_m[r], returns.Bearing(r)}, moved);
      corrections.range_m[r] = before.range_m;
      corrections.bearing_rad[r] = before.bearing_rad;
    }
  }
  return corrections;
}

}  // namespace plumbline
