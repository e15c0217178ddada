// A map that is made while the robot drives.

#include "plumbline/solvers/online_mapper.h"

#include <optional>
#include <utility>
#include <vector>

#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/errors.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/apps/python/mapping.h"
#include "plumbline/apps/python/objects.h"
#include "plumbline/solvers/map_sessions.h"

namespace plumbline {
namespace py = pybind11;
namespace {

// An OnlineMap with its arrays.
struct OnlineMapObject {
  py::object poses;
  py::object points;
  bool is_in_map = true;
  Pose2 map_from_odometry;
  int num_closures = 0;
  int num_remappings = 0;
  std::vector<Alarm> alarms;
};

class OnlineMapperObject {
 public:
  OnlineMapperObject(const std::vector<LaserModel>& lasers, const MapLogOptions& options)
      : mapper_(lasers, {options}) {}
  OnlineMapperObject(const std::vector<LaserModel>& lasers, const GraphObject& saved_map,
                     std::optional<Pose2> map_from_robot, const MapLogOptions& options,
                     bool keeps_scans)
      : mapper_(lasers, {options, keeps_scans}, {*saved_map, map_from_robot}) {}

  OnlinePose AddScan(double timestamp_s, const py::object& ranges, std::optional<Pose2> odometry,
                     int laser) {
    const LaserScan scan{timestamp_s, NumbersOf("ranges", ranges)};
    OnlinePose now;
    RaiseIfError(Unlocked([&] { return mapper_.AddScan(scan, odometry, &now, laser); }));
    return now;
  }

  OnlineMapObject GetMap() const {
    OnlineMap map;
    RaiseIfError(Unlocked([&] { return mapper_.GetMap(&map); }));
    std::vector<double> points;
    points.reserve(2 * map.points.size());
    for (const Eigen::Vector2d& point : map.points) {
      points.insert(points.end(), {point.x(), point.y()});
    }
    return {ArrayOf(PoseArray(map.map_from_robot), 3),
            ArrayOf(std::move(points), 2),
            map.is_in_map,
            map.map_from_odometry,
            map.num_closures,
            map.num_remappings,
            std::move(map.alarms)};
  }

  void Wait() {
    RaiseIfError(Unlocked([&] { return mapper_.Wait(); }));
  }

  py::object MapNow() const {
    LogMapping mapping;
    RaiseIfError(Unlocked([&] { return mapper_.MapNow(&mapping); }));
    return MappingOf(std::move(mapping));
  }

  py::object Finish() {
    LogMapping mapping;
    RaiseIfError(Unlocked([&] { return mapper_.Finish(&mapping); }));
    return MappingOf(std::move(mapping));
  }

  py::list FinishWithMap() {
    SessionsMapping mapping;
    RaiseIfError(Unlocked([&] { return mapper_.Finish(&mapping); }));
    py::list maps;
    for (SessionMap& map : mapping.maps) maps.append(MappingOf(std::move(map.mapping)));
    return maps;
  }

 private:
  template <typename Work>
  static Status Unlocked(const Work& work) {
    const py::gil_scoped_release unlocked;
    return work();
  }

  OnlineMapper mapper_;
};

}  // namespace

void BindOnlineMapper(py::module_* module) {
  Fields<OnlinePose>(
      module, "OnlinePose",
      "Where the robot is, in the frame of the saved map, or else of its first scan.")
      .Field("scan", &OnlinePose::scan, "index of the scan among all scans that were added")
      .Field(
          "is_in_map", &OnlinePose::is_in_map,
          "whether the place in the saved map is known; true without one. Until then the pose is "
          "in the frame of the first scan")
      .Field("map_from_robot", &OnlinePose::map_from_robot, "at the time of the scan")
      .Field("map_from_odometry", &OnlinePose::map_from_odometry, "frame of the odometry")
      .Field("num_pending", &OnlinePose::num_pending,
             "scans in which loops have not been sought yet");
  Fields<OnlineMapObject>(module, "OnlineMap", "The map of a drive that goes on.")
      .Field("poses", &OnlineMapObject::poses, "(N, 3): map_from_robot per scan")
      .Field("points", &OnlineMapObject::points, "(M, 2): surfaces of the keyframes [m]")
      .Field("is_in_map", &OnlineMapObject::is_in_map, "as of the newest scan")
      .Field("map_from_odometry", &OnlineMapObject::map_from_odometry, "at the newest scan")
      .Field("num_closures", &OnlineMapObject::num_closures, "in force")
      .Field("num_remappings", &OnlineMapObject::num_remappings,
             "maps of the drive so far, in the background")
      .Field("alarms", &OnlineMapObject::alarms, "of the last of these maps");
  using Mapper = OnlineMapperObject;
  py::class_<Mapper>(*module, "OnlineMapper",
                     "Maps while the robot drives. Loops are closed in the background; corrections "
                     "are in the poses from then on. May be used from any thread; Python's lock is "
                     "released meanwhile.")
      .def(py::init<const std::vector<LaserModel>&, const MapLogOptions&>(), py::arg("lasers"),
           py::arg_v("options", MapLogOptions(), "MapLogOptions()"),
           "Bad options and lasers are reported by the first scan.")
      .def(
          py::init<const std::vector<LaserModel>&, const GraphObject&, std::optional<Pose2>,
                   const MapLogOptions&, bool>(),
          py::arg("lasers"), py::arg("saved_map"), py::arg("map_from_robot") = py::none(),
          py::arg_v("options", MapLogOptions(), "MapLogOptions()"), py::arg("keeps_scans") = true,
          "Begins in a saved map, a SlamGraph of poses and scans. If all of its poses are fixed, "
          "the drive is localised in it; if none is, the drive continues it. map_from_robot: where "
          "the robot is at the first scan, give or take 0.5 m and 0.15 rad; None: the place is "
          "sought. keeps_scans: False in a fixed map forgets the scans before the last 100 m; "
          "finish then fails.")
      .def("add_scan", &Mapper::AddScan, py::arg("timestamp_s"), py::arg("ranges"),
           py::arg("odometry") = py::none(), py::arg("laser") = 0,
           "Matches a scan and returns its OnlinePose at once. ranges [m]: shape (num_beams,). "
           "odometry: x, y [m], yaw [rad] of the robot by its wheels, in any fixed frame; None if "
           "it is not known: the step is predicted. laser: index of the laser. Raises "
           "InvalidArgumentError, with nothing changed, on bad numbers, times that go back, and "
           "odometry that jumps: add that scan without odometry.")
      .def("get_map", &Mapper::GetMap, "The map as it is known now.")
      .def("wait", &Mapper::Wait, "Waits until the background has caught up with all scans.")
      .def("map_now", &Mapper::MapNow,
           "Maps the measurements so far as map_log does, what finish would give now; the drive "
           "goes on meanwhile. Returns a LogMapping.")
      .def("finish", &Mapper::Finish,
           "Ends the drive and maps all of its measurements as map_log does. Returns a "
           "LogMapping. A saved map has no part in it.")
      .def("finish_with_map", &Mapper::FinishWithMap,
           "Ends the drive, and maps the saved map and the drive together. Returns a list of "
           "LogMapping: one if the drive was tied to the map, whose poses come first; else one of "
           "each.");
}

}  // namespace plumbline
