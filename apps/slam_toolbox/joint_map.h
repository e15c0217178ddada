#ifndef PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_
#define PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_

#include <plumbline/core/laser_scan.h>
#include <plumbline/core/map_state.h>
#include <plumbline/core/pose2.h>
#include <plumbline/core/slam_graph.h>
#include <plumbline/core/status.h>
#include <plumbline/solvers/solve.h>

#include <Eigen/Core>
#include <algorithm>
#include <map>
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
    const Constraint constraint{source, target, source_from_target, covariance};
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
    return Status::Ok();
  }

  void Clear() {
    nodes_.clear();
    constraints_.clear();
  }

  /// Moves the nodes to the estimate; the one of the lowest id stays. Loops may gape by metres, and
  /// constraints may be false, see Solve. Without any scan it is the optimum of the constraints.
  /// Unavailable if that fails; then all nodes stay.
  Status Estimate() {
    SlamGraph graph;
    PLUMBLINE_RETURN_IF_ERROR(MakeGraph(&graph));
    SolverOptions options = options_;
    if (graph.num_returns() == 0) {
      if (constraints_.empty()) return Status::Ok();
      options.type = SolverType::kPoseGraph;
    }
    MapState state = graph.InitialState();
    const SolverSummary summary = Solve(options, graph, &state);
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
    int pose = 0;                  // within Estimate
  };
  struct Constraint {
    int source = 0, target = 0;
    Pose2 source_from_target;
    Eigen::Matrix3d covariance;
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

  // Numbers the nodes as poses.
  Status MakeGraph(SlamGraph* graph) {
    for (auto& [id, node] : nodes_) {
      int laser = 0;
      PLUMBLINE_RETURN_IF_ERROR(
          graph->AddPose(node.world_from_robot, node.timestamp_s, &node.pose));
      if (node.ranges_m.empty()) continue;
      PLUMBLINE_RETURN_IF_ERROR(graph->AddLaser(node.laser, &laser));
      PLUMBLINE_RETURN_IF_ERROR(graph->AddScan(node.pose, laser, node.ranges_m));
    }
    for (const Constraint& c : constraints_) {
      PLUMBLINE_RETURN_IF_ERROR(
          graph->AddRelativePose({nodes_.at(c.source).pose, nodes_.at(c.target).pose,
                                  c.source_from_target, c.covariance}));
    }
    return Status::Ok();
  }

  SolverOptions options_;
  std::map<int, Node> nodes_;
  std::vector<Constraint> constraints_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_
