#include "plumbline/solvers/acceptance/mirrored_scans.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <tuple>

#include "plumbline/core/angle.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/pose2.h"

namespace plumbline {
namespace {

struct TurnPair {
  int from, to;               // scan ids, of lasers mounted alike
  Pose2 from_laser_to_laser;  // where the second laser stands, seen from the first
};

// Pairs of scans with a turn between them; each begins where the last one of its laser ended.
std::vector<TurnPair> TurnsOf(const SlamGraph& graph, const std::vector<double>& poses) {
  constexpr double kLeastTurnRad = DegToRad(10.0), kLargestTurnRad = DegToRad(35.0);
  constexpr double kMaxDistanceM = 2.0;
  const auto laser_at = [&](int scan) {
    return Pose2(&poses[3 * graph.scan(scan).pose]) * graph.LaserOfScan(scan).robot_from_laser;
  };
  std::map<std::tuple<double, double, double>, int> last_scan;  // by mounting
  std::vector<TurnPair> pairs;
  for (int to = 0; to < graph.num_scans(); ++to) {
    const Pose2& mounting = graph.LaserOfScan(to).robot_from_laser;
    const auto [entry, is_first] =
        last_scan.try_emplace({mounting.x, mounting.y, mounting.yaw}, to);
    if (is_first) continue;
    const int from = entry->second;
    const Pose2 step = Between(laser_at(from), laser_at(to));
    const double turn_rad = std::abs(NormalizeAngle(step.yaw));
    const bool is_near = step.translation().norm() <= kMaxDistanceM;
    if (is_near && turn_rad < kLeastTurnRad) continue;
    if (is_near && turn_rad <= kLargestTurnRad) pairs.push_back({from, to, step});
    entry->second = to;
  }
  return pairs;
}

// What a scan may be mirrored about.
enum class Mirror { kNone, kFanMiddle, kForwardAxis };

// Returns of a scan in the frame of its laser, at most `max_points`.
std::vector<Eigen::Vector2d> PointsOf(const SlamGraph& graph, int scan_id, Mirror mirror,
                                      std::size_t max_points) {
  const ScanEntry& scan = graph.scan(scan_id);
  const LaserModel& laser = graph.LaserOfScan(scan_id);
  const double bearing_sum_rad =
      mirror == Mirror::kFanMiddle ? laser.Bearing(0) + laser.Bearing(laser.num_beams - 1) : 0.0;
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  const std::size_t stride = (scan.num_returns + max_points - 1) / max_points;
  std::vector<Eigen::Vector2d> points;
  points.reserve(max_points);
  for (std::size_t i = 0; i < scan.num_returns; i += stride) {
    const std::size_t r = scan.first_return + i;
    const double measured_rad = returns.Bearing(r);
    const double bearing_rad =
        mirror == Mirror::kNone ? measured_rad : bearing_sum_rad - measured_rad;
    points.push_back(BeamEnd(graph.returns().range_m[r], bearing_rad));
  }
  return points;
}

// Mean distance [m] of the returns of the second scan from the nearest ones of the first, where
// what has no counterpart counts as 0.5 m.
double Mismatch(const SlamGraph& graph, const TurnPair& pair, Mirror mirror) {
  constexpr std::size_t kMaxQueries = 90, kMaxTargets = 720;
  constexpr double kNoCounterpartM = 0.5;
  const std::vector<Eigen::Vector2d> targets = PointsOf(graph, pair.from, mirror, kMaxTargets);
  const std::vector<Eigen::Vector2d> queries = PointsOf(graph, pair.to, mirror, kMaxQueries);
  double sum_m = 0.0;
  for (const Eigen::Vector2d& query : queries) {
    const Eigen::Vector2d point = pair.from_laser_to_laser * query;
    double nearest_squared = kNoCounterpartM * kNoCounterpartM;
    for (const Eigen::Vector2d& target : targets) {
      nearest_squared = std::min(nearest_squared, (target - point).squaredNorm());
    }
    sum_m += std::sqrt(nearest_squared);
  }
  return queries.empty() ? kNoCounterpartM : sum_m / static_cast<double>(queries.size());
}

// The pairs of this process that are looked at.
std::vector<TurnPair> VotersOf(const SlamGraph& graph, const std::vector<double>& poses) {
  constexpr double kMaxPairs = 48.0;
  const std::vector<TurnPair> pairs = TurnsOf(graph, poses);
  const auto num_own = static_cast<double>(pairs.size());
  const double num_pairs = std::max(1.0, SumOverPeers(graph.peers(), num_own));
  const auto num_voters =
      static_cast<std::size_t>(std::ceil(num_own * std::min(num_pairs, kMaxPairs) / num_pairs));
  std::vector<TurnPair> voters;
  for (std::size_t i = 0; i < num_voters; ++i) {
    voters.push_back(pairs[i * pairs.size() / num_voters]);
  }
  return voters;
}

}  // namespace

TurnVotes VoteOnTurns(const SlamGraph& graph, const std::vector<double>& poses) {
  constexpr double kFarBetter = 0.6;  // of mismatches
  const Peers* peers = graph.peers();
  TurnVotes votes;
  for (const TurnPair& pair : VotersOf(graph, poses)) {
    const double as_they_are = Mismatch(graph, pair, Mirror::kNone);
    const double mirrored = std::min(Mismatch(graph, pair, Mirror::kFanMiddle),
                                     Mismatch(graph, pair, Mirror::kForwardAxis));
    if (as_they_are < kFarBetter * mirrored) ++votes.as_they_are;
    if (mirrored < kFarBetter * as_they_are) ++votes.mirrored;
  }
  std::vector<int> sums = {votes.as_they_are, votes.mirrored};
  SumOverPeers(peers, &sums);
  return {sums[0], sums[1]};
}

std::optional<double> TurnMismatch(const SlamGraph& graph, const std::vector<double>& poses) {
  constexpr double kMinPairs = 8.0;
  std::vector<double> sums = {0.0, 0.0};
  for (const TurnPair& pair : VotersOf(graph, poses)) {
    sums[0] += Mismatch(graph, pair, Mirror::kNone);
    sums[1] += 1.0;
  }
  SumOverPeers(graph.peers(), &sums);
  if (sums[1] < kMinPairs) return std::nullopt;
  return sums[0] / sums[1];
}

Status CheckScansAreNotMirrored(const SlamGraph& graph, const std::vector<double>& poses,
                                const std::optional<std::vector<double>>& other_poses) {
  TurnVotes against = VoteOnTurns(graph, poses);
  if (other_poses && !against.SayRight()) {
    const TurnVotes other = VoteOnTurns(graph, *other_poses);
    if (other.AreEnough()) against = other;
  }
  if (!against.SayMirrored()) return Status::Ok();
  return Status::InvalidArgument(
      "the scans look mirrored: around " + std::to_string(against.mirrored) + " of " +
      std::to_string(against.mirrored + against.as_they_are) +
      " turns of the poses they match as mirror images only; are the beams counted from the wrong "
      "side, or does the laser hang upside down (bearing_step_rad)?");
}

}  // namespace plumbline
