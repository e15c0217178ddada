// Stands in for the header of slam_toolbox's karto: what the plug-in and its tests use of it,
// declared as it is there. STAND_IN_FOR_HUMBLE chooses the distribution.
#ifndef PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_KARTO_SDK_MAPPER_H_
#define PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_KARTO_SDK_MAPPER_H_

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>
#ifdef STAND_IN_FOR_HUMBLE
#include <rclcpp/rclcpp.hpp>
#else
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#endif

using kt_bool = bool;
using kt_double = double;
using kt_int32s = std::int32_t;
using kt_int32u = std::uint32_t;

namespace karto {

class Exception {
 public:
  Exception(const std::string& rMessage = "Karto Exception") : message_(rMessage) {}
  const std::string& GetErrorMessage() const { return message_; }

 private:
  std::string message_;
};

class Name {
 public:
  Name() = default;
  Name(const std::string& rName) : name_(rName) {}
  bool operator<(const Name& rOther) const { return name_ < rOther.name_; }
  std::string ToString() const { return name_; }

 private:
  std::string name_;
};

class Pose2 {
 public:
  Pose2() = default;
  Pose2(kt_double x, kt_double y, kt_double heading) : x_(x), y_(y), heading_(heading) {}
  kt_double GetX() const { return x_; }
  kt_double GetY() const { return y_; }
  kt_double GetHeading() const { return heading_; }

 private:
  kt_double x_ = 0.0, y_ = 0.0, heading_ = 0.0;
};

class Matrix3 {
 public:
  kt_double& operator()(kt_int32u row, kt_int32u column) { return values_[row][column]; }
  kt_double operator()(kt_int32u row, kt_int32u column) const { return values_[row][column]; }

 private:
  kt_double values_[3][3] = {};
};

class Sensor {
 public:
  virtual ~Sensor() = default;
  const Name& GetName() const { return name_; }
  const Pose2& GetOffsetPose() const { return offset_pose_; }
  void SetOffsetPose(const Pose2& rPose) { offset_pose_ = rPose; }

 protected:
  explicit Sensor(const Name& rName) : name_(rName) {}

 private:
  Name name_;
  Pose2 offset_pose_;
};

enum LaserRangeFinderType { LaserRangeFinder_Custom = 0 };

class LaserRangeFinder : public Sensor {
 public:
  static LaserRangeFinder* CreateLaserRangeFinder(LaserRangeFinderType, const Name& rName) {
    return new LaserRangeFinder(rName);
  }
  kt_double GetMinimumRange() const { return minimum_range_; }
  void SetMinimumRange(kt_double minimumRange) { minimum_range_ = minimumRange; }
  kt_double GetRangeThreshold() const { return range_threshold_; }
  void SetMaximumRange(kt_double maximumRange) { range_threshold_ = maximumRange; }
  void SetRangeThreshold(kt_double rangeThreshold) { range_threshold_ = rangeThreshold; }
  kt_double GetMinimumAngle() const { return minimum_angle_; }
  void SetMinimumAngle(kt_double minimumAngle) { minimum_angle_ = minimumAngle; }
  void SetMaximumAngle(kt_double) {}
  kt_double GetAngularResolution() const { return angular_resolution_; }
  void SetAngularResolution(kt_double angularResolution) {
    angular_resolution_ = angularResolution;
  }

 private:
  using Sensor::Sensor;

  kt_double minimum_range_ = 0.0, range_threshold_ = 12.0;
  kt_double minimum_angle_ = 0.0, angular_resolution_ = 0.0;
};

class SensorManager {
 public:
  static SensorManager* GetInstance() {
    static SensorManager manager;
    return &manager;
  }
  void RegisterSensor(Sensor* pSensor, kt_bool override = false) {
    if (!override && sensors_.count(pSensor->GetName()) > 0) throw Exception("known already");
    sensors_[pSensor->GetName()] = pSensor;
  }
  void UnregisterSensor(Sensor* pSensor) {
    if (sensors_.erase(pSensor->GetName()) == 0) throw Exception("not registered");
  }
  template <class T>
  T* GetSensorByName(const Name& rName) {
    const auto sensor = sensors_.find(rName);
    if (sensor == sensors_.end()) {
      throw Exception("Sensor not registered: [" + rName.ToString() + "]");
    }
    return dynamic_cast<T*>(sensor->second);
  }

 private:
  std::map<Name, Sensor*> sensors_;
};

using RangeReadingsVector = std::vector<kt_double>;

class LocalizedRangeScan {
 public:
  LocalizedRangeScan(const Name& rSensorName, const RangeReadingsVector& rReadings)
      : sensor_name_(rSensorName), readings_(rReadings) {}
  kt_int32s GetUniqueId() const { return unique_id_; }
  void SetUniqueId(kt_int32u uniqueId) { unique_id_ = static_cast<kt_int32s>(uniqueId); }
  kt_double GetTime() const { return time_; }
  void SetTime(kt_double time) { time_ = time; }
  const Name& GetSensorName() const { return sensor_name_; }
  const Pose2& GetCorrectedPose() const { return corrected_pose_; }
  void SetCorrectedPose(const Pose2& rPose) { corrected_pose_ = rPose; }
  kt_double* GetRangeReadings() const { return const_cast<kt_double*>(readings_.data()); }
  kt_int32u GetNumberOfRangeReadings() const { return static_cast<kt_int32u>(readings_.size()); }

 private:
  Name sensor_name_;
  RangeReadingsVector readings_;
  kt_int32s unique_id_ = -1;
  kt_double time_ = 0.0;
  Pose2 corrected_pose_;
};

class EdgeLabel {
 public:
  virtual ~EdgeLabel() = default;
};

// The second pose as seen from the first; the covariance comes in the axes of the world, and is
// kept in those of the first pose.
class LinkInfo : public EdgeLabel {
 public:
  LinkInfo(const Pose2& rPose1, const Pose2& rPose2, const Matrix3& rCovariance) {
    const kt_double c = std::cos(rPose1.GetHeading()), s = std::sin(rPose1.GetHeading());
    const kt_double dx = rPose2.GetX() - rPose1.GetX(), dy = rPose2.GetY() - rPose1.GetY();
    pose_difference_ = {c * dx + s * dy, c * dy - s * dx,
                        std::remainder(rPose2.GetHeading() - rPose1.GetHeading(), 2.0 * M_PI)};
    const kt_double rotation[3][3] = {{c, s, 0.0}, {-s, c, 0.0}, {0.0, 0.0, 1.0}};
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j < 9; ++j) {
        covariance_(i / 3, i % 3) +=
            rotation[i / 3][j / 3] * rCovariance(j / 3, j % 3) * rotation[i % 3][j % 3];
      }
    }
  }
  const Pose2& GetPoseDifference() { return pose_difference_; }
  const Matrix3& GetCovariance() { return covariance_; }

 private:
  Pose2 pose_difference_;
  Matrix3 covariance_;
};

template <typename T>
class Vertex {
 public:
  explicit Vertex(T* pObject) : object_(pObject) {}
  T* GetObject() const { return object_; }

 private:
  T* object_;
};

template <typename T>
class Edge {
 public:
  Edge(Vertex<T>* pSource, Vertex<T>* pTarget) : source_(pSource), target_(pTarget) {}
  Edge(const Edge&) = delete;
  Edge& operator=(const Edge&) = delete;
  ~Edge() { delete label_; }
  Vertex<T>* GetSource() const { return source_; }
  Vertex<T>* GetTarget() const { return target_; }
  EdgeLabel* GetLabel() { return label_; }
  void SetLabel(EdgeLabel* pLabel) { label_ = pLabel; }

 private:
  Vertex<T>*source_, *target_;
  EdgeLabel* label_ = nullptr;
};

class ScanSolver {
 public:
  typedef std::vector<std::pair<kt_int32s, Pose2>> IdPoseVector;

  virtual ~ScanSolver() = default;
  virtual void Compute() = 0;
#ifdef STAND_IN_FOR_HUMBLE
  virtual void Configure(rclcpp::Node::SharedPtr node) = 0;
#else
  virtual void Configure(rclcpp_lifecycle::LifecycleNode::SharedPtr node) = 0;
#endif
  virtual const IdPoseVector& GetCorrections() const = 0;
  virtual void AddNode(Vertex<LocalizedRangeScan>*) {}
  virtual void RemoveNode(kt_int32s) {}
  virtual void AddConstraint(Edge<LocalizedRangeScan>*) {}
  virtual void RemoveConstraint(kt_int32s, kt_int32s) {}
  virtual void Clear() {}
  virtual void Reset() {}
  virtual std::unordered_map<int, Eigen::Vector3d>* getGraph() { return nullptr; }
  virtual void ModifyNode(const int&, Eigen::Vector3d) {}
  virtual void GetNodeOrientation(const int&, double&) {}
};

}  // namespace karto

#endif  // PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_KARTO_SDK_MAPPER_H_
