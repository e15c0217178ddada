// Readers and writers: the same that the programs use.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/io/pcd_writer.h"
#include "plumbline/apps/io/ply_reader.h"
#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/apps/io/pose_graph_writer.h"
#include "plumbline/apps/io/ros_map.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/errors.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/apps/python/objects.h"
#include "plumbline/apps/readers/log_reader.h"
#include "plumbline/apps/readers/pose_graph_input.h"

namespace plumbline {
namespace py = pybind11;
namespace {

using Path = std::filesystem::path;

// Calls work() without Python's lock, and raises what comes of it.
template <typename Work>
void RunUnlocked(const Work& work) {
  Status status;
  {
    const py::gil_scoped_release unlocked;
    status = work();
  }
  RaiseIfError(status);
}

void Warn(const std::vector<Warning>& warnings) {
  const py::object warn = py::module_::import("warnings").attr("warn");
  const py::object type = py::module_::import("plumbline").attr("InputWarning");
  for (const Warning& warning : warnings) {
    const py::object object = type(TextOf(warning.message));
    object.attr("id") = warning.id;
    warn(object);
  }
}

GraphObject ReadLogFile(const Path& path, int max_scans, const std::string& scan_topic,
                        const std::string& odom_topic, const std::optional<std::string>& odom_frame,
                        const std::optional<double>& sweep_time_s, const std::string& echo,
                        const std::optional<std::pair<double, double>>& slice_height_m,
                        const std::string& laser_frame, const std::string& clock,
                        const std::string& beam_direction,
                        const std::optional<double>& flaser_fov_rad) {
  if (echo != "first" && echo != "strongest") {
    RaiseIfError(Status::InvalidArgument("echo is neither 'first' nor 'strongest'"));
  }
  LogReadOptions options;
  if (!FromString(clock, &options.clock)) throw py::value_error("clock: no such name: " + clock);
  if (!FromString(beam_direction, &options.beam_direction)) {
    throw py::value_error("beam_direction: no such name: " + beam_direction);
  }
  options.laser_frame = laser_frame;
  options.flaser_fov_rad = flaser_fov_rad;
  options.max_scans = max_scans;
  options.bag.scan_topic = scan_topic;
  options.bag.echo = echo == "first" ? RosEcho::kFirst : RosEcho::kStrongest;
  if (slice_height_m) options.bag.slice_height_m = {slice_height_m->first, slice_height_m->second};
  options.bag.odom_topic = odom_topic;
  options.bag.odom_frame = odom_frame.value_or(options.bag.odom_frame);
  options.bag.needs_odometry = odom_frame.has_value();
  options.sweep_time_s = sweep_time_s;
  LogNotes notes;
  SlamGraph graph;
  RunUnlocked([&] { return ReadLog(path.string(), options, &notes, &graph); });
  for (const std::string& line : notes.skipped) Warn({{"skipped_record", line}});
  Warn(notes.warnings);
  return GraphObject(std::move(graph));
}

// A pose graph of another system in parts that outlive it.
struct PoseGraphObject {
  PoseGraphInput input;  // without its graph
  py::object graph;
  std::size_t num_coordinates = 0;  // of the poses in the file
};

PoseGraphObject ReadPoseGraphInput(const Path& path) {
  PoseGraphInput input;
  RunUnlocked([&] { return ReadPoseGraph(path.string(), 0.0, &input); });
  Warn(input.warnings);
  const std::size_t num_coordinates = input.graph.initial_poses().size();
  py::object graph = py::cast(GraphObject(std::exchange(input.graph, SlamGraph())));
  return {std::move(input), std::move(graph), num_coordinates};
}

void WriteInput(const PoseGraphObject& object, const Path& path, const py::object& poses) {
  const std::vector<double> rows = RowsOf("poses", poses, 3);
  CheckReach("poses", rows, 3);
  if (rows.size() != object.num_coordinates) {
    throw py::value_error("poses: " + std::to_string(rows.size() / 3) + " rows for a file of " +
                          std::to_string(object.num_coordinates / 3) + " poses");
  }
  RunUnlocked([&] { return object.input.write(path.string(), rows); });
}

void WriteGraph(const Path& path, const GraphObject& graph, const py::object& poses,
                const MotionOptions& motion) {
  const std::vector<double> rows =
      poses.is_none() ? graph->initial_poses() : PosesFor(*graph, poses);
  const PoseGraphFormat format =
      path.extension() == ".toro" ? PoseGraphFormat::kToro : PoseGraphFormat::kG2o;
  RaiseIfError(graph.ReadUnlocked([&](const SlamGraph& unlocked) {
    PoseGraphFile file;
    PLUMBLINE_RETURN_IF_ERROR(MakePoseGraphFile(unlocked, motion, &file));
    return WritePoseGraphFile(path.string(), format, file, rows);
  }));
}

std::pair<py::array, py::array> ReadTrajectory(const Path& path) {
  std::vector<TimedPose> trajectory;
  RunUnlocked([&] { return ReadTumTrajectory(path.string(), &trajectory); });
  std::vector<double> timestamps_s, poses;
  for (const TimedPose& timed : trajectory) {
    timestamps_s.push_back(timed.timestamp_s);
    const Pose2& pose = timed.world_from_robot;
    poses.insert(poses.end(), {pose.x, pose.y, pose.yaw});
  }
  return {ArrayOf(std::move(timestamps_s)), ArrayOf(std::move(poses), 3)};
}

void WriteTrajectory(const Path& path, const py::object& timestamps_s, const py::object& poses) {
  const std::vector<TimedPose> trajectory = TrajectoryOf(timestamps_s, poses);
  RunUnlocked([&] { return WriteTumTrajectory(path.string(), trajectory); });
}

py::array ReadPoints(const Path& path) {
  std::vector<double> points;
  RunUnlocked([&] { return ReadPointsPly(path.string(), &points); });
  return ArrayOf(std::move(points), 2);
}

using PointWriter = Status (*)(const std::string&, const SlamGraph&, const MapState&);
void WritePoints(PointWriter writer, const Path& path, const GraphObject& graph,
                 const StateObject& object) {
  const MapState state = object.FiniteStateOf(*graph);
  RaiseIfError(graph.ReadUnlocked(
      [&](const SlamGraph& unlocked) { return writer(path.string(), unlocked, state); }));
}

OccupancyGrid GridOf(const GraphObject& graph, const StateObject& object, double resolution_m) {
  const MapState state = object.FiniteStateOf(*graph);
  OccupancyGridOptions options;
  options.resolution_m = resolution_m;
  OccupancyGrid grid;
  RaiseIfError(graph.ReadUnlocked([&](const SlamGraph& unlocked) {
    return BuildOccupancyGrid(unlocked, state, options, &grid);
  }));
  return grid;
}

py::array CellsOf(const OccupancyGrid& grid) {
  std::vector<std::uint8_t> cells;
  cells.reserve(grid.cells.size());
  for (const Occupancy cell : grid.cells) cells.push_back(static_cast<std::uint8_t>(cell));
  return ArrayOf(std::move(cells), grid.width);
}

void WriteMap(const Path& stem, const OccupancyGrid& grid) {
  RunUnlocked([&] { return WriteRosMap(stem.string(), grid); });
}

void BindLogs(py::module_* module) {
  module->def(
      "read_log", &ReadLogFile, py::arg("path"), py::arg("max_scans") = 0,
      py::arg("scan_topic") = "", py::arg("odom_topic") = "", py::arg("odom_frame") = py::none(),
      py::arg("sweep_time_s") = py::none(), py::arg("echo") = "first",
      py::arg("slice_height_m") = py::none(), py::arg("laser_frame") = "",
      py::arg("clock") = "auto", py::arg("beam_direction") = "stated",
      py::arg("flaser_fov_rad") = py::none(),
      "Reads a CARMEN log (plain or .gz), a bag of ROS 1 or ROS 2 (file or folder) or a map "
      "of slam_toolbox into a SlamGraph placed by odometry: a pose per scan. max_scans: "
      "the first ones; 0: all. Topics: of a bag; empty: the only one of its type. "
      "sweep_time_s: from the first beam of a sweep to the last [s]; None: what the log "
      "says. echo: of the beams of a MultiEchoLaserScan, 'first' or 'strongest'. slice_height_m: "
      "(low, high), heights [m] in the frame of a PointCloud2 between which points are taken; "
      "None: the laser is planar. laser_frame, clock, beam_direction, flaser_fov_rad: as the flags "
      "of plumbline_slam. What is skipped or doubtful is an InputWarning.");
  Fields<PoseGraphObject>(module, "PoseGraphInput", "A pose graph that another system has saved.")
      .Field("graph", &PoseGraphObject::graph, "at the given poses")
      .FieldBy(
          "format", [](const PoseGraphObject& o) { return o.input.format; },
          "also the extension of its files")
      .FieldBy(
          "num_robot_poses", [](const PoseGraphObject& o) { return o.input.num_robot_poses; },
          "the first poses are the robot's, others are frames of the other system")
      .FieldBy(
          "names", [](const PoseGraphObject& o) { return py::tuple(py::cast(o.input.names)); },
          "of the poses, in the file; empty: their ids in the graph")
      .Method("write", &WriteInput, py::arg("path"), py::arg("poses"),
              "Writes the same file with other poses, (N, 3).");
  module->def("read_pose_graph", &ReadPoseGraphInput, py::arg("path"),
              "Reads a pose graph (g2o, TORO; plain or .gz) or a saved map (Cartographer, "
              ".pbstream; slam_toolbox, .posegraph), with its scans where it has any.");
  module->def(
      "write_pose_graph", &WriteGraph, py::arg("path"), py::arg("graph"),
      py::arg("poses") = py::none(), py::arg_v("motion", MotionOptions(), "MotionOptions()"),
      "Writes poses, scans and edges as g2o, or as TORO if the path ends with .toro. poses: "
      "(N, 3); None: the initial guesses. motion: the noise of odometry edges.");
}

void BindResults(py::module_* module) {
  module->def("read_trajectory", &ReadTrajectory, py::arg("path"),
              "Reads a TUM trajectory: times [s], (N,), and poses x, y [m], yaw [rad], (N, 3).");
  module->def("write_trajectory", &WriteTrajectory, py::arg("path"), py::arg("timestamps_s"),
              py::arg("poses"),
              "Writes a TUM trajectory, `t x y z qx qy qz qw` per pose. Shapes (N,) and (N, 3).");
  module->def("read_points_ply", &ReadPoints, py::arg("path"),
              "(M, 2): x, y [m] of the points that write_points_ply has written.");
  module->def(
      "write_points_ply",
      [](const Path& path, const GraphObject& graph, const StateObject& state) {
        WritePoints(&WritePointsPly, path, graph, state);
      },
      py::arg("path"), py::arg("graph"), py::arg("state"),
      "Writes every map point with the id of its scan; binary, doubles.");
  module->def(
      "write_points_pcd",
      [](const Path& path, const GraphObject& graph, const StateObject& state) {
        WritePoints(&WritePointsPcd, path, graph, state);
      },
      py::arg("path"), py::arg("graph"), py::arg("state"), "Likewise for PCL; binary, floats.");
  Fields<OccupancyGrid>(module, "OccupancyGrid", "Square cells on a grid through the origin.")
      .Field("resolution_m", &OccupancyGrid::resolution_m, "side of a cell [m]")
      .Field("left_m", &OccupancyGrid::left_m, "world x of the lower left corner [m]")
      .Field("bottom_m", &OccupancyGrid::bottom_m, "world y of the lower left corner [m]")
      .FieldBy("cells", &CellsOf,
               "(height, width), uint8: 0 unknown, 1 free, 2 occupied; the row with the smallest "
               "y first. A copy.");
  module->def("build_occupancy_grid", &GridOf, py::arg("graph"), py::arg("state"),
              py::arg("resolution_m") = OccupancyGridOptions().resolution_m,
              "Where a robot could drive, from all scans and the map points of a state.");
  module->def("write_map", &WriteMap, py::arg("stem"), py::arg("grid"),
              "Writes stem.pgm and stem.yaml for the map servers of ROS and Nav2.");
}

}  // namespace

void BindFiles(py::module_* module) {
  BindLogs(module);
  BindResults(module);
}

}  // namespace plumbline
