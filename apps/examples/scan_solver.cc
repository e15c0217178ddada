// A scan solver for karto mappers (open_karto, slam_toolbox) that holds the scans, too: karto's
// constraints and all laser returns are estimated together, where other scan solvers adjust the
// poses by the constraints alone.
//
// In a karto mapper replace the namespace `karto` below by #include <karto_sdk/Mapper.h> and give
// the class to Mapper::SetScanSolver, or export it as a plugin. What it uses of karto: the virtual
// functions of ScanSolver; Vertex::GetObject; Edge::GetSource, GetTarget and GetLabel;
// LinkInfo::GetPoseDifference and GetCovariance; of LocalizedRangeScan GetUniqueId, GetTime,
// GetCorrectedPose, GetRangeReadings, GetNumberOfRangeReadings and GetLaserRangeFinder; of
// LaserRangeFinder GetMinimumAngle, GetAngularResolution, GetMinimumRange, GetRangeThreshold and
// GetOffsetPose; Pose2 and Matrix3. slam_toolbox under ROS 2 also wants `void
// Configure(rclcpp::Node::SharedPtr)`. open_karto has fewer virtual functions (drop `override` at
// the others), and there all poses are those of the sensor: take GetSensorPose instead of
// GetCorrectedPose, and no GetOffsetPose.
//
// main() drives the solver through a simulated loop, as karto would.
#include <plumbline/core/slam_graph.h>
#include <plumbline/solvers/pose_graph/pose_graph.h>
#include <plumbline/solvers/solve.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <random>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

// ---- A mirror of what the solver uses of karto, and no more. ----

namespace karto {

class Pose2 {
 public:
  Pose2() = default;
  Pose2(double x, double y, double heading) : x_(x), y_(y), heading_(heading) {}
  double GetX() const { return x_; }
  double GetY() const { return y_; }
  double GetHeading() const { return heading_; }

 private:
  double x_ = 0.0, y_ = 0.0, heading_ = 0.0;
};

class Matrix3 {
 public:
  double& operator()(int row, int column) { return values_[3 * row + column]; }
  const double& operator()(int row, int column) const { return values_[3 * row + column]; }

 private:
  double values_[9] = {};
};

struct LaserRangeFinder {
  double GetMinimumAngle() const { return -plumbline::kPi; }
  double GetAngularResolution() const { return plumbline::DegToRad(2.0); }
  double GetMinimumRange() const { return 0.1; }
  double GetRangeThreshold() const { return 9.0; }
  Pose2 GetOffsetPose() const { return {0.15, 0.0, 0.1}; }
};

struct LocalizedRangeScan {
  std::int32_t GetUniqueId() const { return id; }
  double GetTime() const { return 0.1 * id; }
  const Pose2& GetCorrectedPose() const { return corrected_pose; }
  double* GetRangeReadings() const { return const_cast<double*>(ranges_m.data()); }
  std::uint32_t GetNumberOfRangeReadings() const { return ranges_m.size(); }
  LaserRangeFinder* GetLaserRangeFinder() const { return laser; }

  std::int32_t id = 0;
  Pose2 corrected_pose;
  std::vector<double> ranges_m;
  LaserRangeFinder* laser = nullptr;
};

template <typename T>
struct Vertex {
  T* GetObject() const { return object; }
  T* object = nullptr;
};

struct EdgeLabel {
  virtual ~EdgeLabel() = default;
};

struct LinkInfo : EdgeLabel {
  const Pose2& GetPoseDifference() { return pose_difference; }
  const Matrix3& GetCovariance() { return covariance; }
  Pose2 pose_difference;
  Matrix3 covariance;
};

template <typename T>
struct Edge {
  Vertex<T>* GetSource() const { return source; }
  Vertex<T>* GetTarget() const { return target; }
  EdgeLabel* GetLabel() { return label; }
  Vertex<T>*source = nullptr, *target = nullptr;
  EdgeLabel* label = nullptr;
};

class ScanSolver {
 public:
  using IdPoseVector = std::vector<std::pair<std::int32_t, Pose2>>;
  virtual ~ScanSolver() = default;
  virtual void Compute() = 0;
  virtual const IdPoseVector& GetCorrections() const = 0;
  virtual void AddNode(Vertex<LocalizedRangeScan>*) {}
  virtual void RemoveNode(std::int32_t) {}
  virtual void AddConstraint(Edge<LocalizedRangeScan>*) {}
  virtual void RemoveConstraint(std::int32_t, std::int32_t) {}
  virtual void Clear() {}
  virtual void Reset() {}
  virtual std::unordered_map<int, Eigen::Vector3d>* getGraph() { return nullptr; }
  // By value, as karto has it.
  // NOLINTNEXTLINE(performance-unnecessary-value-param)
  virtual void ModifyNode(const int&, Eigen::Vector3d) {}
  virtual void GetNodeOrientation(const int&, double&) {}
};

}  // namespace karto

namespace {

using plumbline::Pose2;
using plumbline::RelativePoseConstraint;
using plumbline::Status;

// ---- The solver. ----

Pose2 FromKarto(const karto::Pose2& pose) { return {pose.GetX(), pose.GetY(), pose.GetHeading()}; }
karto::Pose2 ToKarto(const Pose2& pose) {
  return {pose.x, pose.y, plumbline::NormalizeAngle(pose.yaw)};
}

// Keeps nodes and constraints, and makes a SlamGraph of them for each Compute: nodes come and go,
// poses of a SlamGraph stay.
class JointScanSolver : public karto::ScanSolver {
 public:
  // Takes a copy of the scan. A known id gives way to the new node.
  void AddNode(karto::Vertex<karto::LocalizedRangeScan>* vertex) override {
    if (vertex == nullptr || vertex->GetObject() == nullptr) return;
    const karto::LocalizedRangeScan& scan = *vertex->GetObject();
    const std::lock_guard<std::mutex> lock(mutex_);
    Erase(scan.GetUniqueId());
    Node node;
    node.world_from_robot = FromKarto(scan.GetCorrectedPose());
    node.timestamp_s = scan.GetTime();
    const double* ranges_m = scan.GetRangeReadings();
    node.ranges_m.assign(ranges_m, ranges_m + scan.GetNumberOfRangeReadings());
    node.laser = ModelOf(*scan.GetLaserRangeFinder(), static_cast<int>(node.ranges_m.size()));
    if (!plumbline::IsFinite(node.world_from_robot) || !std::isfinite(node.timestamp_s)) {
      status_ = Status::InvalidArgument("node " + std::to_string(scan.GetUniqueId()) +
                                        " has a pose or time that is not finite");
      return;
    }
    nodes_[scan.GetUniqueId()] = std::move(node);
  }

  // The node's constraints go with it.
  void RemoveNode(std::int32_t id) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    Erase(id);
  }

  // Constraints between unknown nodes, or without a sound covariance, are left out; see status().
  void AddConstraint(karto::Edge<karto::LocalizedRangeScan>* edge) override {
    if (edge == nullptr || edge->GetLabel() == nullptr) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    auto* link = static_cast<karto::LinkInfo*>(edge->GetLabel());
    Constraint constraint;
    constraint.source = edge->GetSource()->GetObject()->GetUniqueId();
    constraint.target = edge->GetTarget()->GetObject()->GetUniqueId();
    constraint.source_from_target = FromKarto(link->GetPoseDifference());
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        constraint.covariance(row, column) =
            0.5 * (link->GetCovariance()(row, column) + link->GetCovariance()(column, row));
      }
    }
    const bool known = nodes_.count(constraint.source) > 0 && nodes_.count(constraint.target) > 0;
    const bool sound = plumbline::IsFinite(constraint.source_from_target) &&
                       constraint.covariance.allFinite() &&
                       constraint.covariance.llt().info() == Eigen::Success;
    if (known && sound && constraint.source != constraint.target) {
      constraints_.push_back(constraint);
    } else {
      status_ =
          Status::InvalidArgument("constraint " + std::to_string(constraint.source) + " -> " +
                                  std::to_string(constraint.target) +
                                  (known ? ": no sound motion and covariance" : ": no such nodes"));
    }
  }

  void RemoveConstraint(std::int32_t source, std::int32_t target) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    EraseConstraints([&](const Constraint& c) {
      return (c.source == source && c.target == target) ||
             (c.source == target && c.target == source);
    });
  }

  void Compute() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    corrections_.clear();
    if (nodes_.empty()) return;
    SpreadConstraints();
    plumbline::SlamGraph graph;
    status_ = MakeGraph(&graph);
    plumbline::MapState state = graph.InitialState();
    if (status_.ok() && graph.num_returns() > 0) {
      const plumbline::SolverSummary summary = plumbline::Solve(options_, graph, &state);
      if (!summary.IsSolutionUsable()) status_ = Status::Unavailable(summary.message);
    }
    for (auto& [id, node] : nodes_) {
      if (status_.ok()) node.world_from_robot = state.WorldFromRobot(node.index);
      corrections_.emplace_back(id, ToKarto(node.world_from_robot));
    }
    for (Constraint& constraint : constraints_) constraint.is_new = false;
  }

  const IdPoseVector& GetCorrections() const override { return corrections_; }
  void Clear() override { corrections_.clear(); }
  void Reset() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    nodes_.clear();
    constraints_.clear();
    corrections_.clear();
    poses_.clear();
    status_ = Status::Ok();
  }

  // x, y [m], yaw [rad] of each node, as of this call.
  std::unordered_map<int, Eigen::Vector3d>* getGraph() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    poses_.clear();
    for (const auto& [id, node] : nodes_) {
      const Pose2& pose = node.world_from_robot;
      poses_[id] = {pose.x, pose.y, pose.yaw};
    }
    return &poses_;
  }

  // Puts a node at x, y and turns it by z, as slam_toolbox calls it when a user moves nodes.
  void ModifyNode(const int& id, Eigen::Vector3d pose) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto node = nodes_.find(id);
    if (node == nodes_.end() || !pose.allFinite()) return;
    node->second.world_from_robot = {pose.x(), pose.y(),
                                     node->second.world_from_robot.yaw + pose.z()};
    for (Constraint& constraint : constraints_) {
      if (constraint.source == id || constraint.target == id) constraint.is_new = true;
    }
  }

  void GetNodeOrientation(const int& id, double& yaw) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto node = nodes_.find(id);
    if (node != nodes_.end()) yaw = node->second.world_from_robot.yaw;
  }

  // What was wrong last: for the log of the host.
  const Status& status() const { return status_; }

 private:
  struct Node {
    Pose2 world_from_robot;
    double timestamp_s = 0.0;
    plumbline::LaserModel laser;
    std::vector<double> ranges_m;
    int index = 0;  // of its pose, within Compute
  };
  struct Constraint {
    std::int32_t source = 0, target = 0;
    Pose2 source_from_target;
    Eigen::Matrix3d covariance;
    bool is_new = true;  // no Compute has seen it
  };

  static plumbline::LaserModel ModelOf(const karto::LaserRangeFinder& finder, int num_beams) {
    plumbline::LaserModel laser;
    laser.num_beams = num_beams;
    laser.first_bearing_rad = finder.GetMinimumAngle();
    laser.bearing_step_rad = finder.GetAngularResolution();
    laser.min_range_m = std::max(laser.min_range_m, finder.GetMinimumRange());
    laser.max_range_m = finder.GetRangeThreshold();
    laser.robot_from_laser = FromKarto(finder.GetOffsetPose());
    return laser;
  }

  template <typename Condition>
  void EraseConstraints(const Condition& condition) {
    constraints_.erase(std::remove_if(constraints_.begin(), constraints_.end(), condition),
                       constraints_.end());
  }

  void Erase(std::int32_t id) {
    if (nodes_.erase(id) == 0) return;
    EraseConstraints([id](const Constraint& c) { return c.source == id || c.target == id; });
  }

  // The first pose of each group of nodes that constraints join: what a pose graph has to hold.
  std::vector<int> FirstOfGroups(const std::vector<RelativePoseConstraint>& edges) const {
    std::vector<int> first(nodes_.size());
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
    for (int pose = 0; pose < static_cast<int>(first.size()); ++pose) {
      if (first[pose] == pose) result.push_back(pose);
    }
    return result;
  }

  // The joint estimation wants poses that are right to a few decimetres, and a new constraint may
  // close a loop that gapes wider: a pose graph brings them there. In it, constraints that an
  // earlier Compute has seen keep what it made of them, which is better than what they say.
  void SpreadConstraints() {
    std::vector<Pose2> poses;
    for (auto& [id, node] : nodes_) {
      node.index = static_cast<int>(poses.size());
      poses.push_back(node.world_from_robot);
    }
    std::vector<RelativePoseConstraint> edges;
    for (const Constraint& constraint : constraints_) {
      RelativePoseConstraint edge = EdgeOf(constraint);
      if (!constraint.is_new) edge.from_from_to = Between(poses[edge.from], poses[edge.to]);
      edges.push_back(edge);
    }
    plumbline::OptimizePoseGraph(edges, {}, &poses, FirstOfGroups(edges));
    for (auto& [id, node] : nodes_) node.world_from_robot = poses[node.index];
  }

  RelativePoseConstraint EdgeOf(const Constraint& constraint) const {
    return {nodes_.at(constraint.source).index, nodes_.at(constraint.target).index,
            constraint.source_from_target, constraint.covariance};
  }

  Status MakeGraph(plumbline::SlamGraph* graph) const {
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

  std::mutex mutex_;
  plumbline::SolverOptions options_;
  std::map<std::int32_t, Node> nodes_;
  std::vector<Constraint> constraints_;
  IdPoseVector corrections_;
  std::unordered_map<int, Eigen::Vector3d> poses_;
  Status status_;
};

// ---- The mapper and the world that stand in for karto and a robot. ----

// Where a beam meets the outer walls of a hall or the block in its middle [m].
double RangeInHall(const Pose2& laser, double bearing_rad) {
  const Eigen::Vector2d direction(std::cos(laser.yaw + bearing_rad),
                                  std::sin(laser.yaw + bearing_rad));
  double range_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& half : {Eigen::Vector2d(7.0, 5.0), Eigen::Vector2d(4.0, 2.0)}) {
    for (int axis = 0; axis < 2; ++axis) {
      for (const double wall : {-half[axis], half[axis]}) {
        const double at_m = (wall - laser.translation()[axis]) / direction[axis];
        const double along_m = laser.translation()[1 - axis] + at_m * direction[1 - axis];
        if (at_m > 0.0 && std::abs(along_m) <= half[1 - axis]) range_m = std::min(range_m, at_m);
      }
    }
  }
  return range_m;
}

// Around the block and a little further.
Pose2 TruePose(int id) {
  const double turn = plumbline::DegToRad(3.0 * id);
  return {5.5 * std::cos(turn), 3.5 * std::sin(turn),
          std::atan2(3.5 * std::cos(turn), -5.5 * std::sin(turn))};
}

// Matches scans as karto would, with some error, and keeps what the solver gets.
class SimulatedMapper {
 public:
  explicit SimulatedMapper(JointScanSolver* solver) : solver_(solver) {}

  void Process(int num_scans) {
    for (int i = 0; i < num_scans; ++i) {
      const int id = num_nodes();
      scans_.push_back(std::make_unique<Scan>(MakeScan(id)));
      by_constraints_.emplace_back();
      if (id == 0) {
        AddNode(0);
        continue;
      }
      const Pose2 matched = Match(id - 1, id);
      by_constraints_[id] = by_constraints_[id - 1] * matched;
      scans_[id]->corrected_pose = ToKarto(FromKarto(scans_[id - 1]->corrected_pose) * matched);
      AddNode(id);
      Link(id - 1, id, matched);
    }
  }
  void CloseLoop(int from, int to) { Link(from, to, Match(from, to)); }
  void AddNode(int id) {
    karto::Vertex<Scan> vertex{scans_[id].get()};
    solver_->AddNode(&vertex);
  }
  void Link(int from, int to, const Pose2& motion) {
    karto::LinkInfo link;
    link.pose_difference = ToKarto(motion);
    link.covariance(0, 0) = link.covariance(1, 1) = kMatchM * kMatchM;
    link.covariance(2, 2) = kMatchRad * kMatchRad;
    karto::Vertex<Scan> source{scans_[from].get()}, target{scans_[to].get()};
    karto::Edge<Scan> edge;
    edge.source = &source;
    edge.target = &target;
    edge.label = &link;
    solver_->AddConstraint(&edge);
    RelativePoseConstraint constraint{from, to, motion};
    constraint.covariance =
        Eigen::Vector3d(kMatchM * kMatchM, kMatchM * kMatchM, kMatchRad * kMatchRad).asDiagonal();
    constraints_.push_back(constraint);
  }
  // As MapperGraph::CorrectPoses. Returns the number of corrections.
  int CorrectPoses() {
    solver_->Compute();
    const auto corrections = solver_->GetCorrections();
    for (const auto& [id, pose] : corrections) scans_[id]->corrected_pose = pose;
    solver_->Clear();
    return static_cast<int>(corrections.size());
  }

  int num_nodes() const { return static_cast<int>(scans_.size()); }
  const karto::Pose2& CorrectedPose(int id) const { return scans_[id]->corrected_pose; }
  double Error() const {
    std::vector<Pose2> poses;
    for (const auto& scan : scans_) poses.push_back(FromKarto(scan->corrected_pose));
    return MeanError(poses);
  }
  double ErrorOfConstraints() const { return MeanError(by_constraints_); }
  double ErrorOfPoseGraph() const {
    std::vector<Pose2> poses = by_constraints_;
    plumbline::OptimizePoseGraph(constraints_, {}, &poses);
    return MeanError(poses);
  }

 private:
  using Scan = karto::LocalizedRangeScan;
  static constexpr double kMatchM = 0.02, kMatchRad = 0.008;  // standard deviations of a match

  Scan MakeScan(int id) {
    Scan scan;
    scan.id = id;
    scan.laser = &laser_;
    const Pose2 world_from_laser = TruePose(id) * FromKarto(laser_.GetOffsetPose());
    for (int beam = 0; beam < 180; ++beam) {
      const double bearing = laser_.GetMinimumAngle() + beam * laser_.GetAngularResolution();
      scan.ranges_m.push_back(RangeInHall(world_from_laser, bearing) + 0.01 * noise_(engine_));
    }
    // As drivers report what they did not see.
    scan.ranges_m[id % 180] = std::numeric_limits<double>::quiet_NaN();
    scan.ranges_m[(id + 60) % 180] = std::numeric_limits<double>::infinity();
    scan.ranges_m[(id + 120) % 180] = 0.0;
    return scan;
  }
  Pose2 Match(int from, int to) {
    return Between(TruePose(from), TruePose(to)) *
           Pose2(kMatchM * noise_(engine_), kMatchM * noise_(engine_), kMatchRad * noise_(engine_));
  }
  static double MeanError(const std::vector<Pose2>& poses) {
    double sum_m = 0.0;
    for (std::size_t id = 0; id < poses.size(); ++id) {
      const Pose2 expected = Between(TruePose(0), TruePose(static_cast<int>(id)));
      sum_m += (poses[id].translation() - expected.translation()).norm();
    }
    return sum_m / poses.size();
  }

  JointScanSolver* const solver_;
  karto::LaserRangeFinder laser_;
  std::vector<std::unique_ptr<Scan>> scans_;
  std::vector<RelativePoseConstraint> constraints_;
  std::vector<Pose2> by_constraints_;
  std::mt19937 engine_{3};
  std::normal_distribution<double> noise_;
};

bool Expect(bool condition, const char* what) {
  if (!condition) std::fprintf(stderr, "not so: %s\n", what);
  return condition;
}

// Drives on after a first Compute, then closes the loop.
bool MapsALoop(JointScanSolver* solver, SimulatedMapper* mapper) {
  mapper->Process(70);
  bool good = Expect(mapper->CorrectPoses() == 70, "every node is corrected");
  mapper->Process(60);
  mapper->CloseLoop(5, 125);
  const double joined_m = mapper->ErrorOfConstraints(), graph_m = mapper->ErrorOfPoseGraph();
  good &= Expect(mapper->CorrectPoses() == 130, "every node is corrected after the loop");
  const double joint_m = mapper->Error();
  std::printf("%d nodes, mean error: constraints %.4f m, pose graph %.4f m, with scans %.4f m\n",
              mapper->num_nodes(), joined_m, graph_m, joint_m);
  good &= Expect(solver->status().ok(), "all was sound so far");
  return good & Expect(joint_m < std::min(joined_m, graph_m), "scans make the poses better");
}

// Nodes that go, come back, and are moved by hand.
bool BearsChanges(JointScanSolver* solver, SimulatedMapper* mapper) {
  const double before_m = mapper->Error();
  solver->RemoveNode(40);
  solver->RemoveNode(41);
  solver->RemoveNode(4000);
  mapper->AddNode(41);
  solver->RemoveConstraint(80, 79);
  const Pose2 exact = Between(TruePose(39), TruePose(40));
  mapper->Link(39, 40, exact);
  bool good = Expect(!solver->status().ok(), "a constraint to a removed node is reported");
  const karto::Pose2& pose = mapper->CorrectedPose(60);
  solver->ModifyNode(60, {pose.GetX() + 0.2, pose.GetY() - 0.1, 0.05});
  good &= Expect(mapper->CorrectPoses() == 129, "removed nodes have no correction");
  double yaw = 9.0;
  solver->GetNodeOrientation(60, yaw);
  good &= Expect(std::abs(plumbline::NormalizeAngle(yaw - pose.GetHeading())) < 1e-9,
                 "the orientation is that of the correction");
  good &= Expect(solver->getGraph()->size() == 129, "the graph has every node");
  std::printf("mean error after changes: %.4f m\n", mapper->Error());
  good &= Expect(mapper->Error() < 1.2 * before_m, "changes do not harm");
  solver->Reset();
  return good & Expect(mapper->CorrectPoses() == 0, "after Reset there is nothing");
}

}  // namespace

int main() {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver);
  return MapsALoop(&solver, &mapper) && BearsChanges(&solver, &mapper) ? 0 : 1;
}
