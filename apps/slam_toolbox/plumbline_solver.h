#ifndef PLUMBLINE_APPS_SLAM_TOOLBOX_PLUMBLINE_SOLVER_H_
#define PLUMBLINE_APPS_SLAM_TOOLBOX_PLUMBLINE_SOLVER_H_

#include <karto_sdk/Mapper.h>
#include <plumbline/core/angle.h>
#include <plumbline/core/laser_scan.h>
#include <plumbline/core/pose2.h>
#include <plumbline/core/status.h>
#include <plumbline/solvers/interface/solver_options.h>

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <mutex>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "joint_map.h"
#include "solver_parameters.h"

namespace plumbline {

/// A scan solver for slam_toolbox that uses the scans: constraints and all laser returns are
/// estimated together, where a pose graph adjusts the poses by the constraints alone.
///
/// Nothing of the mapper is kept: scans are copied as their nodes are added. The model of a scan's
/// laser is asked for when it is needed, for slam_toolbox registers the lasers of a saved map after
/// its nodes. Functions may be called from several threads.
class JointScanSolver : public karto::ScanSolver {
  // What Configure takes differs: rclcpp::Node of ROS 2 Humble, a lifecycle node of Jazzy.
  template <typename Pointer>
  static Pointer ArgumentOf(void (karto::ScanSolver::*)(Pointer));

 public:
  using HostPointer = decltype(ArgumentOf(&karto::ScanSolver::Configure));

  /// Declares the parameters of the README, and reads them. Options that are out of range are
  /// logged, and the defaults stay.
  // By value, as karto has it.
  // NOLINTNEXTLINE(performance-unnecessary-value-param)
  void Configure(HostPointer host) override {
    const SolverOptions options = DeclareParameters(host.get());
    const std::lock_guard<std::mutex> lock(mutex_);
    logger_ = host->get_logger();
    std::string error;
    if (options.Check(&error)) {
      map_ = JointMap(options);
      scans_without_laser_.clear();
    } else {
      Note(Status::InvalidArgument("parameters: " + error + "; the defaults stay"));
    }
  }

  /// Takes a copy of the scan. A known id gives way to the new node.
  void AddNode(karto::Vertex<karto::LocalizedRangeScan>* vertex) override {
    if (vertex == nullptr || vertex->GetObject() == nullptr) return;
    const karto::LocalizedRangeScan& scan = *vertex->GetObject();
    const int id = scan.GetUniqueId();
    const std::lock_guard<std::mutex> lock(mutex_);
    const Status status = map_.AddNode(id, FromKarto(scan.GetCorrectedPose()), scan.GetTime());
    Note(status);
    if (!status.ok()) return;
    const double* ranges_m = scan.GetRangeReadings();
    scans_without_laser_[id] = {scan.GetSensorName(),
                                {ranges_m, ranges_m + scan.GetNumberOfRangeReadings()}};
  }

  /// The node's constraints go with it.
  void RemoveNode(kt_int32s id) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    map_.RemoveNode(id);
    scans_without_laser_.erase(id);
  }

  /// Constraints between unknown nodes, or without a sound covariance, are left out and logged.
  void AddConstraint(karto::Edge<karto::LocalizedRangeScan>* edge) override {
    if (edge == nullptr || edge->GetLabel() == nullptr) return;
    auto* link = static_cast<karto::LinkInfo*>(edge->GetLabel());
    Eigen::Matrix3d covariance;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        covariance(row, column) =
            0.5 * (link->GetCovariance()(row, column) + link->GetCovariance()(column, row));
      }
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    Note(map_.AddConstraint(edge->GetSource()->GetObject()->GetUniqueId(),
                            edge->GetTarget()->GetObject()->GetUniqueId(),
                            FromKarto(link->GetPoseDifference()), covariance));
  }

  void RemoveConstraint(kt_int32s source, kt_int32s target) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    map_.RemoveConstraint(source, target);
  }

  void Compute() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    status_ = Status::Ok();
    PlaceScans();
    Note(map_.Estimate());
    for (const std::string& warning : map_.TakeWarnings()) {
      RCLCPP_WARN(logger_, "%s", warning.c_str());
    }
    corrections_.clear();
    for (const auto& [id, pose] : map_.Poses()) {
      corrections_.emplace_back(id, karto::Pose2(pose.x, pose.y, NormalizeAngle(pose.yaw)));
    }
  }

  /// The pose of every node, by ascending id, as of the last Compute.
  const IdPoseVector& GetCorrections() const override { return corrections_; }
  /// Forgets the corrections, and nothing else.
  void Clear() override { corrections_.clear(); }
  /// Forgets all nodes and constraints; the parameters stay.
  void Reset() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    map_.Clear();
    scans_without_laser_.clear();
    corrections_.clear();
    graph_.clear();
    status_ = Status::Ok();
  }

  /// x, y [m], yaw [rad] of each node, as of this call.
  std::unordered_map<int, Eigen::Vector3d>* getGraph() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    graph_.clear();
    for (const auto& [id, pose] : map_.Poses()) graph_[id] = {pose.x, pose.y, pose.yaw};
    return &graph_;
  }

  /// Puts a node at x, y [m] and turns it by z [rad], for the next Compute to start from:
  /// slam_toolbox calls it for nodes that a user has moved.
  void ModifyNode(const int& id, Eigen::Vector3d pose) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Pose2* node = map_.FindPose(id);
    const double yaw = node == nullptr ? 0.0 : node->yaw;
    Note(map_.MoveNode(id, {pose.x(), pose.y(), yaw + pose.z()}));
  }

  /// Leaves `yaw` as it is if there is no such node.
  void GetNodeOrientation(const int& id, double& yaw) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const Pose2* node = map_.FindPose(id)) yaw = node->yaw;
  }

  /// What was wrong last; ok after a Compute() without fault.
  const Status& status() const { return status_; }

 private:
  struct Scan {
    karto::Name laser;
    std::vector<double> ranges_m;
  };

  static Pose2 FromKarto(const karto::Pose2& pose) {
    return {pose.GetX(), pose.GetY(), pose.GetHeading()};
  }

  static LaserModel ModelOf(const karto::LaserRangeFinder& finder, int num_beams) {
    LaserModel laser;
    laser.num_beams = num_beams;
    laser.first_bearing_rad = finder.GetMinimumAngle();
    laser.bearing_step_rad = finder.GetAngularResolution();
    laser.min_range_m = std::max(laser.min_range_m, finder.GetMinimumRange());
    laser.max_range_m = finder.GetRangeThreshold();
    laser.robot_from_laser = FromKarto(finder.GetOffsetPose());
    return laser;
  }

  // Puts the scans of new nodes into the map. Those whose laser nobody knows yet stay behind.
  void PlaceScans() {
    for (auto scan = scans_without_laser_.begin(); scan != scans_without_laser_.end();) {
      auto& [id, readings] = *scan;
      const int num_beams = static_cast<int>(readings.ranges_m.size());
      LaserModel laser;
      if (FindLaser(readings.laser, num_beams, &laser)) {
        Note(map_.SetScan(id, laser, std::move(readings.ranges_m)));
        scan = scans_without_laser_.erase(scan);
      } else {
        ++scan;
      }
    }
    if (scans_without_laser_.empty()) return;
    const auto& [id, readings] = *scans_without_laser_.begin();
    Note(Status::NotFound(std::to_string(scans_without_laser_.size()) +
                          " scans wait for their laser, the first is of node " +
                          std::to_string(id) + ", laser " + readings.laser.ToString()));
  }

  static bool FindLaser(const karto::Name& name, int num_beams, LaserModel* laser) {
    try {
      const auto* finder =
          karto::SensorManager::GetInstance()->GetSensorByName<karto::LaserRangeFinder>(name);
      if (finder == nullptr) return false;
      *laser = ModelOf(*finder, num_beams);
      return true;
    } catch (const karto::Exception&) {  // It is not registered.
      return false;
    }
  }

  void Note(const Status& status) {
    if (status.ok()) return;
    status_ = status;
    RCLCPP_WARN(logger_, "%s", status.message().c_str());
  }

  std::mutex mutex_;
  rclcpp::Logger logger_ = rclcpp::get_logger("JointScanSolver");
  JointMap map_;
  std::map<int, Scan> scans_without_laser_;  // by node
  IdPoseVector corrections_;
  std::unordered_map<int, Eigen::Vector3d> graph_;
  Status status_;
};

}  // namespace plumbline

using plumbline::JointScanSolver;

#endif  // PLUMBLINE_APPS_SLAM_TOOLBOX_PLUMBLINE_SOLVER_H_
