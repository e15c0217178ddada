#ifndef PLUMBLINE_TEST_APPS_SAVED_MAPS_KARTO_WRITER_H_
#define PLUMBLINE_TEST_APPS_SAVED_MAPS_KARTO_WRITER_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/test/apps/saved_maps/boost_writer.h"

namespace plumbline {

struct KartoScan {
  int id = 0;
  double time_s = 0.0;
  Pose2 odometric, corrected;
  std::vector<double> ranges;
  std::string laser = "laser";
};

struct KartoEdge {
  int from = 0, to = 0;  // indices of scans
  Pose2 difference;
  std::array<double, 9> covariance = {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.001};
};

struct KartoLaser {
  std::string name = "laser";
  Pose2 offset;
  int num_beams = 0;
  double first_rad = 0.0, step_rad = 0.0, min_range_m = 0.1, max_range_m = 30.0, threshold_m = 20.0;
};

/// A map for a test to save as slam_toolbox does.
struct KartoMap {
  std::vector<KartoLaser> lasers;
  std::vector<KartoScan> scans;
  std::vector<KartoEdge> edges;
  std::uint16_t archive_version = 18;
  std::string double_parameter = "karto::Parameter<kt_double>";
  bool has_newer_parameters = false;
  bool has_scan_matcher = true;
};

/// Writes classes of karto, and x.data.
class KartoWriter {
 public:
  explicit KartoWriter(const KartoMap& map) : map_(map), out_(map.archive_version) {}

  std::string Dataset() {
    out_.TrackedObject("Dataset");
    out_.Collection("map of sensors", map_.lasers.size());
    std::vector<std::uint32_t> lasers;
    for (const KartoLaser& laser : map_.lasers) {
      out_.Object("pair of sensors");
      Name(laser.name);
      lasers.push_back(Laser(laser));
    }
    out_.Collection("map of data", map_.scans.size());
    for (const KartoScan& scan : map_.scans) {
      out_.Object("pair of data");
      out_.Int(static_cast<std::uint32_t>(scan.id));
      out_.PointerToDerived("karto::LocalizedRangeScan");
      Scan(scan);
    }
    out_.Collection("vector of objects", lasers.size());
    for (const std::uint32_t laser : lasers) out_.Again("karto::LaserRangeFinder", laser);
    out_.Register("DatasetInfo");
    out_.Null();
    return out_.bytes();
  }

 protected:
  struct Parameter {
    std::string type, name;
    double value = 0.0;
    Pose2 pose;
  };

  void Vector(double x, double y) {
    out_.Object("Vector2");
    out_.Double(x);
    out_.Double(y);
  }
  void Pose(const Pose2& pose) {
    out_.Object("Pose2");
    Vector(pose.x, pose.y);
    out_.Double(pose.yaw);
  }
  void Name(const std::string& name) {
    out_.TrackedObject("Name");
    out_.Text(name);
    out_.Text("");
  }

  // The base of sensors, data and mapper, with its parameters.
  void Object(const std::string& name, const std::vector<Parameter>& parameters) {
    out_.Object("Object");
    out_.TrackedObject("NonCopyable");
    out_.Pointer("ParameterManager");
    out_.TrackedObject("NonCopyable");
    out_.Collection("vector of parameters", parameters.size());
    parameter_ids_.clear();
    for (const Parameter& parameter : parameters) {
      parameter_ids_.push_back(out_.PointerToDerived(parameter.type));
      Value(parameter);
    }
    out_.Collection("map of parameters", parameters.size());
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      out_.Object("pair of parameters");
      out_.Text(parameters[i].name);
      out_.Again(parameters[i].type, parameter_ids_[i]);
    }
    Name(name);
  }

  void Value(const Parameter& parameter) {
    const bool is_enum = parameter.type == "karto::ParameterEnum";
    if (is_enum) out_.TrackedObject("karto::Parameter<kt_int32s>");
    out_.Object("AbstractParameter");
    out_.Text(parameter.name);
    out_.Text("");
    if (is_enum) {
      out_.Int(0);
      out_.Collection("map of names", 1);
      out_.Object("pair of names");
      out_.Text("Custom");
      out_.Int(0);
    } else if (parameter.type == "karto::Parameter<kt_bool>") {
      out_.Bool(parameter.value != 0.0);
    } else if (parameter.type == "karto::Parameter<kt_int32u>") {
      out_.Int(static_cast<std::uint32_t>(parameter.value));
    } else if (parameter.type == "karto::Parameter<karto::Pose2>") {
      Pose(parameter.pose);
    } else {
      out_.Double(parameter.value);
    }
  }

  std::uint32_t Laser(const KartoLaser& laser) {
    const std::string number = map_.double_parameter;
    const std::uint32_t id = out_.PointerToDerived("karto::LaserRangeFinder");
    const std::vector<Parameter> parameters = {
        {"karto::Parameter<karto::Pose2>", "OffsetPose", 0.0, laser.offset},
        {number, "MinimumRange", laser.min_range_m, {}},
        {number, "MaximumRange", laser.max_range_m, {}},
        {number, "MinimumAngle", laser.first_rad, {}},
        {number, "MaximumAngle", laser.first_rad + laser.step_rad * (laser.num_beams - 1), {}},
        {number, "AngularResolution", laser.step_rad, {}},
        {number, "RangeThreshold", laser.threshold_m, {}},
        {"karto::Parameter<kt_bool>", "Is360DegreeLaser", 0.0, {}},
        {"karto::ParameterEnum", "Type", 0.0, {}}};
    out_.Object("Sensor");
    Object(laser.name, parameters);
    for (const int i : {0, 3, 4, 5, 1, 2, 6, 7, 8})
      out_.Again(parameters[i].type, parameter_ids_[i]);
    out_.Int(static_cast<std::uint32_t>(laser.num_beams));
    return id;
  }

  void Scan(const KartoScan& scan) {
    Pose(scan.odometric);
    Pose(scan.corrected);
    Pose(scan.corrected);  // barycenter
    out_.Collection("vector of points", 2);
    for (int i = 0; i < 2; ++i) Vector(i, 0.0);
    out_.Collection("vector of points", 0);
    out_.Object("BoundingBox2");
    Vector(0.0, 0.0);
    Vector(1.0, 1.0);
    out_.Bool(false);  // is_dirty
    out_.TrackedObject("LaserRangeScan");
    out_.Int(static_cast<std::uint32_t>(scan.ranges.size()));
    out_.TrackedObject("SensorData");
    out_.Int(static_cast<std::uint32_t>(scan.id));  // state_id
    out_.Int(static_cast<std::uint32_t>(scan.id));
    Name(scan.laser);
    out_.Double(scan.time_s);
    out_.Collection("vector of custom data", 0);
    Object("", {});
    for (const double range : scan.ranges) out_.Double(range);
  }

  const KartoMap& map_;
  BoostWriter out_;
  std::vector<std::uint32_t> parameter_ids_;  // of the object that was written last
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_SAVED_MAPS_KARTO_WRITER_H_
