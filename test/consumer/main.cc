// How to embed Plumbline: a host has key frames, with poses that are a few centimetres off;
// Plumbline refines them, all scans at once. Here a robot has driven around a square room.
#include <plumbline/solvers/solve.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

using plumbline::Pose2;

namespace {

constexpr double kWallM = 3.0;  // the walls stand at x, y = +-3 m

// What the host knows of one scan.
struct Keyframe {
  Pose2 world_from_robot;        // to be refined
  Pose2 previous_from_this;      // by odometry
  std::vector<double> ranges_m;  // one per beam; NaN or out of range: no return
};

plumbline::LaserModel Laser() {
  plumbline::LaserModel laser;
  laser.num_beams = 360;
  laser.first_bearing_rad = plumbline::DegToRad(-180.0);
  laser.bearing_step_rad = plumbline::DegToRad(1.0);
  return laser;
}

plumbline::SlamGraph MakeGraph(const std::vector<Keyframe>& keyframes) {
  plumbline::SlamGraph graph;
  const int laser = graph.AddLaser(Laser());
  for (const Keyframe& keyframe : keyframes) {
    const double time_s = graph.num_poses();
    const int pose = graph.AddPose(keyframe.world_from_robot, time_s);
    graph.AddScan(pose, laser, keyframe.ranges_m);
    if (pose == 0) continue;
    graph.AddOdometry({pose - 1, pose, keyframe.previous_from_this});
  }
  return graph;
}

plumbline::Solution Refine(const plumbline::SlamGraph& graph) {
  plumbline::SolverOptions options;
  options.factors.beam.sigma_range_m = 0.01;
  options.callback = [](const plumbline::IterationSummary& iteration) {
    return iteration.total_time_s < 60.0;  // false would stop, with the best state so far
  };
  plumbline::Solution solution = plumbline::Solve(graph, options);
  std::puts(solution.report.BriefReport().c_str());
  if (!solution.status.ok()) std::fprintf(stderr, "%s\n", solution.status.message().c_str());
  return solution;
}

// Where a beam meets a wall [m].
double RangeInRoom(const Pose2& pose, double bearing_rad) {
  const double dx = std::cos(pose.yaw + bearing_rad), dy = std::sin(pose.yaw + bearing_rad);
  return std::min((std::copysign(kWallM, dx) - pose.x) / dx,
                  (std::copysign(kWallM, dy) - pose.y) / dy);
}

// Key frames with 1 cm of noise in each range, 3 cm and 0.02 rad in each pose and odometry step.
std::vector<Keyframe> Drive(const std::vector<Pose2>& truth) {
  std::mt19937 engine(1);
  std::normal_distribution<double> noise;
  const auto disturb = [&](const Pose2& pose) {
    return pose * Pose2(0.03 * noise(engine), 0.03 * noise(engine), 0.02 * noise(engine));
  };
  std::vector<Keyframe> keyframes(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    keyframes[i].world_from_robot = i == 0 ? truth[i] : disturb(truth[i]);  // the first one stays
    if (i > 0) keyframes[i].previous_from_this = disturb(Between(truth[i - 1], truth[i]));
    for (int beam = 0; beam < Laser().num_beams; ++beam) {
      const double range_m = RangeInRoom(truth[i], Laser().Bearing(beam));
      keyframes[i].ranges_m.push_back(range_m + 0.01 * noise(engine));
    }
  }
  return keyframes;
}

double MeanError(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double sum_m = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sum_m += (poses[i].translation() - truth[i].translation()).norm();
  }
  return sum_m / poses.size();
}

}  // namespace

int main() {
  std::vector<Pose2> truth;
  for (int i = 0; i < 12; ++i) {
    const double turn = plumbline::DegToRad(30.0 * i);
    truth.emplace_back(1.5 * std::cos(turn), 1.5 * std::sin(turn),
                       turn + plumbline::DegToRad(90.0));
  }
  const plumbline::SlamGraph graph = MakeGraph(Drive(truth));
  const double before_m = MeanError(plumbline::PosesOf(graph.initial_poses()), truth);
  const plumbline::Solution solution = Refine(graph);
  if (!solution.status.ok()) return 1;
  const double after_m = MeanError(solution.poses, truth);
  std::printf("mean error of the poses: %.4f m -> %.4f m\n", before_m, after_m);
  return after_m < 0.5 * before_m ? 0 : 1;
}
