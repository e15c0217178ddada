#include "plumbline/apps/evaluation/truth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

#include "plumbline/apps/evaluation/alignment.h"
#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/core/map_points.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

// Logs keep six decimals of a second, and no scanner is faster than one scan per millisecond.
long long Milliseconds(double timestamp_s) { return std::llround(1e3 * timestamp_s); }

Status JoinTrajectory(const std::string& path, const SlamGraph& graph, Truth* truth) {
  std::vector<TimedPose> read;
  PLUMBLINE_RETURN_IF_ERROR(ReadTumTrajectory(path, &read));
  Pairing pairing;
  PLUMBLINE_RETURN_IF_ERROR(ChoosePairing({path, TimesOf(read)}, {"the log", graph.timestamps_s()},
                                          kSameTime_s, &pairing));
  if (pairing.by_order) {
    for (int p = 0; p < graph.num_poses(); ++p) {
      truth->trajectory.push_back({graph.timestamp_s(p), read[p].world_from_robot});
    }
    return Status::Ok();
  }
  std::map<long long, Pose2> by_time;
  for (const TimedPose& pose : read) {
    by_time[Milliseconds(pose.timestamp_s)] = pose.world_from_robot;
  }
  for (int p = 0; p < graph.num_poses(); ++p) {
    const auto found = by_time.find(Milliseconds(graph.timestamp_s(p)));
    if (found == by_time.end()) {
      return Status::InvalidArgument(path + ": no pose for the scan at time " +
                                     std::to_string(graph.timestamp_s(p)));
    }
    truth->trajectory.push_back({graph.timestamp_s(p), found->second});
  }
  return Status::Ok();
}

Status JoinHits(const std::string& path, const SlamGraph& graph, Truth* truth) {
  const std::string fault = ClockFault(graph.timestamps_s());
  if (!fault.empty()) {
    return Status::InvalidArgument(path + ": hits find their scans by time, but of the log " +
                                   fault);
  }
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(path));
  std::map<std::pair<long long, int>, std::pair<double, double>> hits;
  std::string_view line;
  while (reader.NextLine(&line)) {
    if (line.empty() || line.front() == '#') continue;
    FieldReader fields(line);
    const double t = fields.Time("t");
    const int beam = fields.Count("beam");
    const double x = fields.Coordinate("x"), y = fields.Coordinate("y");
    fields.ExpectEnd();
    if (!fields.ok()) {
      return Status::InvalidArgument(path + ":" + std::to_string(reader.line_number()) + ": " +
                                     fields.error());
    }
    hits[{Milliseconds(t), beam}] = {x, y};
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.CheckWhole());
  truth->points.assign(2 * graph.num_returns(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t r = 0; r < graph.num_returns(); ++r) {
    const double t = graph.timestamp_s(graph.scan(graph.ScanOfReturn(r)).pose);
    const auto found = hits.find({Milliseconds(t), graph.Beam(r)});
    if (found == hits.end()) continue;
    truth->points[2 * r] = found->second.first;
    truth->points[2 * r + 1] = found->second.second;
  }
  return Status::Ok();
}

}  // namespace

Status ReadTruth(const std::string& trajectory_path, const std::string& hits_path,
                 const SlamGraph& graph, Truth* truth) {
  Truth result;
  PLUMBLINE_RETURN_IF_ERROR(JoinTrajectory(trajectory_path, graph, &result));
  if (!hits_path.empty()) PLUMBLINE_RETURN_IF_ERROR(JoinHits(hits_path, graph, &result));
  *truth = std::move(result);
  return Status::Ok();
}

TruthError CompareWithTruth(const SlamGraph& graph, const MapState& state, const Truth& truth) {
  TruthError error;
  const int n = state.num_poses();
  if (n == 0) return error;
  const std::vector<Pose2> estimated = PosesOf(state.poses);
  std::vector<Pose2> exact;
  exact.reserve(n);
  for (int p = 0; p < n; ++p) exact.push_back(truth.trajectory[p].world_from_robot);
  const Pose2 truth_from_estimate = AlignTrajectories(estimated, exact);
  for (int p = 0; p < n; ++p) {
    const Pose2 pose = truth_from_estimate * estimated[p];
    const double distance = std::hypot(pose.x - exact[p].x, pose.y - exact[p].y);
    error.mean_pose_error_m += distance / n;
    error.max_pose_error_m = std::max(error.max_pose_error_m, distance);
    error.mean_pose_error_rad += std::abs(NormalizeAngle(pose.yaw - exact[p].yaw)) / n;
  }
  std::vector<double> sum_and_count = {0.0, 0.0};
  if (!truth.points.empty()) {
    MapPoints(graph, state).ForEach([&](std::size_t r, double x, double y) {
      const std::size_t id = graph.ReturnIdAmongAll(r);
      const Eigen::Vector2d true_point(truth.points[2 * id], truth.points[2 * id + 1]);
      if (!true_point.allFinite()) return;
      sum_and_count[0] += (truth_from_estimate * Eigen::Vector2d(x, y) - true_point).norm();
      sum_and_count[1] += 1.0;
    });
    SumOverPeers(graph.peers(), &sum_and_count);
  }
  error.mean_point_error_m = sum_and_count[0] / sum_and_count[1];  // 0 / 0 is NaN, as documented.
  return error;
}

void ShareTruth(const Peers* peers, Truth* truth) {
  truth->trajectory = JoinOverPeers(peers, std::move(truth->trajectory));
  truth->points = JoinOverPeers(peers, std::move(truth->points));
}

}  // namespace plumbline
