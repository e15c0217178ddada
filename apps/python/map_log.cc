// From a log to a map.

#include "plumbline/solvers/map_log.h"

#include <utility>

#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/errors.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/apps/python/mapping.h"
#include "plumbline/apps/python/objects.h"
#include "plumbline/apps/python/progress.h"

namespace plumbline {
namespace py = pybind11;
namespace {

// A LogMapping in parts that outlive it.
struct MappingObject {
  py::object graph = py::cast(GraphObject());
  py::object state = py::cast(StateObject());
  py::object start_poses = ArrayOf(std::vector<double>(), 3);
  py::object report = py::cast(MappingReport());
  Pose2 before_from_after;
};

void TakeOver(LogMapping mapping, MappingObject* object) {
  object->graph = py::cast(GraphObject(std::move(mapping.graph)));
  object->state = py::cast(StateObject(std::move(mapping.state)));
  object->start_poses = ArrayOf(std::move(mapping.start_poses), 3);
  object->report = py::cast(std::move(mapping.report));
  object->before_from_after = mapping.before_from_after;
}

py::object Map(const GraphObject& graph, MapLogOptions options, py::object seeding_progress,
               py::object progress, py::object into) {
  Progress seeding(std::move(seeding_progress)), solving(std::move(progress));
  options.solver.callback = solving.OfSolver();
  if (into.is_none()) into = py::cast(MappingObject());
  if (!py::isinstance<MappingObject>(into)) throw py::type_error("into: it is no LogMapping");
  LogMapping mapping;
  const Status status = graph.ReadUnlocked([&](const SlamGraph& unlocked) {
    return MapLog(options, unlocked, seeding.OfSeeding(), &mapping);
  });
  TakeOver(std::move(mapping), into.cast<MappingObject*>());
  seeding.RaisePending();
  solving.RaisePending();
  RaiseIfError(status);
  return into;
}

}  // namespace

py::object MappingOf(LogMapping mapping) {
  MappingObject object;
  TakeOver(std::move(mapping), &object);
  return py::cast(std::move(object));
}

void BindMapLog(py::module_* module) {
  Fields<FrozenStretch>(module, "FrozenStretch", "Scans that a frozen laser repeated.")
      .Field("laser", &FrozenStretch::laser, "laser id")
      .Field("first_scan", &FrozenStretch::first_scan, "scan id: the genuine one")
      .Field("last_scan", &FrozenStretch::last_scan, "scan id: the last repetition")
      .Field("num_repeated", &FrozenStretch::num_repeated, "scans after the first")
      .Field("moved_m", &FrozenStretch::moved_m, "meanwhile, by odometry [m]")
      .Field("turned_rad", &FrozenStretch::turned_rad, "likewise [rad]");
  Fields<ScanPlace>(module, "ScanPlace", "A scan of a graph, as people look for it.")
      .Field("scan", &ScanPlace::scan, "scan id, or None")
      .Field("time_s", &ScanPlace::time_s, "[s]")
      .Field("world_position", &ScanPlace::world_position, "(2,): of the robot [m]")
      .Method("text", &ScanPlace::Text, "With time and position.");
  Fields<Alarm>(module, "Alarm", "Why a map is probably wrong, or may be, and where.")
      .Field("place", &Alarm::place, "where")
      .Field("reason", &Alarm::reason, "why")
      .Field("wrong_share", &Alarm::wrong_share,
             "of simulated maps with such an alarm, how many were wrong, or None");
  Fields<MappingReport>(module, "MappingReport",
                        "What was found on the way from a log to a map, and whether to trust it.")
      .Field("range_noise_m", &MappingReport::range_noise_m,
             "standard deviation of a reading, as neighbouring beams show it; 0 if they do not")
      .Field("frozen_laser", &MappingReport::frozen_laser, "repetitions that were left out")
      .Field("sweep_order", &MappingReport::sweep_order, "None: all beams at once")
      .Field("seeding", &MappingReport::seeding, "how the start was found")
      .Field("solver", &MappingReport::solver, "how the joint estimation went")
      .Field("misplaced_poses", &MappingReport::misplaced_poses,
             "left beside where their scans fit: the estimation began again with them there")
      .Field("calibration", &MappingReport::calibration, "empty if none was asked for")
      .Field("consistency", &MappingReport::consistency, "of the map")
      .Field("alarms", &MappingReport::alarms, "empty if nothing speaks against the map");
  Fields<MappingObject>(module, "LogMapping", "A log on its way to a map.")
      .Constructor(py::init<>())
      .Field("graph", &MappingObject::graph,
             "the measurements that the estimate is made of, corrected")
      .Field("state", &MappingObject::state, "the map; if it was stopped, the best so far")
      .Field("start_poses", &MappingObject::start_poses,
             "(N, 3): where the joint estimation started")
      .Field("before_from_after", &MappingObject::before_from_after,
             "how a calibrated mounting moved the frame of the robot")
      .Field("report", &MappingObject::report, "what was found on the way");
  module->def(
      "map_log", &Map, py::arg("graph"), py::arg_v("options", MapLogOptions(), "MapLogOptions()"),
      py::arg("seeding_progress") = py::none(), py::arg("progress") = py::none(),
      py::arg("into") = py::none(),
      "From a graph of odometry and scans to a map: leaves out what a frozen laser repeated, takes "
      "the motion out of sweeps, seeds (seed_graph), solves (solve) and measures whether the map "
      "contradicts itself. Returns a LogMapping; the graph stays as it is.\n\n"
      "seeding_progress(phase, num_done, num_total) and progress(IterationSummary) may return "
      "False to stop. What they raise, and Ctrl-C, is raised; `into`, a LogMapping to be filled, "
      "then has what was found until then: once the seed is complete, the best map so far.");
  module->def("alarm_text", &AlarmText, py::arg("alarms"), "A warning per line, for people.");
}

}  // namespace plumbline
