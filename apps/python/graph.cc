// Poses, lasers, graphs and states.

#include <pybind11/eigen.h>
#include <pybind11/operators.h>

#include <string>
#include <vector>

#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/apps/python/objects.h"

namespace plumbline {
namespace py = pybind11;
namespace {

// What Python hands over is a reference everywhere: a pointer would be null for None.

Pose2 PoseOf(const py::sequence& numbers) {
  if (numbers.size() != 3) throw py::value_error("a pose takes three numbers: x, y [m], yaw [rad]");
  return {numbers[0].cast<double>(), numbers[1].cast<double>(), numbers[2].cast<double>()};
}

void BindPose(py::module_* module) {
  Fields<Pose2> pose(module, "Pose2",
                     "A rigid motion of the plane, read a_from_b: it maps coordinates in frame b "
                     "to frame a. x, y [m], yaw [rad], unbounded. Any sequence of three numbers "
                     "does where a Pose2 is wanted.");
  pose.Constructor(py::init<>())
      .Constructor(py::init<const double&, const double&, const double&>(), py::arg("x"),
                   py::arg("y"), py::arg("yaw"))
      .Constructor(py::init(&PoseOf), py::arg("numbers"))
      .Option("x", &Pose2::x, "[m]")
      .Option("y", &Pose2::y, "[m]")
      .Option("yaw", &Pose2::yaw, "[rad]")
      .Method(
          "__mul__",
          [](const Pose2& a_from_b, const Pose2& b_from_c) { return a_from_b * b_from_c; },
          py::is_operator(), py::arg("b_from_c"), "a_from_c; the yaw is the plain sum.")
      .Method("inverse", &Pose2::Inverse, "b_from_a.")
      .Method(
          "between", [](const Pose2& a, const Pose2& b) { return Between(a, b); }, py::arg("other"),
          "other as self sees it, both in a common world; yaw in [-pi, pi).")
      .Method(
          "transform",
          [](const Pose2& a_from_b, const py::object& points) {
            std::vector<double> rows = RowsOf("points", points, 2);
            for (std::size_t i = 0; i < rows.size(); i += 2) {
              Eigen::Map<Eigen::Vector2d> point(&rows[i]);
              point = a_from_b * Eigen::Vector2d(point);
            }
            return ArrayOf(std::move(rows), 2);
          },
          py::arg("points"), "Points of shape (N, 2) [m], given in b, in frame a.")
      .Method("__iter__", [](const Pose2& p) { return py::iter(py::make_tuple(p.x, p.y, p.yaw)); });
  py::implicitly_convertible<py::sequence, Pose2>();
}

void BindLaser(py::module_* module) {
  Fields<LaserModel>(module, "LaserModel",
                     "A planar laser scanner: beam i leaves it at first_bearing_rad + i * "
                     "bearing_step_rad, counter-clockwise from the laser's x axis.")
      .Options()
      .Option("num_beams", &LaserModel::num_beams, "at least 1")
      .Option("first_bearing_rad", &LaserModel::first_bearing_rad, "of beam 0 [rad]")
      .Option("bearing_step_rad", &LaserModel::bearing_step_rad,
              "from a beam to the next [rad]; negative: clockwise")
      .Option("min_range_m", &LaserModel::min_range_m,
              "a reading is a return if min_range_m <= reading < max_range_m")
      .Option("max_range_m", &LaserModel::max_range_m, "see min_range_m")
      .Option("beam_period_s", &LaserModel::beam_period_s,
              "from a beam to the next [s]; 0: all beams at once")
      .Option("robot_from_laser", &LaserModel::robot_from_laser,
              "mounting of the laser on the robot")
      .Method(
          "__eq__", [](const LaserModel& a, const LaserModel& b) { return a == b; },
          py::is_operator());
  py::enum_<SweepOrder>(*module, "SweepOrder", "When the beams of a sweep are measured.")
      .value("FIRST_BEAM_FIRST", SweepOrder::kFirstBeamFirst, "in their order")
      .value("LAST_BEAM_FIRST", SweepOrder::kLastBeamFirst, "at the same pace against it")
      .value("AT_ONCE", SweepOrder::kAtOnce, "all at the same time");
}

void BindMeasurements(py::module_* module) {
  Fields<OdometryConstraint>(module, "OdometryConstraint",
                             "What the odometry says of the motion between two poses.")
      .Field("from_pose", &OdometryConstraint::from, "pose id")
      .Field("to_pose", &OdometryConstraint::to, "pose id")
      .Field("is_measured", &OdometryConstraint::is_measured,
             "False: a placeholder where no odometry was recorded")
      .Field("from_from_to", &OdometryConstraint::from_from_to,
             "pose of the robot at to_pose in its frame at from_pose");
  Fields<RelativePoseConstraint>(module, "RelativePoseConstraint",
                                 "A measured relative pose: a loop closure, or an edge.")
      .Field("from_pose", &RelativePoseConstraint::from, "pose id")
      .Field("to_pose", &RelativePoseConstraint::to, "pose id")
      .Field("from_from_to", &RelativePoseConstraint::from_from_to,
             "pose of the robot at to_pose in its frame at from_pose")
      .Field("covariance", &RelativePoseConstraint::covariance,
             "(3, 3): x, y [m], yaw [rad], in the frame of from_pose");
  Fields<FixedPose>(module, "FixedPose", "A pose that is known.")
      .Field("pose", &FixedPose::pose, "pose id")
      .Field("world_from_robot", &FixedPose::world_from_robot, "where it is held");
  Fields<ScanEntry>(module, "ScanEntry", "One sweep of a laser.")
      .Field("pose", &ScanEntry::pose, "pose id")
      .Field("laser", &ScanEntry::laser, "laser id")
      .Field("first_return", &ScanEntry::first_return, "return id; those of the scan follow it")
      .Field("num_returns", &ScanEntry::num_returns, "beams without a return are left out");
  Fields<MeasurementCorrections>(module, "MeasurementCorrections",
                                 "Measurements that a graph is to have in place of its own, see "
                                 "SlamGraph.corrected. Made by a calibration or a seeding.");
}

// Raises what the graph has refused. It goes on as it was before.
void RaiseIfRefused(GraphObject* graph) { RaiseIfError(graph->Mutable()->TakeStatus()); }

int AddLaser(GraphObject& graph, const LaserModel& laser) {
  const int id = graph.Mutable()->AddLaser(laser);
  RaiseIfRefused(&graph);
  return id;
}

int AddPose(GraphObject& graph, const Pose2& world_from_robot, double timestamp_s) {
  const int id = graph.Mutable()->AddPose(world_from_robot, timestamp_s);
  RaiseIfRefused(&graph);
  return id;
}

void CheckPose(const GraphObject& graph, long long id) { CheckId("pose", id, graph->num_poses()); }
void CheckScan(const GraphObject& graph, long long id) { CheckId("scan", id, graph->num_scans()); }
void CheckLaser(const GraphObject& graph, long long id) {
  CheckId("laser", id, graph->num_lasers());
}

void FixPose(GraphObject& graph, int pose, const std::optional<Pose2>& world_from_robot) {
  CheckPose(graph, pose);
  SlamGraph* changed = graph.Mutable();
  world_from_robot ? changed->FixPose(pose, *world_from_robot) : changed->FixPose(pose);
  RaiseIfRefused(&graph);
}

int AddScan(GraphObject& graph, int pose, int laser, const py::object& ranges) {
  CheckPose(graph, pose);
  CheckLaser(graph, laser);
  const std::vector<double> numbers = NumbersOf("ranges", ranges);
  const int id = graph.Mutable()->AddScan(pose, laser, numbers);
  RaiseIfRefused(&graph);
  return id;
}

int AddSweep(GraphObject& graph, int pose, int laser, const py::object& ranges, const Pose2& motion,
             SweepOrder order) {
  CheckPose(graph, pose);
  CheckLaser(graph, laser);
  const std::vector<double> numbers = NumbersOf("ranges", ranges);
  const int id = graph.Mutable()->AddSweep(pose, laser, numbers, motion, order);
  RaiseIfRefused(&graph);
  return id;
}

int AddPoints(GraphObject& graph, int pose, int laser, const py::object& points_in_robot) {
  CheckPose(graph, pose);
  CheckLaser(graph, laser);
  const std::vector<double> rows = RowsOf("points_in_robot", points_in_robot, 2);
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < rows.size(); i += 2) points.emplace_back(&rows[i]);
  const int id = graph.Mutable()->AddPoints(pose, laser, points);
  RaiseIfRefused(&graph);
  return id;
}

void AddOdometry(GraphObject& graph, int from, int to, const Pose2& from_from_to) {
  CheckPose(graph, from);
  CheckPose(graph, to);
  graph.Mutable()->AddOdometry({from, to, from_from_to});
  RaiseIfRefused(&graph);
}

void AddRelativePose(GraphObject& graph, int from, int to, const Pose2& from_from_to,
                     const py::object& covariance) {
  CheckPose(graph, from);
  CheckPose(graph, to);
  const Eigen::Matrix3d matrix = MatrixOf("covariance", covariance);
  graph.Mutable()->AddRelativePose({from, to, from_from_to, matrix});
  RaiseIfRefused(&graph);
}

void ExtendState(const GraphObject& graph, StateObject& object) {
  MapState state = object.State();
  if (state.poses.size() > graph->initial_poses().size() ||
      state.points.size() > 2 * graph->num_returns()) {
    RaiseIfError(Status::InvalidArgument("the state has " + std::to_string(state.num_poses()) +
                                         " poses and " + std::to_string(state.points.size() / 2) +
                                         " points, more than the graph has poses and "
                                         "returns"));
  }
  graph->ExtendState(&state);
  object.Write(std::move(state));
}

GraphObject Corrected(const GraphObject& graph, const MeasurementCorrections& corrections) {
  const auto check = [](const char* name, std::size_t size, std::size_t wanted) {
    if (size == 0 || size == wanted) return;
    RaiseIfError(Status::InvalidArgument("the corrections have " + std::to_string(size) + " " +
                                         name + ", and the graph " + std::to_string(wanted)));
  };
  check("odometry constraints", corrections.odometry.size(), graph->odometry().size());
  check("lasers", corrections.robot_from_laser.size(), graph->num_lasers());
  check("ranges", corrections.range_m.size(), graph->num_returns());
  check("bearings", corrections.bearing_rad.size(), graph->num_returns());
  if (!corrections.moving_returns.empty() &&
      corrections.moving_returns.back() >= graph->num_returns()) {
    RaiseIfError(Status::InvalidArgument(
        "the corrections have return " + std::to_string(corrections.moving_returns.back()) +
        " as moving, and the graph has " + std::to_string(graph->num_returns()) + " returns"));
  }
  return GraphObject(graph->Corrected(corrections));
}

void BindSlamGraph(py::module_* module) {
  using Graph = GraphObject;
  py::class_<Graph>(
      *module, "SlamGraph",
      "The measurements of one mapping problem, and an initial guess of every pose. Ids count up "
      "from 0 in order of addition; an id that is not there raises IndexError. Solvers read it "
      "and change a MapState. Arrays are copies, for those of the graph move as it grows.")
      .def(py::init<>())
      .def("add_laser", &AddLaser, py::arg("laser"),
           "Returns the id of an equal laser that the graph has, or of a new one.")
      .def("add_pose", &AddPose, py::arg("world_from_robot"), py::arg("timestamp_s"),
           "Adds a pose with its initial guess and its time [s]; returns its id.")
      .def("fix_pose", &FixPose, py::arg("pose"), py::arg("world_from_robot") = py::none(),
           "Holds a pose there; without a place, at its initial guess. If no pose is fixed, the "
           "first one is.")
      .def("add_scan", &AddScan, py::arg("pose"), py::arg("laser"), py::arg("ranges"),
           "Takes every return of a sweep as a map point. ranges [m]: shape (num_beams,); NaN, "
           "infinity and what is out of the laser's limits is no return. Returns the scan id.")
      .def("add_sweep", &AddSweep, py::arg("pose"), py::arg("laser"), py::arg("ranges"),
           py::arg("motion"),
           py::arg_v("order", SweepOrder::kFirstBeamFirst, "SweepOrder.FIRST_BEAM_FIRST"),
           "add_scan of a sweep that took its time while the robot moved, with that motion taken "
           "out: the returns are as if seen from the pose, where the robot was when the first beam "
           "was measured. motion: from there to where it was a beam after the last, by odometry; "
           "in between it moves steadily. The laser must have no beam_period_s. Returns the scan "
           "id.")
      .def("add_points", &AddPoints, py::arg("pose"), py::arg("laser"), py::arg("points_in_robot"),
           "Takes points of shape (K, 2) [m], in the frame of the robot, for the returns of a "
           "sweep: one whose motion has been taken out. Points that are not finite, or not within "
           "the laser's range, are no returns. Returns the scan id.")
      .def("add_odometry", &AddOdometry, py::arg("from_pose"), py::arg("to_pose"),
           py::arg("from_from_to"),
           "What the odometry says of the motion; its noise is that of the motion model.")
      .def("add_relative_pose", &AddRelativePose, py::arg("from_pose"), py::arg("to_pose"),
           py::arg("from_from_to"), py::arg("covariance"),
           "A measured relative pose. covariance: (3, 3), x, y [m], yaw [rad], in the frame of "
           "from_pose.")
      .def_property_readonly("num_poses", [](const Graph& g) { return g->num_poses(); })
      .def_property_readonly("num_scans", [](const Graph& g) { return g->num_scans(); })
      .def_property_readonly("num_lasers", [](const Graph& g) { return g->num_lasers(); })
      .def_property_readonly(
          "num_returns", [](const Graph& g) { return g->num_returns(); },
          "of all scans, each a map point")
      .def_property_readonly(
          "initial_poses", [](const Graph& g) { return ArrayOf(g->initial_poses(), 3); },
          "(N, 3): x, y [m], yaw [rad] of world_from_robot")
      .def_property_readonly(
          "timestamps_s", [](const Graph& g) { return ArrayOf(g->timestamps_s()); },
          "(N,): time of each pose [s]")
      .def_property_readonly(
          "ranges_m", [](const Graph& g) { return ArrayOf(g->returns().range_m); },
          "(M,): of each return, from the laser [m]")
      .def_property_readonly(
          "bearings_rad", [](const Graph& g) { return ArrayOf(g->Bearings()); },
          "(M,): of each return, in the frame of the laser [rad]")
      .def_property_readonly(
          "beams", [](const Graph& g) { return ArrayOf(g->Beams()); },
          "(M,): of each return, its beam")
      .def_property_readonly(
          "scan_of_return", [](const Graph& g) { return ArrayOf(g->ScansOfReturns()); },
          "(M,): of each return, its scan id")
      .def_property_readonly("odometry", [](const Graph& g) { return g->odometry(); })
      .def_property_readonly("relative_poses", [](const Graph& g) { return g->relative_poses(); })
      .def_property_readonly(
          "fixed_poses", [](const Graph& g) { return g->fixed_poses(); },
          "those that fix_pose named; the first pose if there are none")
      .def(
          "copy", [](const Graph& g) { return Graph(*g); }, "A graph of its own.")
      .def(
          "scan",
          [](const Graph& g, int id) {
            CheckScan(g, id);
            return g->scan(id);
          },
          py::arg("scan"), "Pose, laser and returns of a sweep.")
      .def(
          "laser",
          [](const Graph& g, int id) {
            CheckLaser(g, id);
            return g->laser(id);
          },
          py::arg("laser"), "The model of a laser.")
      .def(
          "initial_state", [](const Graph& g) { return StateObject(g->InitialState()); },
          "Poses at their initial guesses, and the map points where the measurements put them "
          "from there.")
      .def("extend_state", &ExtendState, py::arg("state"),
           "Adds to a state of this graph what came after it. The state gets new arrays; views of "
           "the old ones keep what they had.")
      .def(
          "measured_map",
          [](const Graph& g, const py::object& poses) {
            return ArrayOf(g->MeasuredMap(PosesFor(*g, poses)), 2);
          },
          py::arg("poses"),
          "(M, 2): where the measurements put the map points [m], seen from these poses, (N, 3).")
      .def("corrected", &Corrected, py::arg("corrections"),
           "The same graph with other measurements.")
      .def("__repr__", [](const Graph& g) {
        return "SlamGraph(" + std::to_string(g->num_poses()) + " poses, " +
               std::to_string(g->num_scans()) + " scans, " + std::to_string(g->num_returns()) +
               " returns)";
      });
}

void BindMapState(py::module_* module) {
  const auto set_rows = [](const char* name, int columns, py::array StateObject::*member) {
    return [=](StateObject& state, const py::object& rows) {
      state.*member = ArrayOf(RowsOf(name, rows, columns), columns);
    };
  };
  py::class_<StateObject>(
      *module, "MapState",
      "The unknowns of a mapping problem: poses and map points of one SlamGraph. Both arrays can "
      "be changed in place and outlive the state; a solver writes its result into them.")
      .def(py::init<>())
      .def(py::init([=](const py::object& poses, const py::object& points) {
             return StateObject(MapState{RowsOf("poses", poses, 3), RowsOf("points", points, 2)});
           }),
           py::arg("poses"), py::arg("points"), "Copies of arrays of shapes (N, 3) and (M, 2).")
      .def_property(
          "poses", [](const StateObject& state) { return state.poses; },
          set_rows("poses", 3, &StateObject::poses),
          "(N, 3): x, y [m], yaw [rad] of world_from_robot per pose. No copy.")
      .def_property(
          "points", [](const StateObject& state) { return state.points; },
          set_rows("points", 2, &StateObject::points),
          "(M, 2): x, y [m] in the world per return. No copy.")
      .def("__copy__", [](const StateObject& state) { return StateObject(state.State()); })
      .def(
          "__deepcopy__",
          [](const StateObject& state, const py::object&) { return StateObject(state.State()); },
          py::arg("memo"))
      .def(
          "copy", [](const StateObject& state) { return StateObject(state.State()); },
          "A state with arrays of its own.")
      .def(
          "__eq__",
          [](const StateObject& a, const StateObject& b) { return a.State() == b.State(); },
          py::is_operator())
      .def("__repr__", [](const StateObject& state) {
        return "MapState(" + std::to_string(state.poses.size() / 3) + " poses, " +
               std::to_string(state.points.size() / 2) + " points)";
      });
}

}  // namespace

void BindGraph(py::module_* module) {
  BindPose(module);
  BindLaser(module);
  BindMeasurements(module);
  BindMapState(module);
  BindSlamGraph(module);
}

}  // namespace plumbline
