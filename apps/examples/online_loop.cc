// A robot that maps while it drives. Every few keyframes the map is updated, which moves the newest
// poses; when the host recognises a place, the next update moves all of them. The drive, around a
// block in a hall, is simulated here; all else is what a host would write.
#include <plumbline/core/slam_graph.h>
#include <plumbline/solvers/covariance.h>
#include <plumbline/solvers/incremental_solver.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

using plumbline::Pose2;
using plumbline::RelativePoseConstraint;
using plumbline::Status;

namespace {

constexpr int kKeyframesPerUpdate = 5;

plumbline::LaserModel Laser() {
  plumbline::LaserModel laser;
  laser.num_beams = 180;
  laser.first_bearing_rad = plumbline::DegToRad(-180.0);
  laser.bearing_step_rad = plumbline::DegToRad(2.0);
  laser.max_range_m = 7.5;
  return laser;
}

// ---- The host. ----

class OnlineMapper {
 public:
  // A key frame: ranges [m], one per beam, and the odometry since the one before.
  Status AddKeyframe(const Pose2& previous_from_this, const std::vector<double>& ranges_m) {
    if (graph_.num_poses() == 0) laser_ = graph_.AddLaser(Laser());
    const int previous = graph_.num_poses() - 1;
    Pose2 predicted;  // the first pose is the origin of the map
    if (previous >= 0) predicted = Pose2(&poses_[3 * previous]) * previous_from_this;
    const int pose = graph_.AddPose(predicted, 0.1 * graph_.num_poses());
    poses_.insert(poses_.end(), {predicted.x, predicted.y, predicted.yaw});
    graph_.AddScan(pose, laser_, ranges_m);
    if (previous >= 0) {
      graph_.AddOdometry({previous, pose, previous_from_this});
    }
    return graph_.num_poses() % kKeyframesPerUpdate == 0 ? Update() : Status::Ok();
  }

  // A place that was recognised: earlier and later pose, and how they lie to each other.
  Status CloseLoop(const RelativePoseConstraint& closure) {
    graph_.AddRelativePose(closure);
    return Update();
  }

  // How sure the newest pose is (x, y [m], yaw [rad]).
  Status NewestCovariance(Eigen::Matrix3d* covariance) const {
    const int newest = graph_.num_poses() - 1;
    plumbline::MapState state;
    PLUMBLINE_RETURN_IF_ERROR(solver_.GetState(graph_, &state));
    std::vector<Eigen::Matrix3d> covariances;
    PLUMBLINE_RETURN_IF_ERROR(plumbline::ComputePoseCovariances(Options(), graph_, state,
                                                                {{newest, newest}}, &covariances));
    *covariance = covariances.front();
    return Status::Ok();
  }

  std::vector<Pose2> poses() const { return plumbline::PosesOf(poses_); }
  int num_updates() const { return num_updates_; }

 private:
  static plumbline::SolverOptions Options() {
    plumbline::SolverOptions options;
    options.factors.beam.sigma_range_m = 0.01;
    return options;
  }

  Status Update() {
    plumbline::IncrementalSummary summary;
    PLUMBLINE_RETURN_IF_ERROR(
        solver_.Update(graph_, plumbline::UpdateScope::kAutomatic, &poses_, &summary));
    ++num_updates_;
    if (summary.num_free_poses == graph_.num_poses() && graph_.num_poses() > 40) {
      std::printf("all %d poses were moved, in %d steps\n", graph_.num_poses(), summary.num_steps);
    }
    return Status::Ok();
  }

  plumbline::IncrementalSolver solver_{Options()};
  plumbline::SlamGraph graph_;  // what was measured
  std::vector<double> poses_;   // what is estimated: x, y [m], yaw [rad] each
  int laser_ = 0;
  int num_updates_ = 0;
};

// ---- The world that stands in for a robot. ----

// Where a beam meets the outer walls of the hall or the block in its middle [m].
double RangeInHall(const Pose2& pose, double bearing_rad) {
  const Eigen::Vector2d direction(std::cos(pose.yaw + bearing_rad),
                                  std::sin(pose.yaw + bearing_rad));
  double range_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& half : {Eigen::Vector2d(8.0, 6.0), Eigen::Vector2d(4.0, 2.0)}) {
    for (int axis = 0; axis < 2; ++axis) {
      for (const double wall : {-half[axis], half[axis]}) {
        const double at_m = (wall - pose.translation()[axis]) / direction[axis];
        const double along = pose.translation()[1 - axis] + at_m * direction[1 - axis];
        if (at_m > 0.0 && std::abs(along) <= half[1 - axis]) range_m = std::min(range_m, at_m);
      }
    }
  }
  return range_m;
}

// Around the block and a little further, so that the beginning is seen again.
std::vector<Pose2> TruePath() {
  std::vector<Pose2> path;
  for (int i = 0; i < 200; ++i) {
    const double turn = plumbline::DegToRad(2.0 * i);
    path.emplace_back(6.0 * std::cos(turn), 4.0 * std::sin(turn),
                      std::atan2(4.0 * std::cos(turn), -6.0 * std::sin(turn)));
  }
  return path;
}

class SimulatedRobot {
 public:
  // The motion as the wheels have it: 2 % too short, always a little to the left.
  Pose2 Odometry(const Pose2& from, const Pose2& to) {
    const Pose2 exact = Between(from, to);
    return {0.98 * exact.x + 0.003 * noise_(engine_), exact.y + 0.003 * noise_(engine_),
            exact.yaw + 0.001 + 0.003 * noise_(engine_)};
  }
  std::vector<double> Scan(const Pose2& pose) {
    std::vector<double> ranges_m;
    for (int beam = 0; beam < Laser().num_beams; ++beam) {
      ranges_m.push_back(RangeInHall(pose, Laser().Bearing(beam)) + 0.01 * noise_(engine_));
    }
    return ranges_m;
  }

 private:
  std::mt19937 engine_{1};
  std::normal_distribution<double> noise_;
};

double MeanError(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double sum_m = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose2 start_from_pose = Between(truth[0], truth[i]);
    sum_m += (poses[i].translation() - start_from_pose.translation()).norm();
  }
  return sum_m / poses.size();
}

Status Run(bool* better) {
  const std::vector<Pose2> truth = TruePath();
  SimulatedRobot robot;
  OnlineMapper mapper;
  std::vector<Pose2> by_odometry;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Pose2 step = i == 0 ? Pose2() : robot.Odometry(truth[i - 1], truth[i]);
    by_odometry.push_back(i == 0 ? Pose2() : by_odometry.back() * step);
    PLUMBLINE_RETURN_IF_ERROR(mapper.AddKeyframe(step, robot.Scan(truth[i])));
  }
  const double odometry_m = MeanError(by_odometry, truth);
  const double updated_m = MeanError(mapper.poses(), truth);
  std::printf("%zu keyframes, %d updates: mean error of the poses %.3f m -> %.3f m\n", truth.size(),
              mapper.num_updates(), odometry_m, updated_m);

  // The place recogniser, good to 1 cm and 3 mrad.
  const int newest = static_cast<int>(truth.size()) - 1;
  RelativePoseConstraint closure{10, newest, Between(truth[10], truth[newest])};
  closure.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  PLUMBLINE_RETURN_IF_ERROR(mapper.CloseLoop(closure));
  const double closed_m = MeanError(mapper.poses(), truth);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  PLUMBLINE_RETURN_IF_ERROR(mapper.NewestCovariance(&covariance));
  const Eigen::Vector3d sigma = covariance.diagonal().cwiseSqrt();
  std::printf("mean error after the loop: %.4f m\n", closed_m);
  std::printf("newest pose: sigma x %.1f mm, y %.1f mm, yaw %.2f mrad\n", 1e3 * sigma.x(),
              1e3 * sigma.y(), 1e3 * sigma.z());
  *better = updated_m < odometry_m && closed_m <= updated_m;
  return Status::Ok();
}

}  // namespace

int main() {
  bool better = false;
  const Status status = Run(&better);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.message().c_str());
  return status.ok() && better ? 0 : 1;
}
