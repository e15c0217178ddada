// A host has a pose graph and the scan of every pose, and wants a sharper map: the program of the
// tutorial, tutorial.md. The building is simulated here; all else is what a host would write.
#include <plumbline/core/slam_graph.h>
#include <plumbline/solvers/covariance.h>
#include <plumbline/solvers/solve.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

using plumbline::LaserModel;
using plumbline::MapState;
using plumbline::Pose2;
using plumbline::RelativePoseConstraint;
using plumbline::SlamGraph;
using plumbline::Solution;
using plumbline::Status;

namespace {

// [host]
// What a pose graph back end has at hand.
struct Node {
  double timestamp_s;
  Pose2 world_from_robot;        // right to some centimetres
  std::vector<double> ranges_m;  // one per beam; NaN, infinity or out of limits: no return
};
struct PoseGraph {
  std::vector<Node> nodes;
  std::vector<RelativePoseConstraint> edges;  // scan matches and loop closures, with covariances
};
// [host]

// [laser]
LaserModel Laser() {
  LaserModel laser;
  laser.num_beams = 360;  // beam i leaves at first_bearing_rad + i * bearing_step_rad
  laser.first_bearing_rad = plumbline::DegToRad(-180.0);
  laser.bearing_step_rad = plumbline::DegToRad(1.0);
  laser.min_range_m = 0.1;
  laser.max_range_m = 10.0;              // the reading for "nothing there" must not lie below it
  laser.robot_from_laser = {0.2, 0, 0};  // mounted 0.2 m in front of the robot's origin
  return laser;
}
// [laser]

// [graph]
SlamGraph MakeGraph(const PoseGraph& host) {
  SlamGraph graph;
  const int laser_id = graph.AddLaser(Laser());
  for (const Node& node : host.nodes) {
    const int pose_id = graph.AddPose(node.world_from_robot, node.timestamp_s);
    graph.AddScan(pose_id, laser_id, node.ranges_m);
  }
  for (const RelativePoseConstraint& edge : host.edges) {
    graph.AddRelativePose(edge);
  }
  return graph;  // a bad measurement: graph.status(), and Refine fails with it
}
// [graph]

// [options]
plumbline::SolverOptions Options() {
  plumbline::SolverOptions options;
  options.factors.beam.sigma_range_m = 0.01;  // from the data sheet of the laser
  options.callback = [](const plumbline::IterationSummary& iteration) {
    return iteration.total_time_s < 60.0;  // false stops with the best state so far
  };
  return options;
}
// [options]

// [solve]
Solution Refine(const SlamGraph& graph) {
  Solution solution = plumbline::Solve(graph, Options());
  std::puts(solution.report.BriefReport().c_str());
  return solution;
}
// [solve]

// [residuals]
// Drops the edges that the scans and the other edges contradict, chi-squared with three degrees of
// freedom. Returns how many there were.
Status DropFalseEdges(const SlamGraph& graph, const MapState& state, PoseGraph* host,
                      int* num_dropped) {
  constexpr double kMaxChi2 = 100.0;  // sound edges stay below 16.3; leave some room for optimism
  plumbline::Residuals residuals;
  PLUMBLINE_RETURN_IF_ERROR(plumbline::EvaluateResiduals(Options(), graph, state, &residuals));
  std::vector<RelativePoseConstraint> kept;
  for (std::size_t i = 0; i < host->edges.size(); ++i) {
    const double chi2 = residuals.relative_poses[i].squaredNorm();
    if (chi2 <= kMaxChi2) kept.push_back(host->edges[i]);
  }
  *num_dropped = static_cast<int>(host->edges.size() - kept.size());
  host->edges = kept;
  return Status::Ok();
}
// [residuals]

// [covariance]
Status PrintSigmas(const SlamGraph& graph, const MapState& state, int pose) {
  std::vector<Eigen::Matrix3d> covariances;
  PLUMBLINE_RETURN_IF_ERROR(
      plumbline::ComputePoseCovariances(Options(), graph, state, {{pose, pose}}, &covariances));
  const Eigen::Vector3d sigma = covariances[0].diagonal().cwiseSqrt();
  std::printf("pose %d: sigma x %.1f mm, y %.1f mm, yaw %.2f mrad\n", pose, 1e3 * sigma.x(),
              1e3 * sigma.y(), 1e3 * sigma.z());
  return Status::Ok();
}
// [covariance]

// ---- The world that stands in for a robot: a hall with walls at x = +-6 m and y = +-4 m. ----

constexpr double kHalfXM = 6.0, kHalfYM = 4.0;

double RangeInHall(const Pose2& laser, double bearing_rad) {
  const double dx = std::cos(laser.yaw + bearing_rad), dy = std::sin(laser.yaw + bearing_rad);
  return std::min((std::copysign(kHalfXM, dx) - laser.x) / dx,
                  (std::copysign(kHalfYM, dy) - laser.y) / dy);
}

// Once around the hall and a little further.
std::vector<Pose2> TruePath() {
  std::vector<Pose2> path;
  for (int i = 0; i < 40; ++i) {
    const double turn = plumbline::DegToRad(10.0 * i);
    path.emplace_back(3.5 * std::cos(turn), 2.0 * std::sin(turn),
                      std::atan2(2.0 * std::cos(turn), -3.5 * std::sin(turn)));
  }
  return path;
}

// Poses that are 3 cm and 0.01 rad off, sound edges, and one loop closure that is false.
PoseGraph MakePoseGraph(const std::vector<Pose2>& truth) {
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma_m, double sigma_rad) {
    const double x = sigma_m * normal(engine), y = sigma_m * normal(engine);
    return Pose2(x, y, sigma_rad * normal(engine));
  };
  PoseGraph host;
  const Eigen::Matrix3d covariance = Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    Node node{0.5 * i, i == 0 ? truth[i] : truth[i] * noise(0.03, 0.01), {}};
    const Pose2 world_from_laser = truth[i] * Laser().robot_from_laser;
    for (int beam = 0; beam < Laser().num_beams; ++beam) {
      node.ranges_m.push_back(RangeInHall(world_from_laser, Laser().Bearing(beam)) +
                              0.01 * normal(engine));
    }
    host.nodes.push_back(node);
    const int to = static_cast<int>(i);
    if (i > 0) {
      host.edges.push_back(
          {to - 1, to, Between(truth[i - 1], truth[i]) * noise(0.02, 0.01), covariance});
    }
  }
  host.edges.push_back({2, 38, Between(truth[2], truth[38]) * noise(0.02, 0.01), covariance});
  host.edges.push_back({5, 20, Pose2(0.5, 0.2, 0.1), covariance});
  return host;
}

// Mean distance [m] of the map points from the nearest wall.
double MapError(const std::vector<double>& points) {
  const std::size_t num_points = points.size() / 2;
  double sum_m = 0.0;
  for (std::size_t i = 0; i < num_points; ++i) {
    const double x = points[2 * i], y = points[2 * i + 1];
    sum_m += std::min(std::abs(kHalfXM - std::abs(x)), std::abs(kHalfYM - std::abs(y)));
  }
  return sum_m / num_points;
}

Status Run(bool* sharper) {
  PoseGraph host = MakePoseGraph(TruePath());
  SlamGraph graph = MakeGraph(host);
  const double before_m = MapError(graph.InitialState().points);
  Solution map = Refine(graph);
  PLUMBLINE_RETURN_IF_ERROR(map.status);

  // [again]
  int num_dropped = 0;
  PLUMBLINE_RETURN_IF_ERROR(DropFalseEdges(graph, map.State(), &host, &num_dropped));
  if (num_dropped > 0) {
    graph = MakeGraph(host);
    map = Refine(graph);
    PLUMBLINE_RETURN_IF_ERROR(map.status);
  }
  // [again]
  std::printf("%d edges dropped, %zu kept\n", num_dropped, host.edges.size());

  // [result]
  for (int pose = 0; pose < graph.num_poses(); pose += 10) {
    const Pose2& world_from_robot = map.poses[pose];
    std::printf("t = %.1f s: x %.3f m, y %.3f m, yaw %.4f rad\n", graph.timestamp_s(pose),
                world_from_robot.x, world_from_robot.y, world_from_robot.yaw);
  }
  std::printf("%zu map points, the first at (%.3f, %.3f)\n", graph.num_returns(), map.point(0).x(),
              map.point(0).y());
  // [result]

  PLUMBLINE_RETURN_IF_ERROR(PrintSigmas(graph, map.State(), graph.num_poses() - 1));
  const double after_m = MapError(map.points);
  std::printf("mean error of the map: %.1f mm -> %.1f mm\n", 1e3 * before_m, 1e3 * after_m);
  *sharper = num_dropped > 0 && after_m < 0.25 * before_m;
  return Status::Ok();
}

}  // namespace

int main() {
  bool sharper = false;
  const Status status = Run(&sharper);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.message().c_str());
  return status.ok() && sharper ? 0 : 1;
}
