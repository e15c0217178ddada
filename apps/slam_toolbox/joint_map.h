#ifndef PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_
#define PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_

#include <plumbline/core/laser_scan.h>
#include <plumbline/core/map_state.h>
#include <plumbline/core/pose2.h>
#include <plumbline/core/slam_graph.h>
#include <plumbline/core/status.h>
#include <plumbline/solvers/incremental_solver.h>
#include <plumbline/solvers/solve.h>

#include <Eigen/Core>
#include <algorithm>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "map_input.h"

namespace plumbline {

/// A map under the ids of a mapper: nodes with scans, and constraints between them. Both come and
/// go. Estimate() fits the nodes that are there to their constraints and to all laser returns. What
/// is refused changes nothing.
///
/// As long as the map only grows, an estimate goes on where the last one ended (IncrementalSolver).
/// Constraints that their scans contradict do not count.
class JointMap {
 public:
  explicit JointMap(SolverOptions options = SolverOptions())
      : options_(std::move(options)), solver_(options_) {}

  /// Adds a node at its initial guess, time in [s]. A known id gives way to the new node, with its
  /// constraints. Fails on a pose or time that SlamGraph::AddPose refuses.
  Status AddNode(int id, const Pose2& world_from_robot, double timestamp_s) {
    PLUMBLINE_RETURN_IF_ERROR(CheckNode(id, world_from_robot, timestamp_s));
    RemoveNode(id);
    nodes_[id] = {world_from_robot, timestamp_s, {}, {}, kNotInGraph};
    return Status::Ok();
  }

  /// The scan of a node: ranges [m], one per beam; those that are no returns count as none. Fails
  /// on an unknown id, and on a laser or ranges that SlamGraph refuses.
  Status SetScan(int id, const LaserModel& laser, std::vector<double> ranges_m) {
    const auto node = nodes_.find(id);
    if (node == nodes_.end()) return NoSuchNode(id);
    PLUMBLINE_RETURN_IF_ERROR(CheckScan(id, laser, ranges_m));
    if (node->second.pose != kNotInGraph) is_outdated_ = true;
    node->second.laser = laser;
    node->second.ranges_m = std::move(ranges_m);
    return Status::Ok();
  }

  /// Removes a node and its constraints, if there is one of this id.
  void RemoveNode(int id) {
    const auto node = nodes_.find(id);
    if (node == nodes_.end()) return;
    if (node->second.pose != kNotInGraph) is_outdated_ = true;
    nodes_.erase(node);
    EraseConstraints([id](const Constraint& c) { return c.source == id || c.target == id; });
  }

  /// The target as seen from the source, with the covariance of x, y [m^2] and yaw [rad^2] in the
  /// axes of the source. Fails on unknown ids, and on what SlamGraph::AddRelativePose refuses.
  Status AddConstraint(int source, int target, const Pose2& source_from_target,
                       const Eigen::Matrix3d& covariance) {
    for (const int id : {source, target}) {
      if (nodes_.count(id) == 0) return NoSuchNode(id);
    }
    PLUMBLINE_RETURN_IF_ERROR(CheckConstraint(source, target, source_from_target, covariance));
    constraints_.push_back({source, target, source_from_target, covariance, false});
    return Status::Ok();
  }

  /// Removes all constraints between two nodes, whichever is the source.
  void RemoveConstraint(int a, int b) {
    EraseConstraints([a, b](const Constraint& c) {
      return (c.source == a && c.target == b) || (c.source == b && c.target == a);
    });
  }

  /// Puts a node where the next estimation starts from. Fails on an unknown id and like AddNode.
  Status MoveNode(int id, const Pose2& world_from_robot) {
    const auto node = nodes_.find(id);
    if (node == nodes_.end()) return NoSuchNode(id);
    PLUMBLINE_RETURN_IF_ERROR(CheckNode(id, world_from_robot, node->second.timestamp_s));
    node->second.world_from_robot = world_from_robot;
    if (node->second.pose == 0) is_outdated_ = true;  // it holds the map in the world
    return Status::Ok();
  }

  void Clear() {
    nodes_.clear();
    constraints_.clear();
    warnings_.clear();
    told_.clear();
    has_alarm_ = false;
    is_outdated_ = true;
  }

  /// Moves the nodes to the estimate; one of them stays and holds the map in the world. Loops may
  /// gape by metres. Without any scan it is the optimum of the constraints. Unavailable if that
  /// fails; then all nodes stay.
  Status Estimate() {
    if (is_outdated_) StartAnew();
    PLUMBLINE_RETURN_IF_ERROR(ExtendGraph());
    std::vector<Pose2> world_from_robot(nodes_.size());
    for (const auto& [id, node] : nodes_) world_from_robot[node.pose] = node.world_from_robot;
    std::vector<double> poses = PoseArray(world_from_robot);
    IncrementalSummary summary;
    PLUMBLINE_RETURN_IF_ERROR(graph_.num_returns() > 0
                                  ? solver_.Update(graph_, UpdateScope::kAll, &poses, &summary)
                                  : OptimizeConstraints(&poses));
    NoteContradictions(summary);
    for (auto& [id, node] : nodes_) node.world_from_robot = Pose2(&poses[3 * node.pose]);
    return Status::Ok();
  }

  /// What estimates have found since the last call, for people: constraints that contradict the
  /// map, and that the map as a whole may be wrong. Each is told once.
  std::vector<std::string> TakeWarnings() { return std::exchange(warnings_, {}); }

  /// Where the nodes are, by id.
  std::map<int, Pose2> Poses() const {
    std::map<int, Pose2> poses;
    for (const auto& [id, node] : nodes_) poses[id] = node.world_from_robot;
    return poses;
  }
  /// Null for an unknown id.
  const Pose2* FindPose(int id) const {
    const auto node = nodes_.find(id);
    return node == nodes_.end() ? nullptr : &node->second.world_from_robot;
  }

 private:
  static constexpr int kNotInGraph = -1;
  struct Node {
    Pose2 world_from_robot;
    double timestamp_s = 0.0;
    LaserModel laser;
    std::vector<double> ranges_m;  // empty: no scan
    int pose = kNotInGraph;
  };
  struct Constraint {
    int source = 0, target = 0;
    Pose2 source_from_target;
    Eigen::Matrix3d covariance;
    bool is_in_graph = false;
  };

  template <typename Condition>
  void EraseConstraints(const Condition& condition) {
    const auto end = std::remove_if(constraints_.begin(), constraints_.end(), condition);
    if (end != constraints_.end()) is_outdated_ = true;
    constraints_.erase(end, constraints_.end());
  }

  // A graph only grows: after something of it has gone, there is a new one.
  void StartAnew() {
    graph_ = SlamGraph();
    solver_ = IncrementalSolver(options_);
    for (auto& [id, node] : nodes_) node.pose = kNotInGraph;
    for (Constraint& constraint : constraints_) constraint.is_in_graph = false;
    is_outdated_ = false;
  }

  // Takes in new nodes and constraints.
  Status ExtendGraph() {
    for (auto& [id, node] : nodes_) {
      if (node.pose != kNotInGraph) continue;
      node.pose = graph_.AddPose(node.world_from_robot, node.timestamp_s);
      if (node.ranges_m.empty()) continue;
      const int laser = graph_.AddLaser(node.laser);
      graph_.AddScan(node.pose, laser, node.ranges_m);
    }
    for (Constraint& constraint : constraints_) {
      if (constraint.is_in_graph) continue;
      graph_.AddRelativePose({nodes_.at(constraint.source).pose, nodes_.at(constraint.target).pose,
                              constraint.source_from_target, constraint.covariance});
      constraint.is_in_graph = true;
    }
    return graph_.status();
  }

  void NoteContradictions(const IncrementalSummary& summary) {
    std::vector<int> id_of_pose(nodes_.size());
    for (const auto& [id, node] : nodes_) id_of_pose[node.pose] = id;
    const auto note = [&](const IgnoredEdge& edge, const char* consequence) {
      const int from = id_of_pose[edge.from], to = id_of_pose[edge.to];
      if (!told_.emplace(from, to).second) return;
      std::ostringstream text;
      text << std::fixed << std::setprecision(2) << "constraint " << from << " -> " << to << " is "
           << edge.off_m << " m and " << edge.off_rad << " rad off the map: " << consequence;
      warnings_.push_back(text.str());
    };
    for (const IgnoredEdge& edge : summary.ignored_edges) {
      note(edge, "its scans contradict it, it is ignored");
    }
    for (const IgnoredEdge& edge : summary.contradicted_closures) {
      note(edge, "it is false, or the map is wrong there");
    }
    if (!summary.alarms.empty() && !std::exchange(has_alarm_, true)) {
      const Alarm& alarm = summary.alarms.front();
      warnings_.push_back("the map may be wrong around " + alarm.place.Text() + ": " +
                          alarm.Text());
    }
    if (summary.alarms.empty()) has_alarm_ = false;
  }

  Status OptimizeConstraints(std::vector<double>* poses) {
    if (constraints_.empty()) return Status::Ok();
    SolverOptions options = options_;
    options.type = SolverType::kPoseGraph;
    const Solution solution = Solve(graph_, options, {*poses, {}});
    if (!solution.status.ok()) return Status::Unavailable(solution.status.message());
    *poses = PoseArray(solution.poses);
    return Status::Ok();
  }

  SolverOptions options_;
  std::map<int, Node> nodes_;
  std::vector<Constraint> constraints_;
  SlamGraph graph_;  // of the nodes and constraints at the last estimate
  IncrementalSolver solver_;
  bool is_outdated_ = false;  // something that graph_ has is no more
  std::vector<std::string> warnings_;
  std::set<std::pair<int, int>> told_;  // constraints in warnings so far, by their nodes
  bool has_alarm_ = false;              // at the last estimate
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SLAM_TOOLBOX_JOINT_MAP_H_
