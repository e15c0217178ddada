#ifndef PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_SIMULATED_MAPPER_H_
#define PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_SIMULATED_MAPPER_H_

#include <karto_sdk/Mapper.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {

/// A mapper in the place of karto's: a robot drives around the block in the middle of a hall, and
/// its scans are matched with some error. Calls a solver in the order that slam_toolbox does.
class SimulatedMapper {
 public:
  explicit SimulatedMapper(karto::ScanSolver* solver, const std::string& laser = "laser")
      : solver_(solver),
        laser_(karto::LaserRangeFinder::CreateLaserRangeFinder(karto::LaserRangeFinder_Custom,
                                                               karto::Name(laser))) {
    laser_->SetMinimumRange(0.1);
    laser_->SetMaximumRange(9.0);
    laser_->SetRangeThreshold(9.0);
    laser_->SetMinimumAngle(-kPi);
    laser_->SetMaximumAngle(kPi - kStepRad);
    laser_->SetAngularResolution(kStepRad);
    laser_->SetOffsetPose(karto::Pose2(0.15, 0.0, 0.1));
  }
  ~SimulatedMapper() {
    try {
      UnregisterLaser();
    } catch (const karto::Exception&) {  // It was not registered.
    }
  }
  SimulatedMapper(const SimulatedMapper&) = delete;
  SimulatedMapper& operator=(const SimulatedMapper&) = delete;

  void RegisterLaser() { karto::SensorManager::GetInstance()->RegisterSensor(laser_.get(), true); }
  void UnregisterLaser() { karto::SensorManager::GetInstance()->UnregisterSensor(laser_.get()); }

  /// The next scans of the drive: a node each, linked to the one before. At 120 the robot has come
  /// round.
  void Drive(int num_scans) {
    for (int i = 0; i < num_scans; ++i, ++next_id_) {
      const int id = next_id_;
      Pose2 pose, matched;
      if (id > 0) {
        matched = Match(id - 1, id);
        pose = PoseOf(id - 1) * matched;
      }
      scans_[id] = MakeScan(id, pose);
      vertices_[id] = std::make_unique<Vertex>(scans_[id].get());
      solver_->AddNode(vertices_[id].get());
      if (id > 0) AddEdge(id - 1, id, matched);
    }
  }
  /// A loop closure, or any other match; `error` makes it a false one.
  void Link(int from, int to, const Pose2& error = Pose2()) {
    AddEdge(from, to, Match(from, to) * error);
  }
  /// MapperGraph::CorrectPoses. Returns the number of corrections.
  int CorrectPoses() {
    solver_->Compute();
    const auto corrections = solver_->GetCorrections();
    for (const auto& [id, pose] : corrections) scans_.at(id)->SetCorrectedPose(pose);
    solver_->Clear();
    return static_cast<int>(corrections.size());
  }
  /// Mapper::RemoveNodeFromGraph, after which the scan is no more.
  void Remove(int id) {
    for (auto edge = edges_.begin(); edge != edges_.end();) {
      const int from = (*edge)->GetSource()->GetObject()->GetUniqueId();
      const int to = (*edge)->GetTarget()->GetObject()->GetUniqueId();
      if (from == id || to == id) {
        solver_->RemoveConstraint(from, to);
        edge = edges_.erase(edge);
      } else {
        ++edge;
      }
    }
    solver_->RemoveNode(id);
    vertices_.erase(id);
    scans_.erase(id);
  }
  /// What slam_toolbox does with a solver when a saved map is loaded, before the laser is known.
  void HandOver(karto::ScanSolver* solver) {
    solver_ = solver;
    solver_->Reset();
    for (const auto& [id, vertex] : vertices_) solver_->AddNode(vertex.get());
    for (const auto& edge : edges_) solver_->AddConstraint(edge.get());
  }

  int num_nodes() const { return static_cast<int>(scans_.size()); }
  karto::Vertex<karto::LocalizedRangeScan>* vertex(int id) { return vertices_.at(id).get(); }
  Pose2 PoseOf(int id) const {
    const karto::Pose2& pose = scans_.at(id)->GetCorrectedPose();
    return {pose.GetX(), pose.GetY(), pose.GetHeading()};
  }

  /// Mean distance [m] of the nodes from where they are, seen from the first of them.
  double Error() const {
    std::map<int, Pose2> poses;
    for (const auto& [id, scan] : scans_) poses[id] = PoseOf(id);
    return MeanError(poses);
  }
  /// The same at the optimum of the constraints, without scans. Needs all nodes.
  double ErrorOfPoseGraph() const {
    std::vector<Pose2> poses;
    for (const auto& [id, scan] : scans_) poses.push_back(PoseOf(id));
    OptimizePoseGraph(constraints_, {}, &poses);
    std::map<int, Pose2> by_id;
    for (const auto& [id, scan] : scans_) by_id[id] = poses[by_id.size()];
    return MeanError(by_id);
  }

 private:
  using Vertex = karto::Vertex<karto::LocalizedRangeScan>;
  using Edge = karto::Edge<karto::LocalizedRangeScan>;

  static constexpr double kStepRad = kPi / 90.0;
  static constexpr double kMatchM = 0.02, kMatchRad = 0.008;  // standard deviations of a match

  // Around the block and a little further.
  static Pose2 TruePose(int id) {
    const double turn = DegToRad(3.0 * id);
    return {5.5 * std::cos(turn), 3.5 * std::sin(turn),
            std::atan2(3.5 * std::cos(turn), -5.5 * std::sin(turn))};
  }

  // Where a beam meets the outer walls of the hall or the block [m].
  static double RangeInHall(const Pose2& laser, double bearing_rad) {
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

  std::unique_ptr<karto::LocalizedRangeScan> MakeScan(int id, const Pose2& pose) {
    const Pose2 world_from_laser = TruePose(id) * Pose2(0.15, 0.0, 0.1);
    std::vector<double> ranges_m;
    for (int beam = 0; beam < 180; ++beam) {
      ranges_m.push_back(RangeInHall(world_from_laser, -kPi + beam * kStepRad) +
                         0.01 * noise_(engine_));
    }
    // As drivers report what they did not see.
    ranges_m[id % 180] = std::numeric_limits<double>::quiet_NaN();
    ranges_m[(id + 60) % 180] = std::numeric_limits<double>::infinity();
    ranges_m[(id + 120) % 180] = 0.0;
    auto scan = std::make_unique<karto::LocalizedRangeScan>(laser_->GetName(), ranges_m);
    scan->SetUniqueId(id);
    scan->SetTime(0.1 * id);
    scan->SetCorrectedPose(karto::Pose2(pose.x, pose.y, pose.yaw));
    return scan;
  }

  Pose2 Match(int from, int to) {
    // One after the other: compilers differ in the order of arguments.
    const double x = kMatchM * noise_(engine_), y = kMatchM * noise_(engine_);
    return Between(TruePose(from), TruePose(to)) * Pose2(x, y, kMatchRad * noise_(engine_));
  }
  void AddEdge(int from, int to, const Pose2& motion) {
    const Pose2 here = PoseOf(from), there = here * motion;
    karto::Matrix3 covariance;
    covariance(0, 0) = covariance(1, 1) = kMatchM * kMatchM;
    covariance(2, 2) = kMatchRad * kMatchRad;
    edges_.push_back(std::make_unique<Edge>(vertices_.at(from).get(), vertices_.at(to).get()));
    edges_.back()->SetLabel(new karto::LinkInfo(karto::Pose2(here.x, here.y, here.yaw),
                                                karto::Pose2(there.x, there.y, there.yaw),
                                                covariance));
    solver_->AddConstraint(edges_.back().get());
    RelativePoseConstraint constraint{from, to, motion};
    constraint.covariance =
        Eigen::Vector3d(kMatchM * kMatchM, kMatchM * kMatchM, kMatchRad * kMatchRad).asDiagonal();
    constraints_.push_back(constraint);
  }
  static double MeanError(const std::map<int, Pose2>& poses) {
    const auto& [first, first_pose] = *poses.begin();
    double sum_m = 0.0;
    for (const auto& [id, pose] : poses) {
      const Pose2 error =
          Between(Between(TruePose(first), TruePose(id)), Between(first_pose, pose));
      sum_m += error.translation().norm();
    }
    return sum_m / poses.size();
  }

  karto::ScanSolver* solver_;
  std::unique_ptr<karto::LaserRangeFinder> laser_;
  std::map<int, std::unique_ptr<karto::LocalizedRangeScan>> scans_;
  std::map<int, std::unique_ptr<Vertex>> vertices_;
  std::vector<std::unique_ptr<Edge>> edges_;
  std::vector<RelativePoseConstraint> constraints_;  // all that there ever were
  int next_id_ = 0;
  std::mt19937 engine_{3};
  std::normal_distribution<double> noise_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_SIMULATED_MAPPER_H_
