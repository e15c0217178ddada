#ifndef PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_
#define PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_

#include <plumbline/core/laser_scan.h>
#include <plumbline/core/map_state.h>
#include <plumbline/core/pose2.h>
#include <plumbline/core/slam_graph.h>
#include <plumbline/core/status.h>
#include <plumbline/solvers/pose_graph/pose_graph.h>
#include <plumbline/solvers/solve.h>

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace plumbline {

/// A map under the ids of a mapper: nodes with scans, and constraints between them. Both come and
/// go. Estimate() fits the nodes that are there to their constraints and to all laser returns. What
/// is refused changes nothing.
class JointMap {
 public:
  explicit JointMap(SolverOptions options = SolverOptions()) : options_(std::move(options)) {}

  /// Adds a node at its initial guess, time in [s]. A known id gives way to the new node, with its
  /// constraints. Fails on a pose or time that SlamGraph::AddPose refuses.
  Status AddNode(int id, const Pose2& world_from_robot, double timestamp_s) {
    int pose = 0;
    SlamGraph trial;
    PLUMBLINE_RETURN_IF_ERROR(Named(id, trial.AddPose(world_from_robot, timestamp_s, &pose)));
    RemoveNode(id);
    nodes_[id] = {world_from_robot, timestamp_s, {}, {}, 0};
    return Status::Ok();
  }

  /// The scan of a node: ranges [m], one per beam; those that are no returns count as none. Fails
  /// on an unknown id, and on a laser or ranges that SlamGraph refuses.
  Status SetScan(int id, const LaserModel& laser, std::vector<double> ranges_m) {
    const auto node = nodes_.find(id);
    if (node == nodes_.end()) return Named(id, Status::NotFound("is not in the map"));
    int ignored = 0;
    SlamGraph trial;
    PLUMBLINE_RETURN_IF_ERROR(trial.AddPose(Pose2(), 0.0, &ignored));
    PLUMBLINE_RETURN_IF_ERROR(Named(id, trial.AddLaser(laser, &ignored)));
    PLUMBLINE_RETURN_IF_ERROR(Named(id, trial.AddScan(0, 0, ranges_m)));
    node->second.laser = laser;
    node->second.ranges_m = std::move(ranges_m);
    return Status::Ok();
  }

  /// Removes a node and its constraints, if there is one of this id.
  void RemoveNode(int id) {
    if (nodes_.erase(id) == 0) return;
    EraseConstraints([id](const Constraint& c) { return c.source == id || c.target == id; });
  }

  /// The target as seen from the source, with the covariance of x, y [m^2] and yaw [rad^2] in the
  /// axes of the source. Fails on unknown ids, and on what SlamGraph::AddRelativePose refuses.
  Status AddConstraint(int source, int target, const Pose2& source_from_target,
                       const Eigen::Matrix3d& covariance) {
    const Constraint constraint{source, target, source_from_target, covariance, true};
    const std::string name =
        "constraint " + std::to_string(source) + " -> " + std::to_string(target);
    if (nodes_.count(source) == 0 || nodes_.count(target) == 0) {
      return Status::NotFound(name + ": no such nodes");
    }
    int ignored = 0;
    SlamGraph trial;
    PLUMBLINE_RETURN_IF_ERROR(trial.AddPose(Pose2(), 0.0, &ignored));
    PLUMBLINE_RETURN_IF_ERROR(trial.AddPose(Pose2(), 0.0, &ignored));
    const Status status =
        trial.AddRelativePose({0, source == target ? 0 : 1, source_from_target, covariance});
    if (!status.ok()) return Status::InvalidArgument(name + ": " + status.message());
    constraints_.push_back(constraint);
    return Status::Ok();
  }

  /// Removes all constraints between two nodes, whichever is the source.
  void RemoveConstraint(int a, int b) {
    EraseConstraints([a, b](const Constraint& c) {
      return (c.source == a && c.target == b) || (c.source == b && c.target == a);
    });
  }

  /// Puts a node where the next estimation starts from. Fails on an unknown id and on a pose that
  /// is not finite.
  Status MoveNode(int id, const Pose2& world_from_robot) {
    const auto node = nodes_.find(id);
    if (node == nodes_.end()) return Named(id, Status::NotFound("is not in the map"));
    if (!IsFinite(world_from_robot)) {
      return Named(id, Status::InvalidArgument("is moved to a pose that is not finite"));
    }
    node->second.world_from_robot = world_from_robot;
    for (Constraint& constraint : constraints_) {
      if (constraint.source == id || constraint.target == id) constraint.is_new = true;
    }
    return Status::Ok();
  }

  void Clear() {
    nodes_.clear();
    constraints_.clear();
  }

  /// Moves the nodes to the estimate; the one of the lowest id stays. Where the joint estimation
  /// fails the nodes are at the optimum of a pose graph, and the status says why.
  Status Estimate() {
    if (nodes_.empty()) return Status::Ok();
    SpreadConstraints();
    for (Constraint& constraint : constraints_) constraint.is_new = false;
    SlamGraph graph;
    PLUMBLINE_RETURN_IF_ERROR(MakeGraph(&graph));
    if (graph.num_returns() == 0) return Status::Ok();
    MapState state = graph.InitialState();
    const SolverSummary summary = Solve(options_, graph, &state);
    if (!summary.IsSolutionUsable()) return Status::Unavailable(summary.message);
    for (auto& [id, node] : nodes_) node.world_from_robot = state.WorldFromRobot(node.pose);
    return Status::Ok();
  }

  /// Where the nodes are, by id.
  std::map<int, Pose2> Poses() const {
    std::map<int, Pose2> poses;
    for (const auto& [id, node] : nodes_)
      poses.emplace_hint(poses.end(), id, node.world_from_robot);
    return poses;
  }
  /// Null for an unknown id.
  const Pose2* FindPose(int id) const {
    const auto node = nodes_.find(id);
    return node == nodes_.end() ? nullptr : &node->second.world_from_robot;
  }

 private:
  struct Node {
    Pose2 world_from_robot;
    double timestamp_s = 0.0;
    LaserModel laser;
    std::vector<double> ranges_m;  // empty: no scan
    int pose = 0;                  // its number, within Estimate
  };
  struct Constraint {
    int source = 0, target = 0;
    Pose2 source_from_target;
    Eigen::Matrix3d covariance;
    bool is_new = true;  // no estimate has taken it in
  };

  static Status Named(int id, const Status& status) {
    if (status.ok()) return status;
    return Status::InvalidArgument("node " + std::to_string(id) + ": " + status.message());
  }

  template <typename Condition>
  void EraseConstraints(const Condition& condition) {
    constraints_.erase(std::remove_if(constraints_.begin(), constraints_.end(), condition),
                       constraints_.end());
  }

  RelativePoseConstraint EdgeOf(const Constraint& constraint) const {
    return {nodes_.at(constraint.source).pose, nodes_.at(constraint.target).pose,
            constraint.source_from_target, constraint.covariance};
  }

  // The first pose of each group of nodes that constraints join: what a pose graph has to hold.
  static std::vector<int> FirstOfGroups(int num_poses,
                                        const std::vector<RelativePoseConstraint>& edges) {
    std::vector<int> first(num_poses);
    std::iota(first.begin(), first.end(), 0);
    const auto find = [&first](int pose) {
      while (first[pose] != pose) pose = first[pose] = first[first[pose]];
      return pose;
    };
    for (const RelativePoseConstraint& edge : edges) {
      const int from = find(edge.from), to = find(edge.to);
      first[std::max(from, to)] = std::min(from, to);
    }
    std::vector<int> result;
    for (int pose = 0; pose < num_poses; ++pose) {
      if (first[pose] == pose) result.push_back(pose);
    }
    return result;
  }

  // The joint estimation wants poses that are right to a few decimetres, and a new constraint may
  // close a loop that gapes wider: a pose graph brings them there. In it, constraints that an
  // earlier estimate has taken in keep what it made of them, which is better than what they say.
  void SpreadConstraints() {
    std::vector<Pose2> poses;
    for (auto& [id, node] : nodes_) {
      node.pose = static_cast<int>(poses.size());
      poses.push_back(node.world_from_robot);
    }
    std::vector<RelativePoseConstraint> edges;
    for (const Constraint& constraint : constraints_) {
      RelativePoseConstraint edge = EdgeOf(constraint);
      if (!constraint.is_new) edge.from_from_to = Between(poses[edge.from], poses[edge.to]);
      edges.push_back(edge);
    }
    OptimizePoseGraph(edges, {}, &poses, FirstOfGroups(static_cast<int>(poses.size()), edges));
    for (auto& [id, node] : nodes_) node.world_from_robot = poses[node.pose];
  }

  Status MakeGraph(SlamGraph* graph) const {
    for (const auto& [id, node] : nodes_) {
      int pose = 0, laser = 0;
      PLUMBLINE_RETURN_IF_ERROR(graph->AddPose(node.world_from_robot, node.timestamp_s, &pose));
      if (node.ranges_m.empty()) continue;
      PLUMBLINE_RETURN_IF_ERROR(graph->AddLaser(node.laser, &laser));
      PLUMBLINE_RETURN_IF_ERROR(graph->AddScan(pose, laser, node.ranges_m));
    }
    for (const Constraint& constraint : constraints_) {
      PLUMBLINE_RETURN_IF_ERROR(graph->AddRelativePose(EdgeOf(constraint)));
    }
    return Status::Ok();
  }

  SolverOptions options_;
  std::map<int, Node> nodes_;
  std::vector<Constraint> constraints_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_
