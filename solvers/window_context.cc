#include "plumbline/solvers/window_context.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <set>
#include <unordered_set>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/point_index.h"
#include "plumbline/solvers/solver_input.h"

namespace plumbline {
namespace {

// Two returns saw the same place if their cells touch: the map may be off by some decimetres.
constexpr double kPlaceM = 0.5;
// Of all poses in a cell of this size [m] that look the same way to within this [rad], one is
// enough: they saw the same. About the distance and turn from one keyframe of the seeding to the
// next.
constexpr double kSpacingM = 0.25;
constexpr double kTurnRad = 0.35;
// Poses farther than this [m] from every free one do not count: it bounds the search.
constexpr double kMaxDistanceM = 20.0;
// Nor do those with less than this share of their returns near returns of free poses. Not tuned.
constexpr double kMinCommonShare = 0.2;
// Returns of a scan that are looked at, or less than twice as many, all around.
constexpr std::size_t kReturnsPerScan = 64;

// The scans of every pose, in one list.
struct ScansByPose {
  std::vector<int> scans;
  std::vector<std::size_t> first;  // per pose, and the end

  explicit ScansByPose(const SlamGraph& graph)
      : scans(graph.num_scans()), first(graph.num_poses() + 1) {
    for (int s = 0; s < graph.num_scans(); ++s) ++first[graph.scan(s).pose + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::size_t> next = first;
    for (int s = 0; s < graph.num_scans(); ++s) scans[next[graph.scan(s).pose]++] = s;
  }
};

// Where returns of some poses lie. Points out of reach lie nowhere.
class SeenPlaces {
 public:
  void Add(const Eigen::Vector2d& point) {
    if (!IsInReach(point) || !hit_.insert(Cell(point, 0, 0)).second) return;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) near_.insert(Cell(point, dx, dy));
    }
  }
  bool Contains(const Eigen::Vector2d& point) const {
    return IsInReach(point) && near_.count(Cell(point, 0, 0)) > 0;
  }

 private:
  static bool IsInReach(const Eigen::Vector2d& point) {
    return IsWithinReach(point.x()) && IsWithinReach(point.y());
  }
  static std::uint64_t Cell(const Eigen::Vector2d& point, int dx, int dy) {
    const auto x = static_cast<std::int64_t>(std::floor(point.x() / kPlaceM)) + dx;
    const auto y = static_cast<std::int64_t>(std::floor(point.y() / kPlaceM)) + dy;
    return (static_cast<std::uint64_t>(x) << 32) ^ (static_cast<std::uint64_t>(y) & 0xffffffffu);
  }

  std::unordered_set<std::uint64_t> hit_;   // cells with a return
  std::unordered_set<std::uint64_t> near_;  // those and the ones around them
};

class ContextSearch {
 public:
  ContextSearch(const WindowOptions& options, const SlamGraph& graph, const MapState& state,
                const std::vector<int>& free_poses)
      : options_(options),
        graph_(graph),
        state_(state),
        scans_(graph),
        is_free_(graph.num_poses()) {
    for (const int pose : free_poses) {
      is_free_[pose] = true;
      ForEachPoint(pose, [this](const Eigen::Vector2d& point) { seen_.Add(point); });
    }
  }

  std::vector<int> Run(const std::vector<int>& free_poses) {
    std::set<int> chosen = Neighbors();
    int num_left = options_.max_fixed_poses;
    for (const auto& [squared_distance, pose] : NearestFirst(free_poses)) {
      if (num_left == 0) break;
      if (kinds_.count(KindOf(pose)) > 0 || !SawTheSame(pose)) continue;
      kinds_.insert(KindOf(pose));
      if (chosen.insert(pose).second) --num_left;
    }
    return {chosen.begin(), chosen.end()};
  }

 private:
  // Of some returns of each scan.
  template <typename Body>
  void ForEachPoint(int pose, const Body& body) const {
    for (std::size_t i = scans_.first[pose]; i < scans_.first[pose + 1]; ++i) {
      const ScanEntry& scan = graph_.scan(scans_.scans[i]);
      const std::size_t stride = std::max<std::size_t>(1, scan.num_returns / kReturnsPerScan);
      const std::size_t end = scan.first_return + scan.num_returns;
      for (std::size_t r = scan.first_return; r < end; r += stride) {
        body(Eigen::Vector2d(state_.points[2 * r], state_.points[2 * r + 1]));
      }
    }
  }

  // The other ends of constraints on free poses.
  std::set<int> Neighbors() const {
    std::set<int> neighbors;
    const auto add = [&](int from, int to) {
      if (is_free_[from] == is_free_[to]) return;
      neighbors.insert(is_free_[from] ? to : from);
    };
    for (const OdometryConstraint& c : graph_.odometry()) add(c.from, c.to);
    for (const RelativePoseConstraint& c : graph_.relative_poses()) add(c.from, c.to);
    return neighbors;
  }

  // The other poses by their squared distance [m^2] from the nearest free one.
  std::vector<std::pair<double, int>> NearestFirst(const std::vector<int>& free_poses) const {
    std::vector<double> positions;
    Eigen::AlignedBox2d reach;
    for (const int pose : free_poses) {
      const Eigen::Vector2d position = state_.WorldFromRobot(pose).translation();
      positions.insert(positions.end(), {position.x(), position.y()});
      reach.extend(position);
    }
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kMaxDistanceM);
    reach = Eigen::AlignedBox2d(reach.min() - margin, reach.max() + margin);
    const PointIndex index(std::move(positions));
    std::vector<std::pair<double, int>> candidates;
    std::vector<PointIndex::Neighbor> nearest;
    const double limit = kMaxDistanceM * kMaxDistanceM;
    for (int pose = 0; pose < graph_.num_poses(); ++pose) {
      const Pose2 world_from_robot = state_.WorldFromRobot(pose);
      if (is_free_[pose] || !IsFinite(world_from_robot)) continue;
      if (!reach.contains(world_from_robot.translation())) continue;
      index.FindNearest(world_from_robot.translation(), 1, &nearest);
      const double squared_distance = nearest.front().squared_distance;
      if (squared_distance <= limit) candidates.push_back({squared_distance, pose});
    }
    std::sort(candidates.begin(), candidates.end());
    return candidates;
  }

  // Where a pose stands and looks: one of a kind is enough.
  std::array<double, 3> KindOf(int pose) const {
    const Pose2 at = state_.WorldFromRobot(pose);
    return {std::floor(at.x / kSpacingM), std::floor(at.y / kSpacingM),
            std::floor(NormalizeAngle(at.yaw) / kTurnRad)};
  }

  bool SawTheSame(int pose) const {
    std::size_t num_common = 0, num_points = 0;
    ForEachPoint(pose, [&](const Eigen::Vector2d& point) {
      ++num_points;
      if (seen_.Contains(point)) ++num_common;
    });
    return num_common > 0 && num_common >= kMinCommonShare * num_points;
  }

  const WindowOptions& options_;
  const SlamGraph& graph_;
  const MapState& state_;
  const ScansByPose scans_;
  std::vector<char> is_free_;
  SeenPlaces seen_;
  std::set<std::array<double, 3>> kinds_;
};

}  // namespace

std::vector<int> ChooseFixedPoses(const WindowOptions& options, const SlamGraph& graph,
                                  const MapState& state, const std::vector<int>& free_poses) {
  return ContextSearch(options, graph, state, free_poses).Run(free_poses);
}

}  // namespace plumbline
