#include "plumbline/solvers/mirrored_scans.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"

namespace plumbline {
namespace {

constexpr int kMaxPairs = 48;

struct ScanPair {
  int from, to;  // scan ids, of one laser
};

// Pairs of scans with a turn between them that is too large for matching either way, and small
// enough for both to see the same walls; each begins where the last one ended.
std::vector<ScanPair> TurnsOf(const SlamGraph& graph) {
  constexpr double kLeastTurnRad = DegToRad(10.0), kLargestTurnRad = DegToRad(60.0);
  constexpr double kMaxDistanceM = 2.0;
  std::vector<ScanPair> pairs;
  for (int from = 0, to = 1; to < graph.num_scans(); ++to) {
    if (graph.scan(to).laser != graph.scan(from).laser) {
      from = to;
      continue;
    }
    const Pose2 step = Between(graph.WorldFromLaser(from), graph.WorldFromLaser(to));
    const double turn_rad = std::abs(NormalizeAngle(step.yaw));
    const bool near = step.translation().norm() <= kMaxDistanceM;
    if (near && turn_rad < kLeastTurnRad) continue;
    if (near && turn_rad <= kLargestTurnRad) pairs.push_back({from, to});
    from = to;
  }
  return pairs;
}

// Returns of a scan in the frame of its laser, thinned to about `max_points`.
std::vector<Eigen::Vector2d> PointsOf(const SlamGraph& graph, int scan_id, bool mirrored,
                                      std::size_t max_points) {
  const ScanEntry& scan = graph.scan(scan_id);
  const LaserModel& laser = graph.LaserOfScan(scan_id);
  // In reverse order, the last beam has the bearing of the first.
  const double bearing_sum_rad =
      2.0 * laser.first_bearing_rad + (laser.num_beams - 1) * laser.bearing_step_rad;
  const std::size_t stride = std::max<std::size_t>(1, scan.num_returns / max_points);
  std::vector<Eigen::Vector2d> points;
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; r += stride) {
    const double measured_rad = graph.returns().bearing_rad[r];
    const double bearing_rad = mirrored ? bearing_sum_rad - measured_rad : measured_rad;
    points.push_back(graph.returns().range_m[r] *
                     Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad)));
  }
  return points;
}

// Mean distance [m] of the returns of the second scan from the nearest ones of the first, where
// what has no counterpart counts as 0.5 m.
double Mismatch(const SlamGraph& graph, const ScanPair& pair, bool mirrored) {
  constexpr std::size_t kMaxQueries = 90, kMaxTargets = 720;
  constexpr double kNoCounterpartM = 0.5;
  const Pose2 step = Between(graph.WorldFromLaser(pair.from), graph.WorldFromLaser(pair.to));
  const std::vector<Eigen::Vector2d> targets = PointsOf(graph, pair.from, mirrored, kMaxTargets);
  const std::vector<Eigen::Vector2d> queries = PointsOf(graph, pair.to, mirrored, kMaxQueries);
  double sum_m = 0.0;
  for (const Eigen::Vector2d& query : queries) {
    const Eigen::Vector2d point = step * query;
    double nearest_squared = kNoCounterpartM * kNoCounterpartM;
    for (const Eigen::Vector2d& target : targets) {
      nearest_squared = std::min(nearest_squared, (target - point).squaredNorm());
    }
    sum_m += std::sqrt(nearest_squared);
  }
  return queries.empty() ? kNoCounterpartM : sum_m / static_cast<double>(queries.size());
}

}  // namespace

TurnVotes VoteOnTurns(const SlamGraph& graph) {
  constexpr double kFarBetter = 0.6;
  const std::vector<ScanPair> pairs = TurnsOf(graph);
  const std::size_t num_voters = std::min<std::size_t>(pairs.size(), kMaxPairs);
  TurnVotes votes;
  for (std::size_t i = 0; i < num_voters; ++i) {
    const ScanPair& pair = pairs[i * pairs.size() / num_voters];
    const double as_they_are = Mismatch(graph, pair, false);
    const double mirrored = Mismatch(graph, pair, true);
    if (as_they_are < kFarBetter * mirrored) ++votes.as_they_are;
    if (mirrored < kFarBetter * as_they_are) ++votes.mirrored;
  }
  return votes;
}

Status CheckScansAreNotMirrored(const SlamGraph& graph) {
  constexpr int kFewestVotes = 8;
  constexpr double kNextToAll = 0.9;
  const TurnVotes votes = VoteOnTurns(graph);
  const int sum = votes.as_they_are + votes.mirrored;
  if (sum < kFewestVotes || votes.mirrored < kNextToAll * sum) return Status::Ok();
  return Status::InvalidArgument(
      "the scans look mirrored: for " + std::to_string(votes.mirrored) + " of " +
      std::to_string(sum) +
      " turns between poses they match with their beams in reverse order, and not as they are; "
      "are bearings, or yaw, counted clockwise?");
}

}  // namespace plumbline
