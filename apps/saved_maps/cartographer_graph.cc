#include "plumbline/apps/saved_maps/cartographer_graph.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"
#include "plumbline/solvers/pose_graph/connected_poses.h"

namespace plumbline {
namespace {

constexpr double kRasterM = 1e-3;       // of the points
constexpr double kDefaultCellM = 0.05;  // of grids, Cartographer's own default
constexpr double kMaxSigmas = 3.0;

double QuantileOr(double otherwise, std::vector<double> values, double share) {
  return values.empty() ? otherwise : Quantile(std::move(values), share);
}

class GraphBuilder {
 public:
  explicit GraphBuilder(const CartographerState& state)
      : state_(state), num_nodes_(static_cast<int>(state.nodes.size())) {
    for (const CartographerConstraint& constraint : state.constraints) {
      if (constraint.is_intra) moving_.insert(state.nodes[constraint.node].id.trajectory);
    }
  }

  Status Build(SlamGraph* graph, CartographerGraphNotes* notes) {
    if (moving_.empty()) {
      return Status::InvalidArgument(
          "there are no constraints within submaps, so that nothing can move; was the state saved "
          "before its first submap was finished, or after it was loaded frozen?");
    }
    MeasureClouds();
    MeasureConstraints();
    AddNodes();
    AddSubmaps();
    AddConstraints();
    TieLooseNodes();
    FixFrozen();
    PLUMBLINE_RETURN_IF_ERROR(graph_.status());
    PLUMBLINE_RETURN_IF_ERROR(CheckConnected());
    *graph = std::move(graph_);
    *notes = std::move(notes_);
    return Status::Ok();
  }

 private:
  bool IsFrozen(const CartographerId& id) const { return moving_.count(id.trajectory) == 0; }

  // What the points say of the laser.
  void MeasureClouds() {
    constexpr int kDefaultBeams = 360, kMinBeams = 4, kMaxBeams = 100000;
    std::vector<double> gaps, ranges, bearings;
    for (const CartographerNode& node : state_.nodes) {
      bearings.clear();
      for (const Eigen::Vector2i& point : node.points_mm) {
        bearings.push_back(std::atan2(point.y(), point.x()));
        ranges.push_back(kRasterM * point.cast<double>().norm());
      }
      std::sort(bearings.begin(), bearings.end());
      for (std::size_t i = 1; i < bearings.size(); ++i) {
        gaps.push_back(bearings[i] - bearings[i - 1]);
      }
    }
    // Filters leave gaps between points that were neighbours.
    const double step_rad = QuantileOr(2.0 * kPi / kDefaultBeams, std::move(gaps), 0.75);
    laser_.num_beams = static_cast<int>(
        std::clamp<double>(std::round(2.0 * kPi / step_rad), kMinBeams, kMaxBeams));
    laser_.bearing_step_rad = 2.0 * kPi / laser_.num_beams;
    laser_.first_bearing_rad = -kPi;
    laser_.min_range_m = 0.5 * kRasterM;
    const double largest = ranges.empty() ? 0.0 : *std::max_element(ranges.begin(), ranges.end());
    laser_.max_range_m = largest + kRasterM;
    median_range_m_ = QuantileOr(1.0, std::move(ranges), 0.5);
  }

  // How far off constraints are at the saved poses.
  void MeasureConstraints() {
    std::vector<double> off_m, off_rad;
    for (const CartographerConstraint& constraint : state_.constraints) {
      const Pose2 saved = Between(state_.submaps[constraint.submap].map_from_submap,
                                  state_.nodes[constraint.node].map_from_tracking);
      const Pose2 off = Between(constraint.submap_from_tracking, saved);
      off_.push_back(off);
      off_m.insert(off_m.end(), {std::abs(off.x), std::abs(off.y)});
      off_rad.push_back(std::abs(off.yaw));
    }
    constexpr double kSigmasPerMedian = 1.4826;  // of a normal distribution
    const double cell_sigma_m = state_.cell_m.value_or(kDefaultCellM) / std::sqrt(12.0);
    const double cell_sigma_rad = cell_sigma_m / std::max(median_range_m_, cell_sigma_m);
    notes_.sigma_m =
        std::max(cell_sigma_m, kSigmasPerMedian * QuantileOr(0.0, std::move(off_m), 0.5));
    notes_.sigma_rad =
        std::max(cell_sigma_rad, kSigmasPerMedian * QuantileOr(0.0, std::move(off_rad), 0.5));
  }

  void AddNodes() {
    const int laser = graph_.AddLaser(laser_);
    std::vector<Eigen::Vector2d> points;
    for (const CartographerNode& node : state_.nodes) {
      const int pose = graph_.AddPose(node.map_from_tracking, node.time_s);
      const Pose2 tracking_from_level(0.0, 0.0, node.tracking_from_level_rad);
      points.clear();
      for (const Eigen::Vector2i& point : node.points_mm) {
        points.push_back(tracking_from_level * Eigen::Vector2d(kRasterM * point.cast<double>()));
      }
      if (!points.empty()) graph_.AddPoints(pose, laser, points);
    }
  }

  // A submap has the time of the first node that is matched with it.
  void AddSubmaps() {
    std::vector<double> times(state_.submaps.size(), 0.0);
    for (auto c = state_.constraints.rbegin(); c != state_.constraints.rend(); ++c) {
      times[c->submap] = state_.nodes[c->node].time_s;
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
      graph_.AddPose(state_.submaps[i].map_from_submap, times[i]);
    }
  }

  void AddConstraints() {
    for (std::size_t i = 0; i < off_.size(); ++i) {
      const CartographerConstraint& constraint = state_.constraints[i];
      RelativePoseConstraint edge = EdgeBetween(num_nodes_ + constraint.submap, constraint.node);
      edge.from_from_to = constraint.submap_from_tracking;
      const double sigmas = std::hypot(off_[i].x / notes_.sigma_m, off_[i].y / notes_.sigma_m,
                                       off_[i].yaw / notes_.sigma_rad);
      if (sigmas > kMaxSigmas) {
        edge.covariance *= sigmas * sigmas / (kMaxSigmas * kMaxSigmas);
        ++notes_.num_contradicted;
      }
      graph_.AddRelativePose(edge);
    }
  }

  RelativePoseConstraint EdgeBetween(int from, int to) const {
    RelativePoseConstraint edge;
    edge.from = from;
    edge.to = to;
    const Eigen::Vector3d sigmas(notes_.sigma_m, notes_.sigma_m, notes_.sigma_rad);
    edge.covariance = sigmas.cwiseAbs2().asDiagonal();
    return edge;
  }

  void TieLooseNodes() {
    std::vector<bool> is_loose(num_nodes_, true);
    for (const CartographerConstraint& constraint : state_.constraints) {
      is_loose[constraint.node] = false;
    }
    for (int node = 1; node < num_nodes_; ++node) {
      const CartographerNode &before = state_.nodes[node - 1], &here = state_.nodes[node];
      const bool is_step = before.id.trajectory == here.id.trajectory && !IsFrozen(here.id);
      if (!is_step || !(is_loose[node - 1] || is_loose[node])) continue;
      RelativePoseConstraint edge = EdgeBetween(node - 1, node);
      edge.from_from_to = Between(before.local_from_tracking, here.local_from_tracking);
      graph_.AddRelativePose(edge);
    }
  }

  // Where nothing is frozen, the first submap holds the map, as in Cartographer.
  void FixFrozen() {
    std::set<int> frozen;
    for (int node = 0; node < num_nodes_; ++node) {
      if (!IsFrozen(state_.nodes[node].id)) continue;
      frozen.insert(state_.nodes[node].id.trajectory);
      graph_.FixPose(node);
    }
    std::vector<bool> is_matched(state_.submaps.size(), false);
    for (const CartographerConstraint& constraint : state_.constraints) {
      is_matched[constraint.submap] = true;
    }
    bool needs_hold = frozen.empty();
    for (std::size_t submap = 0; submap < state_.submaps.size(); ++submap) {
      if (is_matched[submap] && !IsFrozen(state_.submaps[submap].id) && !needs_hold) continue;
      if (is_matched[submap]) needs_hold = false;
      graph_.FixPose(num_nodes_ + static_cast<int>(submap));
    }
    notes_.frozen_trajectories.assign(frozen.begin(), frozen.end());
  }

  Status CheckConnected() const {
    std::vector<int> held;
    for (const FixedPose& fixed : graph_.fixed_poses()) held.push_back(fixed.pose);
    const int node = FindUnconnectedPose(graph_, held);
    if (node < 0) return Status::Ok();
    // No submap: each is matched with a node, which comes before it, or fixed.
    const CartographerId& id = state_.nodes[node].id;
    return Status::InvalidArgument("no constraints connect node " + std::to_string(id.index) +
                                   " of trajectory " + std::to_string(id.trajectory) + " with " +
                                   (notes_.frozen_trajectories.empty()
                                        ? "the first submap"
                                        : "the trajectories that were loaded frozen"));
  }

  const CartographerState& state_;
  const int num_nodes_;
  std::set<int> moving_;  // trajectories
  LaserModel laser_;
  double median_range_m_ = 0.0;
  std::vector<Pose2> off_;  // per constraint: where the node is, seen from where it should be
  SlamGraph graph_;
  CartographerGraphNotes notes_;
};

}  // namespace

Status BuildGraph(const CartographerState& state, const std::string& path, SlamGraph* graph,
                  CartographerGraphNotes* notes) {
  const Status status = GraphBuilder(state).Build(graph, notes);
  return status.ok() ? status : Status::InvalidArgument(path + ": " + status.message());
}

}  // namespace plumbline
