#include "plumbline/solvers/seeding/loop_candidates.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

// One radian of difference in heading costs as much common view as this distance [m].
constexpr double kHeadingCostM = 1.0;

struct Link {
  int to = 0;
  double length_m = 0.0;
};

// Key scans joined by the path driven and by closures, which are as short as what they measured.
std::vector<std::vector<Link>> MakeLinks(const std::vector<KeyScan>& key_scans,
                                         const std::vector<RelativePoseConstraint>& closures) {
  std::vector<std::vector<Link>> links(key_scans.size());
  const auto join = [&](int a, int b, double length_m) {
    links[a].push_back({b, length_m});
    links[b].push_back({a, length_m});
  };
  for (std::size_t k = 1; k < key_scans.size(); ++k) {
    join(static_cast<int>(k) - 1, static_cast<int>(k),
         key_scans[k].path_m - key_scans[k - 1].path_m);
  }
  for (const RelativePoseConstraint& closure : closures) {
    join(closure.from, closure.to, std::hypot(closure.from_from_to.x, closure.from_from_to.y));
  }
  return links;
}

// Dijkstra (1959).
std::vector<double> ShortestPaths(const std::vector<std::vector<Link>>& links, int source) {
  std::vector<double> length(links.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> open;
  length[source] = 0.0;
  open.push({0.0, source});
  while (!open.empty()) {
    const auto [reached, key] = open.top();
    open.pop();
    if (reached > length[key]) continue;
    for (const Link& link : links[key]) {
      const double through = reached + link.length_m;
      if (through >= length[link.to]) continue;
      length[link.to] = through;
      open.push({through, link.to});
    }
  }
  return length;
}

std::vector<int> SpacedKeyScans(const std::vector<KeyScan>& key_scans, double spacing_m) {
  std::vector<int> spaced;
  for (std::size_t k = 0; k < key_scans.size(); ++k) {
    if (!spaced.empty() && key_scans[k].path_m - key_scans[spaced.back()].path_m < spacing_m) {
      continue;
    }
    spaced.push_back(static_cast<int>(k));
  }
  return spaced;
}

}  // namespace

bool LoopCandidateOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(drift_floor_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(drift_per_path, >=, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(drift_floor_rad, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(drift_rad_per_m, >=, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(reach_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(min_path_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(spacing_m, >, 0.0);
  return true;
}

std::vector<LoopCandidate> FindLoopCandidates(const LoopCandidateOptions& options,
                                              const std::vector<KeyScan>& key_scans,
                                              const std::vector<Pose2>& world_from_key,
                                              const std::vector<RelativePoseConstraint>& closures) {
  const std::vector<std::vector<Link>> links = MakeLinks(key_scans, closures);
  const auto is_closed = [&](int first, int second) {
    return std::any_of(closures.begin(), closures.end(), [&](const RelativePoseConstraint& c) {
      return std::abs(key_scans[c.from].path_m - key_scans[first].path_m) < options.spacing_m &&
             std::abs(key_scans[c.to].path_m - key_scans[second].path_m) < options.spacing_m;
    });
  };
  std::vector<LoopCandidate> candidates;
  for (const int second : SpacedKeyScans(key_scans, options.spacing_m)) {
    const std::vector<double> way_m = ShortestPaths(links, second);
    LoopCandidate best;
    double best_cost = std::numeric_limits<double>::infinity();
    const auto finish_visit = [&] {
      if (std::isfinite(best_cost) && !is_closed(best.first, second)) candidates.push_back(best);
      best_cost = std::numeric_limits<double>::infinity();
    };
    for (int first = 0; first < second; ++first) {
      if (key_scans[second].path_m - key_scans[first].path_m < options.min_path_m) break;
      const double distance_m =
          (world_from_key[first].translation() - world_from_key[second].translation()).norm();
      const double drift_m = options.drift_floor_m + options.drift_per_path * way_m[first];
      if (distance_m > options.reach_m + drift_m) {
        finish_visit();
        continue;
      }
      const double turn_rad =
          NormalizeAngle(world_from_key[second].yaw - world_from_key[first].yaw);
      const double cost = distance_m + kHeadingCostM * std::abs(turn_rad);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = {first, second, drift_m,
              options.drift_floor_rad + options.drift_rad_per_m * way_m[first]};
    }
    finish_visit();
  }
  return candidates;
}

}  // namespace plumbline
